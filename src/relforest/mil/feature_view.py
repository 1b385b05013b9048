"""The features that a volume uses and their units: columns, scaled and optionally rotated.

Letters: n points, d features, k columns in use, f coordinates of a view.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.mil.scaling import feature_units

_MOST_ROWS: Final = 1000


@final
@dataclass(frozen=True, slots=True, eq=False)
class FeatureView:
    """Coordinates in which a volume is described.

    Attributes
    ----------
    columns : (k,) int64
        The features in use.
    centre, scale : (k,) float64
        Mean and standard deviation of these features over the training points.
    rotation : (f, k) float64 or None
        Directions of the coordinates, as orthonormal rows; None if every coordinate is a single feature.
    """

    columns: NDArray[np.int64]
    centre: NDArray[np.float64]
    scale: NDArray[np.float64]
    rotation: NDArray[np.float64] | None = None

    @property
    def dim(self) -> int:
        """Number of coordinates f."""
        return len(self.columns) if self.rotation is None else len(self.rotation)

    def coordinates(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Coordinates of points (n, d) in this view, (n, f)."""
        scaled: NDArray[np.float64] = (points[:, self.columns] - self.centre) / self.scale
        return scaled if self.rotation is None else scaled @ self.rotation.T

    def original(self, coordinates: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values (n, k) of the columns, in the units of the data, at coordinates (n, f)."""
        scaled = coordinates if self.rotation is None else coordinates @ self.rotation
        values: NDArray[np.float64] = scaled * self.scale + self.centre
        return values

    def part(self, features: NDArray[np.int64]) -> FeatureView:
        """Return a view of some of the columns, by their positions; only for views without rotation."""
        return FeatureView(self.columns[features], self.centre[features], self.scale[features])


def scaled_view(points: NDArray[np.float64]) -> FeatureView:
    """Return a view of all features that vary, scaled to unit variance.

    If no feature varies, the first one is kept, so all points coincide.
    """
    units = feature_units(points, "standard")
    columns = np.flatnonzero(units.width > 0.0)
    if len(columns) == 0:
        return FeatureView(np.zeros(1, dtype=np.int64), points[:1, 0].copy(), np.ones(1))
    return FeatureView(columns, units.shift[columns], units.width[columns])


def principal_view(
    view: FeatureView, coordinates: NDArray[np.float64], n_components: int, rng: np.random.Generator
) -> FeatureView:
    """Rotate a view to its first principal components; `coordinates` (n, k) are the points in that view.

    If there are many points, the directions come from a sample, which bounds the cost.
    """
    if len(coordinates) > _MOST_ROWS:
        coordinates = coordinates[np.sort(rng.choice(len(coordinates), _MOST_ROWS, replace=False))]
    _, strengths, directions = np.linalg.svd(coordinates - coordinates.mean(axis=0), full_matrices=False)
    n_real = max(1, int(np.count_nonzero(strengths > 1e-6 * strengths[0])))
    return FeatureView(view.columns, view.centre, view.scale, directions[: min(n_components, n_real)])
