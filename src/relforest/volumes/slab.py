"""The decision volume of a single coordinate: an interval, whatever the other coordinates are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, final

import numpy as np

from relforest.support.documents import well_formed
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.notebook import drawn
from relforest.support.options import between
from relforest.volumes.ellipsoid import Ellipsoid

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

LARGEST_DIM: Final = 100_000


@final
@dataclass(frozen=True, slots=True, eq=False)
class Slab:
    """All points with one coordinate in an interval.

    Parameters
    ----------
    interval : Ellipsoid
        One-dimensional.
    axis : int
        The coordinate, from 0.
    dim : int
        Dimension d of the space.
    """

    interval: Ellipsoid
    axis: int
    dim: int

    _repr_html_ = drawn

    @property
    def radius(self) -> float:
        """Largest distance that still counts as inside, as for `Ellipsoid`."""
        return self.interval.radius

    @property
    def density_sharpness(self) -> float:
        """Factor on the squared distance in the density's exponent."""
        return self.interval.density_sharpness

    @property
    def mean(self) -> NDArray[np.float64]:
        """The centre, with 0 for the coordinates that do not matter, (d,)."""
        mean = np.zeros(self.dim)
        mean[self.axis] = self.interval.mean[0]
        return mean

    @property
    def precision(self) -> NDArray[np.float64]:
        """Inverse variance of the coordinate, 0 for all others, (d, d)."""
        precision = np.zeros((self.dim, self.dim))
        precision[self.axis, self.axis] = self.interval.precision[0, 0]
        return precision

    def coordinate(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return the coordinate (n, 1) that matters of points (n, d)."""
        rows = np.atleast_2d(np.asarray(points, dtype=np.float64))
        if rows.shape[1:] != (self.dim,):
            raise InputError(f"points must have the shape (n, {self.dim}), got {rows.shape}")
        return rows[:, self.axis : self.axis + 1]

    def distance(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return the distance of each point (n, d) from the centre of the interval; (n,)."""
        return self.interval.distance(self.coordinate(points))

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Return which points (n, d) lie inside, including the boundary; (n,)."""
        return self.interval.contains(self.coordinate(points))

    def density(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return the Gaussian density of each point (n, d) relative to the peak; (n,) in [0, 1]."""
        return self.interval.density(self.coordinate(points))

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON form."""
        return {"shape": "slab", "axis": self.axis, "dim": self.dim, "interval": self.interval.to_dict()}

    @classmethod
    def from_dict(cls, document: dict[str, Any]) -> Slab:
        """Read what `to_dict` returned.

        Raises
        ------
        ModelFormatError
            If a value is missing or out of bounds.
        """
        with well_formed("malformed slab"):
            dim = between("dim", document["dim"], 2, LARGEST_DIM)
            axis = between("axis", document["axis"], 0, dim - 1)
            interval = Ellipsoid.from_dict(document["interval"])
        if interval.dim != 1:
            raise ModelFormatError(f"malformed slab: the interval has {interval.dim} dimensions, not 1")
        return cls(interval, axis, dim)
