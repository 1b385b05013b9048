"""The properties of every mapping function, as a check that users can run on their own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import permutations
from typing import Final, Protocol, final, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from relforest.mappings import Operation
from relforest.scenes import Attribute, Schema
from relforest.support.errors import InputError
from relforest.support.options import at_least
from relforest.testing.moments import violation

Floats = NDArray[np.float64]
Rows = NDArray[np.int64]
Motion = Callable[[Floats], Floats]

_N_OBJECTS: Final = 40
_N_TUPLES: Final = 120
# Which motions of all objects leave the values as they are.
_INVARIANT: Final = {
    "distance": ("translation", "rotation"),
    "difference": ("translation",),
    "reframe": ("translation", "rotation"),
    "scaled_reframe": ("translation", "rotation", "scaling"),
}


@runtime_checkable
class CheckableMapping(Protocol):
    """The interface of a mapping function; see `relforest.mappings.Mapping`."""

    @property
    def operation(self) -> str:
        """Name of the operation."""

    @property
    def attribute(self) -> Attribute:
        """The attribute that it maps."""

    @property
    def rule(self) -> Operation:
        """Arity and symmetry."""

    @property
    def arity(self) -> int:
        """Number of objects."""

    @property
    def dim(self) -> int:
        """Dimension of the codomain."""

    @property
    def space(self) -> str:
        """``"euclidean"`` or ``"circle"``."""

    def evaluate(self, schema: Schema, matrix: Floats, rows: Rows) -> Floats:
        """Value (n, dim) for each tuple of objects (n, arity), NaN where undefined."""


@final
@dataclass(frozen=True, slots=True, eq=False)
class _Sample:
    """Objects with one attribute before and one after the attribute under test, and tuples of objects."""

    mapping: CheckableMapping
    schema: Schema
    matrix: Floats
    rows: Rows

    @property
    def columns(self) -> slice:
        """Where the attribute stands."""
        return self.schema.columns(self.mapping.attribute.name)

    def values(self, *, matrix: Floats | None = None, rows: Rows | None = None) -> Floats:
        """Values of the mapping, (n, dim)."""
        return self.mapping.evaluate(
            self.schema, self.matrix if matrix is None else matrix, self.rows if rows is None else rows
        )

    def moved(self, motion: Motion) -> Floats:
        """The matrix with another attribute value for every object."""
        matrix = self.matrix.copy()
        matrix[:, self.columns] = motion(matrix[:, self.columns])
        return matrix


def check_mapping(mapping: CheckableMapping, *, seed: int = 0) -> None:
    """Check the properties of a mapping function that learning and prediction rely on.

    Parameters
    ----------
    mapping : Mapping
        Such as ``Mapping("reframe", Attribute("location", 2))``.
    seed : int
        Seed of the random objects.

    Raises
    ------
    InputError
        If ``mapping`` is not a mapping, or the seed is not an integer of at least 0.
    AssertionError
        If a clause is violated; the message begins with the name of the clause.

    Notes
    -----
    The clauses, in the order of checking:

    - ``values``: (n, dim), finite for different objects that have the attribute, in [-pi, pi] on the
      circle, repeatable, and independent of all other attributes.
    - ``undefined``: NaN in all components if an object is missing (-1) or a component of its attribute is
      NaN, and only then.
    - ``orders``: the argument orders are different permutations which, together with the claimed symmetry,
      represent all permutations.
    - ``symmetry``: if it is claimed, exchanging the first two objects moves all points by an isometry, so
      that a volume for one order has an exact counterpart for the other.
    - ``invariance``: distances and frames do not change when all objects are moved or turned together (nor
      the scaled frame when everything grows), and differences do not change when all objects are moved.

    Examples
    --------
    >>> from relforest import Attribute
    >>> from relforest.mappings import Mapping
    >>> check_mapping(Mapping("scaled_reframe", Attribute("location", 2)))
    """
    rng = np.random.default_rng(at_least("seed", seed, 0))
    if isinstance(mapping, type) or not isinstance(mapping, CheckableMapping):
        raise InputError(f'mapping must be a function like Mapping("distance", ...), got {mapping!r}')
    sample = _draw(mapping, rng)
    _check_values(sample, rng)
    _check_undefined(sample, rng)
    _check_orders(mapping)
    _check_symmetry(sample)
    _check_invariance(sample, rng)


def _draw(mapping: CheckableMapping, rng: np.random.Generator) -> _Sample:
    name = mapping.attribute.name
    schema = Schema((Attribute(f"before {name}", 2), mapping.attribute, Attribute(f"behind {name}")))
    matrix = rng.uniform(-np.pi, np.pi, size=(_N_OBJECTS, schema.width))
    tuples = rng.permuted(np.tile(np.arange(_N_OBJECTS), (_N_TUPLES, 1)), axis=1)
    return _Sample(mapping, schema, matrix, np.ascontiguousarray(tuples[:, : mapping.arity]))


def _check_values(sample: _Sample, rng: np.random.Generator) -> None:
    found, expected = sample.values(), (len(sample.rows), sample.mapping.dim)
    if found.shape != expected:
        raise violation("values", f"the shape must be {expected}, got {found.shape}")
    if not np.isfinite(found).all():
        raise violation("values", "the value must be finite if all objects have the attribute")
    if sample.mapping.space == "circle" and (np.abs(found) > np.pi).any():
        raise violation("values", "angles must be in [-pi, pi]")
    others = rng.uniform(size=sample.matrix.shape)
    others[:, sample.columns] = sample.matrix[:, sample.columns]
    if not np.array_equal(sample.values(), found) or not np.array_equal(sample.values(matrix=others), found):
        raise violation("values", f"they must depend only on {sample.mapping.attribute.name!r}")


def _check_undefined(sample: _Sample, rng: np.random.Generator) -> None:
    for place in range(sample.mapping.arity):
        missing = sample.rows.copy()
        is_missing = rng.random(len(missing)) < 0.5
        missing[is_missing, place] = -1
        _check_nan(sample.values(rows=missing), is_missing, f"object number {place + 1} is missing")
    for component in range(sample.mapping.attribute.dim):
        matrix = sample.matrix.copy()
        is_unknown = rng.random(len(matrix)) < 0.3
        matrix[is_unknown, sample.columns.start + component] = np.nan
        is_affected = np.logical_or.reduce(is_unknown[sample.rows], axis=1)
        _check_nan(sample.values(matrix=matrix), is_affected, f"component number {component + 1} is NaN")


def _check_nan(found: Floats, expected: NDArray[np.bool_], where: str) -> None:
    if not np.isnan(found[expected]).all():
        raise violation("undefined", f"the value must be NaN where {where}")
    if np.isnan(found[~expected]).any():
        raise violation("undefined", f"the value must be NaN only where {where}")


def _check_orders(mapping: CheckableMapping) -> None:
    is_symmetric = mapping.rule.symmetry == "swap-first-two"
    if is_symmetric and mapping.arity < 2:
        raise violation("orders", "a single object cannot be exchanged with another")
    variables = (1, 4, 6)[: mapping.arity]
    orders = mapping.rule.argument_orders(variables)
    reached = {*orders}
    if is_symmetric:
        reached |= {(b, a, *others) for a, b, *others in orders}
    if len(set(orders)) < len(orders) or reached != set(permutations(variables)):
        raise violation("orders", f"{orders} do not represent each order of {variables} exactly once")


def _check_symmetry(sample: _Sample) -> None:
    if sample.mapping.rule.symmetry != "swap-first-two":
        return
    places = [1, 0, *range(2, sample.mapping.arity)]
    before, after = _all_gaps(sample), _all_gaps(sample, sample.rows[:, places])
    if not np.allclose(before, after, rtol=1e-6, atol=1e-9):
        raise violation("symmetry", "exchanging two objects is not an isometry: do not claim symmetry")


def _all_gaps(sample: _Sample, rows: Rows | None = None) -> Floats:
    """Distances between the points of all pairs of tuples."""
    points = sample.values(rows=rows)
    return _gaps(sample, points[:, None, :], points[None, :, :])


def _gaps(sample: _Sample, points: Floats, others: Floats) -> Floats:
    offsets = points - others
    if sample.mapping.space == "circle":
        offsets = np.angle(np.exp(1j * offsets))
    gaps: Floats = np.linalg.norm(offsets, axis=-1)
    return gaps


def _check_invariance(sample: _Sample, rng: np.random.Generator) -> None:
    values = sample.values()
    size = np.linalg.norm(values, axis=-1)
    for motion in _INVARIANT.get(sample.mapping.operation, ()):
        moved = sample.values(matrix=sample.moved(_motion(motion, sample.mapping.attribute.dim, rng)))
        if (_gaps(sample, moved, values) > 1e-6 * (1.0 + size)).any():
            raise violation("invariance", f"the values must not change under a {motion} of all objects")


def _motion(motion: str, dim: int, rng: np.random.Generator) -> Motion:
    if motion == "translation":
        offset = rng.normal(size=dim)
        return lambda points: points + offset
    if motion == "scaling":
        return lambda points: 3.0 * points
    turn = np.linalg.qr(rng.normal(size=(dim, dim)))[0]
    # A rotation, no reflection: frames keep left and right apart.
    turn[:, 0] *= np.linalg.det(turn)
    return lambda points: points @ turn.T
