"""The decision volume of the circle: an arc around a mean direction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, final

import numpy as np

from relforest.support.documents import well_formed
from relforest.support.errors import InputError
from relforest.support.notebook import drawn
from relforest.support.options import in_range

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

# Bounds for files. Learned arcs lie within one turn, with kappa below 1e9.
LARGEST_ANGLE: Final = 1e6
LARGEST_KAPPA: Final = 1e12


@final
@dataclass(frozen=True, slots=True, eq=False)
class Arc:
    """All angles within `radius` of `mean`, with a von Mises density.

    Parameters
    ----------
    mean : float
        Mean direction of the key angles, radians.
    radius : float
        Largest angular distance inside the arc, radians.
    kappa : float
        Concentration of the von Mises density. It affects only the density features, never the decision.

    References
    ----------
    Palmer (2015), section 4.1 (von Mises for orientation). The source gives no estimate of kappa and
    no covariant aggregation on the circle; both are ours, see docs/theory/covariant-aggregation.md.
    """

    mean: float
    radius: float
    kappa: float

    _repr_html_ = drawn

    @property
    def dim(self) -> int:
        """Dimension of the space."""
        return 1

    def distance(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return the angular distance (radians) of each angle, (n,) or (n, 1), from the mean; (n,)."""
        angles = np.atleast_1d(np.asarray(points, dtype=np.float64))
        if angles.shape[1:] not in {(), (1,)}:
            raise InputError(f"angles must have the shape (n,) or (n, 1), got {angles.shape}")
        offsets = angles.reshape(-1) - self.mean
        distance: NDArray[np.float64] = np.abs(offsets - 2 * math.pi * np.rint(offsets / (2 * math.pi)))
        return distance

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Return which angles lie inside, including the ends; (n,)."""
        return self.distance(points) <= self.radius

    def density(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return the von Mises density of each angle relative to the peak; (n,) in [0, 1]."""
        density: NDArray[np.float64] = np.exp(self.kappa * (np.cos(self.distance(points)) - 1.0))
        return density

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON form."""
        return {"shape": "arc", "mean": self.mean, "radius": self.radius, "kappa": self.kappa}

    @classmethod
    def from_dict(cls, document: dict[str, Any]) -> Arc:
        """Read what `to_dict` returned.

        Raises
        ------
        ModelFormatError
            If a value is missing or out of bounds.
        """
        with well_formed("malformed arc"):
            mean = in_range("mean", document["mean"], -LARGEST_ANGLE, LARGEST_ANGLE)
            radius = in_range("radius", document["radius"], 0.0, LARGEST_ANGLE)
            kappa = in_range("kappa", document["kappa"], 0.0, LARGEST_KAPPA)
            return cls(mean, radius, kappa)
