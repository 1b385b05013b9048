"""Which features a volume looks at, and in which units: columns, scaled and perhaps rotated.

Letters: n points, d features, k columns in use, f coordinates of a view.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.mil.scaling import feature_units

__all__ = ["FeatureView", "principal_view", "scaled_view"]

_MOST_ROWS: Final = 1000


@final
@dataclass(frozen=True, slots=True, eq=False)
class FeatureView:
    """Coordinates in which a volume is described.

    Attributes
    ----------
    columns : (k,) int64 array
        The features in use.
    centre, scale : (k,) float64 arrays
        Mean and standard deviation of these features in the training points.
    rotation : (f, k) float64 array or None
        Orthonormal rows, the directions of the coordinates; None if each coordinate is one feature.
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
        """Coordinates of points (n, d) in this view: (n, f)."""
        scaled: NDArray[np.float64] = (points[:, self.columns] - self.centre) / self.scale
        return scaled if self.rotation is None else scaled @ self.rotation.T

    def original(self, coordinates: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values of the columns (n, k), in the units of the data, at coordinates (n, f)."""
        scaled = coordinates if self.rotation is None else coordinates @ self.rotation
        values: NDArray[np.float64] = scaled * self.scale + self.centre
        return values

    def part(self, features: NDArray[np.int64]) -> FeatureView:
        """Return the view of some of the columns, given by their places; only without a rotation."""
        return FeatureView(self.columns[features], self.centre[features], self.scale[features])


def scaled_view(points: NDArray[np.float64]) -> FeatureView:
    """View of all features that vary, scaled to unit variance.

    If no feature varies, the first one is kept, and all points coincide.
    """
    units = feature_units(points, "standard")
    columns = np.flatnonzero(units.width > 0.0)
    if len(columns) == 0:
        return FeatureView(np.zeros(1, dtype=np.int64), points[:1, 0].copy(), np.ones(1))
    return FeatureView(columns, units.shift[columns], units.width[columns])


def principal_view(
    view: FeatureView, coordinates: NDArray[np.float64], n_components: int, rng: np.random.Generator
) -> FeatureView:
    """Rotate a view to its first principal components; `coordinates` (n, k) are the points in it.

    Of many points a sample is enough for the leading directions, and keeps the cost bounded.
    """
    if len(coordinates) > _MOST_ROWS:
        coordinates = coordinates[np.sort(rng.choice(len(coordinates), _MOST_ROWS, replace=False))]
    _, strengths, directions = np.linalg.svd(coordinates - coordinates.mean(axis=0), full_matrices=False)
    n_real = max(1, int(np.count_nonzero(strengths > 1e-6 * strengths[0])))
    return FeatureView(view.columns, view.centre, view.scale, directions[: min(n_components, n_real)])
