"""The ellipsoidal decision volume of a Euclidean space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np

from relforest.support.errors import ModelFormatError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@final
@dataclass(frozen=True, slots=True, eq=False)
class Ellipsoid:
    """All points within Mahalanobis distance `radius` of `mean`.

    Parameters
    ----------
    mean : ndarray (d,)
        Centre: the mean of the key points.
    covariance : ndarray (d, d)
        V of eq. 3.6. It is an unnormalised scatter, so only its shape and orientation carry meaning;
        the size of the volume is in `radius`, which refers to this matrix.
    radius : float
        Largest Mahalanobis distance that still counts as inside (eq. 3.3).
    n_keys : int
        How many key points the mean and the covariance were estimated from.
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
        """Mahalanobis distance of each point (n, d) from the mean (eq. 3.2); (n,)."""
        offsets = np.atleast_2d(np.asarray(points, dtype=np.float64)) - self.mean
        squared = np.einsum("ni,ij,nj->n", offsets, self.precision, offsets)
        distance: NDArray[np.float64] = np.sqrt(np.maximum(squared, 0.0))
        return distance

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Which points (n, d) lie inside, the boundary included (eq. 3.3); (n,)."""
        return self.distance(points) <= self.radius

    def density(self, points: ArrayLike) -> NDArray[np.float64]:
        """Gaussian density relative to its peak for each point (n, d); (n,) in [0, 1]."""
        density: NDArray[np.float64] = np.exp(-0.5 * self.density_sharpness * self.distance(points) ** 2)
        return density

    def to_dict(self) -> dict[str, Any]:
        """JSON form."""
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
        """Inverse of `to_dict`.

        Raises
        ------
        ModelFormatError
            If a value is missing, not finite, of the wrong shape, or no covariance.
        """
        try:
            mean = np.array(document["mean"], dtype=np.float64)
            covariance = np.array(document["covariance"], dtype=np.float64)
            radius, n_keys = float(document["radius"]), int(document["n_keys"])
            prior_weight = float(document["prior_weight"])
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            msg = f"malformed ellipsoid: {error!r}"
            raise ModelFormatError(msg) from error
        scalars = np.array([radius, n_keys, prior_weight])
        if mean.ndim != 1 or covariance.shape != (len(mean), len(mean)) or len(mean) == 0:
            msg = f"malformed ellipsoid: mean {mean.shape} and covariance {covariance.shape} do not match"
            raise ModelFormatError(msg)
        if not all(np.isfinite(part).all() for part in (mean, covariance, scalars)):
            msg = "malformed ellipsoid: a value is not finite"
            raise ModelFormatError(msg)
        if not (scalars >= 0).all() or not np.allclose(covariance, covariance.T):
            msg = "malformed ellipsoid: negative radius, count or weight, or an asymmetric covariance"
            raise ModelFormatError(msg)
        if np.linalg.eigvalsh(covariance)[0] <= 0.0:
            msg = "malformed ellipsoid: the covariance is not positive definite"
            raise ModelFormatError(msg)
        return cls(mean, covariance, radius, n_keys, prior_weight)
