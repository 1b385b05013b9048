"""One mapping function: an operation applied to an attribute."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, final

import numpy as np

from relforest.mappings.kernels import map_points
from relforest.mappings.operations import OPERATIONS, Operation
from relforest.scenes.schema import OPERATIONS_BY_KIND, PLANAR_OPERATIONS
from relforest.support.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.scenes import Attribute, Schema

Space = Literal["euclidean", "circle", "category"]

_SPACES: Final[dict[str, Space]] = {"euclidean": "euclidean", "angle": "circle", "category": "category"}
_NUMBERS: Final = frozenset({"distance", "scaled_distance", "bearing", "same"})


@final
@dataclass(frozen=True, slots=True)
class Mapping:
    """A function from bound objects to a point, such as ``difference(location)``.

    Parameters
    ----------
    operation : str
        A name in `relforest.mappings.OPERATIONS`.
    attribute : Attribute
        The attribute whose values are used.

    Raises
    ------
    InputError
        If the operation is unknown or does not apply to the attribute.

    References
    ----------
    Palmer (2015), section 4.3. The difference is taken as printed there, ``x_B - x_A``.

    Examples
    --------
    >>> from relforest import Attribute
    >>> mapping = Mapping("distance", Attribute("location", 2))
    >>> mapping.name, mapping.arity, mapping.dim, mapping.space
    ('distance(location)', 2, 1, 'euclidean')
    """

    operation: str
    attribute: Attribute

    def __post_init__(self) -> None:
        if self.operation not in OPERATIONS:
            raise InputError(f"unknown operation {self.operation!r}: use one of {', '.join(OPERATIONS)}")
        if self.operation in PLANAR_OPERATIONS and self.attribute.dim != 2:
            raise InputError(
                f"{self.name} needs a 2-dimensional attribute, "
                f"{self.attribute.name!r} has {self.attribute.dim} dimension(s)"
            )
        allowed = OPERATIONS_BY_KIND[self.attribute.kind]
        if self.operation not in allowed:
            raise InputError(
                f"{self.name} is not defined for kind {self.attribute.kind!r}: use {', '.join(allowed)}"
            )

    @property
    def rule(self) -> Operation:
        """The operation's arity, code and symmetry."""
        return OPERATIONS[self.operation]

    @property
    def name(self) -> str:
        """Such as ``"difference(location)"``."""
        return f"{self.operation}({self.attribute.name})"

    @property
    def arity(self) -> int:
        """Number of objects that it takes."""
        return self.rule.arity

    @property
    def dim(self) -> int:
        """Dimension of the codomain."""
        return 1 if self.operation in _NUMBERS else self.attribute.dim

    @property
    def space(self) -> Space:
        """Whether the codomain is a Euclidean space, the circle, or a few values without order."""
        return _SPACES[self.attribute.kind]

    def evaluate(
        self, schema: Schema, matrix: NDArray[np.float64], rows: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        """Return the value for each tuple of objects.

        Parameters
        ----------
        schema : Schema
            Describes the columns of `matrix`.
        matrix : (n_objects, schema.width) float64
            Attribute values, NaN = undefined.
        rows : (n, arity) int64
            Object rows; -1 stands for "no object".

        Returns
        -------
        (n, dim) float64
            Rows of NaN where the value is undefined: an object or its attribute is missing, or the two
            objects of a frame coincide.

        Raises
        ------
        InputError
            If `matrix` or `rows` has the wrong shape, or a row number lies outside the matrix.
        """
        if matrix.shape != (len(matrix), schema.width) or rows.shape != (len(rows), self.arity):
            raise InputError(
                f"{self.name} needs a matrix (n_objects, {schema.width}) and rows (n, {self.arity}), "
                f"got {matrix.shape} and {rows.shape}"
            )
        if rows.size and not -1 <= rows.min() <= rows.max() < len(matrix):
            raise InputError(f"rows must be -1 or row numbers of the matrix, 0 to {len(matrix) - 1}")
        out = np.empty((len(rows), self.dim))
        span = (schema.offset(self.attribute.name), self.attribute.dim)
        map_points(self.rule.code, self.space == "circle", span, matrix, rows, out)
        return out
