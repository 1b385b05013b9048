"""The check passes for every mapping function of this library and finds each of its faults."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.mappings import Mapping, Operation, catalogue
from relforest.mappings.operations import Symmetry
from relforest.scenes import Attribute, Schema
from relforest.support.errors import InputError
from relforest.testing import check_mapping

Floats = NDArray[np.float64]
Rows = NDArray[np.int64]
Change = Callable[[Floats, Floats, Rows], Floats]

LOCATION = Attribute("location", 2)
HEADING = Attribute("heading", 1, "angle", ("identity", "difference"))
ALL = catalogue(Schema((LOCATION, Attribute("weight"), Attribute("color", 3), HEADING)))


@dataclass(frozen=True)
class Broken:
    """A mapping whose values are changed: ``change(values, matrix, rows)``."""

    original: Mapping
    change: Change
    symmetry: Symmetry | None = None

    @property
    def operation(self) -> str:
        return self.original.operation

    @property
    def attribute(self) -> Attribute:
        return self.original.attribute

    @property
    def rule(self) -> Operation:
        rule = self.original.rule
        return rule if self.symmetry is None else replace(rule, symmetry=self.symmetry)

    @property
    def arity(self) -> int:
        return self.original.arity

    @property
    def dim(self) -> int:
        return self.original.dim

    @property
    def space(self) -> str:
        return self.original.space

    def evaluate(self, schema: Schema, matrix: Floats, rows: Rows) -> Floats:
        return self.change(self.original.evaluate(schema, matrix, rows), matrix, rows)


def unchanged(values: Floats, _matrix: Floats, _rows: Rows) -> Floats:
    return values


@pytest.mark.parametrize("mapping", ALL, ids=lambda mapping: mapping.name)
def test_the_mappings_of_this_library_conform(mapping: Mapping) -> None:
    for seed in range(3):
        check_mapping(mapping, seed=seed)


def test_an_unchanged_double_conforms() -> None:
    check_mapping(Broken(Mapping("scaled_reframe", LOCATION), unchanged))


def never_nan(values: Floats, _matrix: Floats, _rows: Rows) -> Floats:
    return np.nan_to_num(values, nan=0.0)


def nan_in_one_component(values: Floats, _matrix: Floats, _rows: Rows) -> Floats:
    values[:, 1] = np.nan_to_num(values[:, 1], nan=0.0)
    return values


def too_often_nan(values: Floats, matrix: Floats, _rows: Rows) -> Floats:
    return np.full_like(values, np.nan) if np.isnan(matrix).any() else values


def with_other_attribute(values: Floats, matrix: Floats, rows: Rows) -> Floats:
    return values + matrix[rows[:, 0], -1:]


def from_the_origin(values: Floats, matrix: Floats, rows: Rows) -> Floats:
    # The attribute's columns are 2 and 3.
    length: Floats = np.linalg.norm(matrix[rows[:, 0], 2:4], axis=1, keepdims=True)
    return values + length


def along_the_first_axis(values: Floats, matrix: Floats, rows: Rows) -> Floats:
    # The fault of the source's own program: |x_A[0] - x_B[0]| instead of the distance.
    gaps: Floats = np.where(
        np.isnan(values), np.nan, np.abs(matrix[rows[:, 0], 2:3] - matrix[rows[:, 1], 2:3])
    )
    return gaps


@pytest.mark.parametrize(
    ("operation", "change", "message"),
    [
        ("identity", lambda values, _matrix, _rows: values[:, :1], r"^values: the shape must be \(120, 2\)"),
        ("identity", lambda values, _matrix, _rows: values / 0.0, "^values: the value must be finite"),
        ("distance", with_other_attribute, "^values: they must depend only on 'location'"),
        ("distance", never_nan, "^undefined: the value must be NaN where object number 1 is missing"),
        ("difference", nan_in_one_component, "^undefined: the value must be NaN where object number 1"),
        ("difference", too_often_nan, "^undefined: the value must be NaN only where component number 1"),
        ("distance", from_the_origin, "^symmetry: exchanging two objects is not an isometry"),
        (
            "distance",
            along_the_first_axis,
            "^invariance: the values must not change under a rotation of all objects",
        ),
        (
            "reframe",
            from_the_origin,
            "^invariance: .* under a translation of all objects",
        ),
    ],
)
def test_faults_in_values(operation: str, change: Change, message: str) -> None:
    with np.errstate(all="ignore"), pytest.raises(AssertionError, match=message):
        check_mapping(Broken(Mapping(operation, LOCATION), change))


def test_an_angle_that_is_not_wrapped() -> None:
    def unwrapped(values: Floats, _matrix: Floats, _rows: Rows) -> Floats:
        return values + np.pi

    with pytest.raises(AssertionError, match=r"^values: angles must be in \[-pi, pi\]"):
        check_mapping(Broken(Mapping("difference", HEADING), unwrapped))


def test_a_frame_that_is_not_divided_by_its_length() -> None:
    # An unscaled frame under the name of the scaled one, without the symmetry that it does not have.
    original = Mapping("scaled_reframe", LOCATION)

    def unscaled(values: Floats, matrix: Floats, rows: Rows) -> Floats:
        length = np.linalg.norm(matrix[rows[:, 1], 2:4] - matrix[rows[:, 0], 2:4], axis=1, keepdims=True)
        grown: Floats = values * length
        return grown

    with pytest.raises(AssertionError, match=r"^invariance: .* under a scaling of all objects"):
        check_mapping(Broken(original, unscaled, symmetry="none"))


def test_a_symmetry_that_does_not_hold() -> None:
    with pytest.raises(AssertionError, match=r"^symmetry: .* do not claim symmetry"):
        check_mapping(Broken(Mapping("reframe", LOCATION), unchanged, symmetry="swap-first-two"))


def test_a_symmetry_of_one_object() -> None:
    with pytest.raises(AssertionError, match=r"^orders: a single object cannot be exchanged"):
        check_mapping(Broken(Mapping("identity", LOCATION), unchanged, symmetry="swap-first-two"))


def test_a_symmetry_that_is_not_claimed_is_allowed() -> None:
    # It costs time, but it is not wrong.
    check_mapping(Broken(Mapping("distance", LOCATION), unchanged, symmetry="none"))


@pytest.mark.parametrize("orders", [((1, 4), (1, 4)), (), ((1, 1),), ((1, 4), (4, 1), (1, 6))])
def test_argument_orders_that_do_not_stand_for_all(orders: tuple[tuple[int, ...], ...]) -> None:
    class Rule:
        symmetry = "swap-first-two"

        def argument_orders(self, _variables: tuple[int, ...]) -> tuple[tuple[int, ...], ...]:
            return orders

    class BadOrders(Broken):
        @property
        def rule(self) -> Operation:
            return Rule()  # type: ignore[return-value]

    with pytest.raises(AssertionError, match=r"^orders: .* do not represent each order"):
        check_mapping(BadOrders(Mapping("distance", LOCATION), unchanged))


def test_a_bad_seed_is_refused() -> None:
    with pytest.raises(InputError, match="seed must be an integer of at least 0"):
        check_mapping(Mapping("identity", LOCATION), seed=-1)


@pytest.mark.parametrize("mapping", [None, "distance", 3, Mapping])
def test_what_is_not_a_mapping_is_refused(mapping: Any) -> None:
    with pytest.raises(InputError, match="mapping must be a function like Mapping"):
        check_mapping(mapping)
