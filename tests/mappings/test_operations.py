"""Which argument orders are worth trying, and that the others really lead to nothing new."""

from __future__ import annotations

from itertools import permutations
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from relforest.mappings import OPERATIONS, Mapping
from relforest.scenes import Attribute, Schema
from strategies import coordinates

LOCATION = Attribute("location", 2)
PLANE = Schema((LOCATION,))


@pytest.mark.parametrize(
    ("operation", "expected"),
    [
        ("identity", [(4,)]),
        ("distance", [(1, 4)]),
        ("difference", [(1, 4)]),
        ("reframe", [(1, 4, 7), (1, 7, 4), (4, 1, 7), (4, 7, 1), (7, 1, 4), (7, 4, 1)]),
        ("scaled_reframe", [(1, 4, 7), (1, 7, 4), (4, 7, 1)]),
    ],
)
def test_argument_orders(operation: str, expected: list[tuple[int, ...]]) -> None:
    rule = OPERATIONS[operation]
    variables = {1: (4,), 2: (4, 1), 3: (7, 1, 4)}[rule.arity]

    assert list(rule.argument_orders(variables)) == expected


def test_codes_and_names_are_the_keys() -> None:
    assert [operation.code for operation in OPERATIONS.values()] == list(range(8))
    assert all(operation.name == name for name, operation in OPERATIONS.items())


def test_the_table_of_operations_is_closed() -> None:
    table: Any = OPERATIONS
    with pytest.raises(TypeError, match="item assignment"):
        table["angle"] = OPERATIONS["distance"]


def values(operation: str, points: NDArray[np.float64], order: tuple[int, ...]) -> NDArray[np.float64]:
    """Value for many triples of objects (n, 3, 2), taken in one order."""
    n = len(points)
    arity = OPERATIONS[operation].arity
    rows = np.arange(3 * n).reshape(n, 3)[:, order[:arity]]
    return Mapping(operation, LOCATION).evaluate(PLANE, points.reshape(3 * n, 2), rows)


def gaps(points: NDArray[np.float64]) -> NDArray[np.float64]:
    result: NDArray[np.float64] = np.linalg.norm(points[:, None] - points[None], axis=-1)
    return result


def triples() -> st.SearchStrategy[NDArray[np.float64]]:
    # Two triples of integer points: exact sums, and no pair of objects closer than 1 unless coincident.
    whole = st.integers(-20, 20).map(float)
    return hnp.arrays(np.float64, (2, 3, 2), elements=whole)


@given(triples())
@pytest.mark.parametrize("operation", ["distance", "difference", "scaled_reframe"])
def test_the_dropped_order_is_an_isometry_of_the_kept_one(
    operation: str, points: NDArray[np.float64]
) -> None:
    kept, dropped = values(operation, points, (0, 1, 2)), values(operation, points, (1, 0, 2))

    assert np.isnan(kept).tolist() == np.isnan(dropped).tolist()
    np.testing.assert_allclose(gaps(kept), gaps(dropped), rtol=1e-9, atol=1e-9)


@given(triples())
def test_how_the_symmetric_operations_mirror(points: NDArray[np.float64]) -> None:
    swapped = (1, 0, 2)
    distance = values("distance", points, swapped)
    difference = values("difference", points, swapped)
    scaled = values("scaled_reframe", points, swapped)

    np.testing.assert_array_equal(distance, values("distance", points, (0, 1, 2)))
    np.testing.assert_array_equal(difference, -values("difference", points, (0, 1, 2)))
    # z -> 1 - z, a half turn about (1/2, 0).
    np.testing.assert_allclose(scaled, [1, 0] - values("scaled_reframe", points, (0, 1, 2)), atol=1e-9)


def test_swapping_the_unscaled_frame_is_no_isometry() -> None:
    # Two scenes with frames of length 1 and 2 and C on A: w = 0 in both. Swapped, w = |B - A|: 1 and 2.
    points = np.array([[(0, 0), (1, 0), (0, 0)], [(0, 0), (2, 0), (0, 0)]], dtype=np.float64)

    assert gaps(values("reframe", points, (0, 1, 2)))[0, 1] == 0
    assert gaps(values("reframe", points, (1, 0, 2)))[0, 1] == 1


def test_no_two_kept_orders_of_a_frame_are_isometric() -> None:
    # If they were, an expansion would be tried twice and pay for it in significance.
    points = np.random.default_rng(0).uniform(-1, 1, size=(6, 3, 2))
    for operation in ("reframe", "scaled_reframe"):
        orders = OPERATIONS[operation].argument_orders((0, 1, 2))
        found = [gaps(values(operation, points, order)) for order in orders]
        for first, second in permutations(range(len(orders)), 2):
            assert not np.allclose(found[first], found[second], rtol=0.01)


@given(hnp.arrays(np.float64, (4, 2), elements=coordinates()))
def test_difference_of_angles_mirrors_exactly(angles: NDArray[np.float64]) -> None:
    heading = Attribute("heading", 1, "angle", ("difference",))
    mapping, schema = Mapping("difference", heading), Schema((heading,))
    matrix, rows = angles.reshape(8, 1), np.arange(8).reshape(4, 2)

    kept, dropped = mapping.evaluate(schema, matrix, rows), mapping.evaluate(schema, matrix, rows[:, ::-1])

    np.testing.assert_array_equal(kept, -dropped)
