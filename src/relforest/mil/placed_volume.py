"""Volumes placed in the feature space, and the nearness of bags to them.

Letters: n points, b bags, f coordinates, m balls, d features.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.mil.feature_view import FeatureView
from relforest.mil.squared_distances import squared_distances
from relforest.support.progress import report
from relforest.volumes import Ellipsoid

_LOG2: Final = float(np.log(2.0))
# Points handled at a time when every point is compared with every ball.
_BLOCK: Final = 2048


def nearness(distances: NDArray[np.float64], radius: float) -> NDArray[np.float64]:
    """Return ``2 ** -(distance / radius) ** 2``: 1 at the centre, one half on the boundary."""
    # A volume may have shrunk to a point.
    ratio = distances / max(radius, np.finfo(np.float64).tiny ** 0.5)
    near: NDArray[np.float64] = np.exp(-_LOG2 * np.minimum(ratio, 1e6) ** 2)
    return near


@final
@dataclass(frozen=True, slots=True, eq=False)
class PlacedVolume:
    """An ellipsoid, the features it uses, and its weight in the score of a bag.

    Attributes
    ----------
    panel : str
        The panel that the volume belongs to.
    view : FeatureView
        Coordinates in which the ellipsoid is given; ``view.columns`` are the features.
    ellipsoid : Ellipsoid
        The volume.
    seeks_positive : bool
        Whether the volume was aggregated from positive bags; otherwise from negative ones.
    weight : float
        Added to the score of a bag with an instance at the centre; half of it at the boundary.
    """

    panel: str
    view: FeatureView
    ellipsoid: Ellipsoid
    seeks_positive: bool
    weight: float

    @property
    def centre(self) -> NDArray[np.float64]:
        """Centre in the units of the data, one value per column in ``view.columns``."""
        values: NDArray[np.float64] = self.view.original(self.ellipsoid.mean[None])[0]
        return values

    def nearness_at(self, coordinates: NDArray[np.float64]) -> NDArray[np.float64]:
        """Nearness of points, by their coordinates (n, f) in the view, (n,)."""
        return nearness(self.ellipsoid.distance(coordinates), self.ellipsoid.radius)


def bag_nearness(
    volumes: Sequence[PlacedVolume], points: NDArray[np.float64], starts: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Nearness of each bag's witness to each volume, (b, k), for points (n, d)."""
    near = np.empty((len(starts) - 1, len(volumes)))
    for number, values in enumerate(point_nearness(volumes, points)):
        np.maximum.reduceat(values, starts[:-1], out=near[:, number])
    return near


def point_nearness(
    volumes: Sequence[PlacedVolume], points: NDArray[np.float64]
) -> Iterator[NDArray[np.float64]]:
    """Yield the nearness of all points (n, d) to each volume in turn, (n,)."""
    # Rotated views are few and expensive; views of single features are many and cheap.
    rotated: dict[int, NDArray[np.float64]] = {}
    for volume in volumes:
        view = volume.view
        if view.rotation is None:
            coordinates = view.coordinates(points)
        else:
            if id(view) not in rotated:
                rotated[id(view)] = view.coordinates(points)
            coordinates = rotated[id(view)]
        yield volume.nearness_at(coordinates)


@final
@dataclass(frozen=True, slots=True, eq=False)
class Balls:
    """Balls of equal size around training instances, in a view without rotation.

    Attributes
    ----------
    view : FeatureView
        The scaled features.
    centres : (m, f) float64
        Centres, as coordinates of the view.
    near_radius, share_radius : float
        Radii for the nearness of the nearest instance and for the mean nearness of all instances.
    near_weights, share_weights : (m,) float64
        Added to the score of a bag with an instance at the centre, and of a bag with all instances there.
    """

    view: FeatureView
    centres: NDArray[np.float64]
    near_radius: float
    share_radius: float
    near_weights: NDArray[np.float64]
    share_weights: NDArray[np.float64]

    def point_nearness(
        self, coordinates: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Nearness of points, by their coordinates (n, f), for both radii: two arrays (n, m)."""
        squared = squared_distances(coordinates, self.centres)
        distances = np.sqrt(squared, out=squared)
        return nearness(distances, self.near_radius), nearness(distances, self.share_radius)

    def bag_nearness(
        self, points: NDArray[np.float64], starts: NDArray[np.int64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Nearness of the nearest instance, and mean nearness, for each bag: two arrays (b, m)."""
        n_bags = len(starts) - 1
        nearest, shares = np.empty((n_bags, len(self.centres))), np.empty((n_bags, len(self.centres)))
        for first, last in bag_blocks(starts):
            report("measuring nearness to balls: bags", first, n_bags)
            rows = slice(starts[first], starts[last])
            near, share = self.point_nearness(self.view.coordinates(points[rows]))
            within = starts[first : last + 1] - starts[first]
            np.maximum.reduceat(near, within[:-1], axis=0, out=nearest[first:last])
            sums = np.add.reduceat(share, within[:-1], axis=0)
            shares[first:last] = sums / np.diff(within)[:, np.newaxis]
        return nearest, shares

    def without_idle(self) -> Balls:
        """Return only the balls with a weight other than 0."""
        busy = np.flatnonzero((self.near_weights != 0.0) | (self.share_weights != 0.0))
        return replace(
            self,
            centres=self.centres[busy],
            near_weights=self.near_weights[busy],
            share_weights=self.share_weights[busy],
        )


def bag_blocks(starts: NDArray[np.int64]) -> list[tuple[int, int]]:
    """Return ranges of bags (first, behind the last) of limited size; a large bag is a range of its own."""
    blocks, first = [], 0
    for bag in range(1, len(starts)):
        if bag == len(starts) - 1 or starts[bag + 1] - starts[first] > _BLOCK:
            blocks.append((first, bag))
            first = bag
    return blocks


def typical_squared_distance(centres: NDArray[np.float64]) -> float:
    """Median of the squared distances between centres (m, f); 1 if they coincide."""
    median = float(np.median(squared_distances(centres, centres)))
    return median if median > 0.0 else 1.0
