"""The ellipsoidal decision volume of a Euclidean space."""

from __future__ import annotations

import math
import reprlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, final

import numpy as np
from scipy.linalg import solve_triangular

from relforest.support.documents import well_formed
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.notebook import drawn
from relforest.support.options import at_least, in_range

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

# Bounds for files. Covariant aggregation accepts points up to 1e30 and conditions its matrices, so whatever
# it learns lies well within these bounds, and nothing overflows when an ellipsoid is evaluated or drawn.
LARGEST_VALUE: Final = 1e40
LARGEST_SCATTER: Final = 1e80
SMALLEST_SCATTER: Final = 1e-100
LARGEST_RADIUS: Final = 1e90
LARGEST_COUNT: Final = 1e15


@final
@dataclass(frozen=True, slots=True, eq=False)
class Ellipsoid:
    """All points within Mahalanobis distance `radius` of `mean`.

    Parameters
    ----------
    mean : (d,) float64
        The centre: the mean of the key points.
    covariance : (d, d) float64
        V of eq. 3.6. It is an unnormalised scatter matrix, so only its shape and orientation are
        meaningful; the size of the volume is given by `radius`, relative to this matrix.
    radius : float
        Largest Mahalanobis distance that still counts as inside (eq. 3.3).
    n_keys : int
        Number of key points from which the mean and the covariance were estimated.
    prior_weight : float
        w of eq. 3.5.

    Notes
    -----
    The source leaves the scale of the density open. `density` divides V by ``n_keys + prior_weight``,
    which turns the scatter into a covariance, and is 1 at the mean.

    References
    ----------
    Palmer (2015), section 3.2, eq. 3.2, 3.3 and 3.6; section 4.1 for its use in question nodes.
    """

    mean: NDArray[np.float64]
    covariance: NDArray[np.float64]
    radius: float
    n_keys: int
    prior_weight: float

    _repr_html_ = drawn

    @property
    def dim(self) -> int:
        """Dimension d of the space."""
        return len(self.mean)

    @property
    def density_sharpness(self) -> float:
        """Factor on the squared distance in the density's exponent."""
        return self.n_keys + self.prior_weight

    @property
    def precision(self) -> NDArray[np.float64]:
        """Inverse of the covariance, (d, d)."""
        return np.linalg.inv(self.covariance).astype(np.float64)

    @property
    def axes(self) -> NDArray[np.float64]:
        """Semi-axes of the boundary: scaled eigenvectors as rows (d, d), the longest first."""
        eigenvalues, eigenvectors = np.linalg.eigh(self.covariance)
        lengths = self.radius * np.sqrt(np.maximum(eigenvalues, 0.0))
        axes: NDArray[np.float64] = (eigenvectors * lengths).T[::-1]
        return axes

    def distance(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return the Mahalanobis distance of each point (n, d) from the mean (eq. 3.2); (n,)."""
        rows = np.atleast_2d(np.asarray(points, dtype=np.float64))
        if rows.shape[1:] != (self.dim,):
            raise InputError(f"points must have the shape (n, {self.dim}), got {rows.shape}")
        offsets = rows - self.mean
        # At most a third of the time of the inverse in many dimensions.
        factor = np.linalg.cholesky(self.covariance)
        whitened = solve_triangular(factor, offsets.T, lower=True, check_finite=False)
        distance: NDArray[np.float64] = np.linalg.norm(whitened, axis=0)
        return distance

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Return which points (n, d) lie inside, including the boundary (eq. 3.3); (n,)."""
        return self.distance(points) <= self.radius

    def density(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return the Gaussian density of each point (n, d) relative to the peak; (n,) in [0, 1]."""
        density: NDArray[np.float64] = np.exp(-0.5 * self.density_sharpness * self.distance(points) ** 2)
        return density

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON form."""
        return {
            "shape": "ellipsoid",
            "mean": self.mean.tolist(),
            "covariance": self.covariance.tolist(),
            "radius": self.radius,
            "n_keys": self.n_keys,
            "prior_weight": self.prior_weight,
        }

    @classmethod
    def from_dict(cls, document: dict[str, Any]) -> Ellipsoid:
        """Read what `to_dict` returned.

        Raises
        ------
        ModelFormatError
            If a value is missing, out of bounds or of the wrong shape, or the covariance is not valid.
        """
        with well_formed("malformed ellipsoid"):
            mean, covariance = (_numbers(document[key]) for key in ("mean", "covariance"))
            radius = in_range("radius", document["radius"], 0.0, LARGEST_RADIUS)
            n_keys = at_least("n_keys", document["n_keys"], 0)
            in_range("n_keys", n_keys, 0, LARGEST_COUNT)
            prior_weight = in_range("prior_weight", document["prior_weight"], 0.0, LARGEST_COUNT)
        if mean.ndim != 1 or covariance.shape != (len(mean), len(mean)) or len(mean) == 0:
            raise ModelFormatError(
                f"malformed ellipsoid: mean {mean.shape} and covariance {covariance.shape} do not match"
            )
        # The negated test also catches NaN.
        if not (np.abs(mean) <= LARGEST_VALUE).all() or not (np.abs(covariance) <= LARGEST_SCATTER).all():
            raise ModelFormatError(
                f"malformed ellipsoid: the mean must not exceed {LARGEST_VALUE:g}, "
                f"nor the covariance {LARGEST_SCATTER:g}"
            )
        if not np.allclose(covariance, covariance.T, rtol=0.0, atol=1e-9 * np.abs(covariance).max()):
            raise ModelFormatError("malformed ellipsoid: the covariance is not symmetric")
        eigenvalues = np.linalg.eigvalsh(covariance)
        # Below these bounds, distances overflow or the inverse loses all precision.
        if not eigenvalues[0] > max(SMALLEST_SCATTER, 1e-15 * eigenvalues[-1]):
            raise ModelFormatError("malformed ellipsoid: the covariance is not positive definite")
        if not radius * math.sqrt(eigenvalues[-1]) <= LARGEST_VALUE:
            raise ModelFormatError(f"malformed ellipsoid: it extends beyond {LARGEST_VALUE:g}")
        return cls(mean, covariance, radius, n_keys, prior_weight)


def _numbers(values: object) -> NDArray[np.float64]:
    array = np.asarray(values)
    if array.dtype.kind not in "iuf":
        raise InputError(f"expected numbers, got {reprlib.repr(values)}")
    return array.astype(np.float64)
