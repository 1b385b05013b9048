"""Values of the mapping functions of section 4.3: by hand, undefined, and what leaves them unchanged."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from relforest.mappings import Mapping, catalogue
from relforest.scenes import Attribute, Schema
from relforest.support.errors import InputError
from strategies import coordinates

LOCATION = Attribute("location", 2)
COLOR = Attribute("color", 3)
HEADING = Attribute("heading", 1, "angle", ("identity", "difference"))
SCHEMA = Schema((COLOR, LOCATION, HEADING))

Point = tuple[float, float]
points = st.tuples(coordinates(), coordinates())


def value(operation: str, attribute: Attribute, *objects: float | tuple[float, ...]) -> list[float]:
    """Value for objects of which only one attribute is known."""
    matrix = np.full((len(objects), SCHEMA.width), np.nan)
    for row, components in enumerate(objects):
        matrix[row, SCHEMA.columns(attribute.name)] = components
    found = Mapping(operation, attribute).evaluate(SCHEMA, matrix, np.arange(len(objects))[None])
    assert found.shape == (1, Mapping(operation, attribute).dim)
    result: list[float] = found[0].tolist()
    return result


def test_values_by_hand() -> None:
    assert value("identity", LOCATION, (3, -4)) == [3, -4]
    assert value("identity", COLOR, (0.1, 0.2, 0.3)) == [0.1, 0.2, 0.3]
    assert value("identity", HEADING, 2.5) == [2.5]
    # 3, 4, 5.
    assert value("distance", LOCATION, (1, 1), (4, 5)) == [5]
    # sqrt(1 + 4 + 4) = 3.
    assert value("distance", COLOR, (0, 0, 0), (1, 2, 2)) == [3]
    # x_B - x_A, as printed.
    assert value("difference", LOCATION, (1, 1), (4, 5)) == [3, 4]
    assert value("difference", COLOR, (0.5, 0, 1), (1, 1, 1)) == [0.5, 1, 0]


@pytest.mark.parametrize(
    ("a", "b", "c", "unscaled", "scaled"),
    [
        # Test vectors of the source's program: u = (3, 4)/5; (dot, cross)(u, (0, 1)) = (.8, .6).
        ((0, 0), (3, 4), (0, 1), [0.8, 0.6], [0.16, 0.12]),
        # u = (0, -1): dot 0, cross = ux*wy - uy*wx = 0*0 - (-1)*1 = 1; over 2.
        ((0, 0), (0, -2), (1, 0), [0, 1], [0, 0.5]),
        # B itself and A itself.
        ((1, 1), (4, 5), (4, 5), [5, 0], [1, 0]),
        ((1, 1), (4, 5), (1, 1), [0, 0], [0, 0]),
    ],
)
def test_reframe_by_hand(a: Point, b: Point, c: Point, unscaled: list[float], scaled: list[float]) -> None:
    assert value("reframe", LOCATION, a, b, c) == pytest.approx(unscaled, abs=1e-15)
    assert value("scaled_reframe", LOCATION, a, b, c) == pytest.approx(scaled, abs=1e-15)


@pytest.mark.parametrize(
    ("a", "b", "c", "bearing", "scaled_distance"),
    [
        # A right angle on either side; twice and half as far.
        ((0, 0), (1, 0), (0, 2), math.pi / 2, 2.0),
        ((0, 0), (2, 0), (0, -1), math.pi / 2, 0.5),
        ((1, 1), (2, 2), (0, 0), math.pi, 1.0),
        ((0, 0), (3, 4), (6, 8), 0.0, 2.0),
    ],
)
def test_bearing_and_scaled_distance_by_hand(
    a: Point, b: Point, c: Point, bearing: float, scaled_distance: float
) -> None:
    assert value("bearing", LOCATION, a, b, c) == pytest.approx([bearing], abs=1e-12)
    assert value("scaled_distance", LOCATION, a, b, c) == pytest.approx([scaled_distance])


def test_an_object_at_the_place_of_a_has_no_bearing() -> None:
    assert math.isnan(value("bearing", LOCATION, (1, 1), (4, 5), (1, 1))[0])
    assert value("scaled_distance", LOCATION, (1, 1), (4, 5), (1, 1)) == [0.0]
    assert math.isnan(value("scaled_distance", LOCATION, (1, 1), (1, 1), (4, 5))[0])


def test_same_compares_categories() -> None:
    team = Attribute("team", kind="category", categories=["home", "guest"])
    matrix, rows = np.array([[0.0], [1.0], [1.0], [np.nan]]), np.array([[0, 1], [1, 2], [2, 3], [0, -1]])
    found = Mapping("same", team).evaluate(Schema((team,)), matrix, rows)

    assert np.array_equal(found[:, 0], [0.0, 1.0, np.nan, np.nan], equal_nan=True)


@pytest.mark.parametrize("operation", ["reframe", "scaled_reframe"])
def test_left_of_the_frame_is_positive(operation: str) -> None:
    # No reflection: whichever way A looks at B, its left hand has y > 0.
    for angle in np.linspace(-3, 3, 7):
        ahead = (math.cos(angle), math.sin(angle))
        left = (-math.sin(angle), math.cos(angle))
        assert value(operation, LOCATION, (0, 0), ahead, left) == pytest.approx([0, 1], abs=1e-12)


@pytest.mark.parametrize(
    ("a", "b", "expected"),
    [
        (0.5, 2.0, 1.5),
        (2.0, 0.5, -1.5),
        # 3 - (-3) = 6, the long way round: 6 - 2 pi.
        (-3.0, 3.0, 6 - 2 * math.pi),
        (3.0, -3.0, 2 * math.pi - 6),
        (1.25, 1.25, 0.0),
    ],
)
def test_differences_of_angles_take_the_short_way(a: float, b: float, expected: float) -> None:
    assert value("difference", HEADING, a, b) == pytest.approx([expected])


@given(coordinates(), coordinates())
def test_difference_of_angles_stays_on_the_circle(a: float, b: float) -> None:
    (found,) = value("difference", HEADING, a, b)

    assert -math.pi <= found <= math.pi
    assert math.cos(found) == pytest.approx(math.cos(b - a), abs=1e-9)
    assert math.sin(found) == pytest.approx(math.sin(b - a), abs=1e-9)


@pytest.mark.parametrize("operation", ["reframe", "scaled_reframe"])
def test_coincident_objects_span_no_frame(operation: str) -> None:
    assert np.isnan(value(operation, LOCATION, (1, 1), (1, 1), (1, 2))).all()
    assert np.isnan(value(operation, LOCATION, (1, 1), (1, 1), (1, 1))).all()


def test_coincident_objects_still_have_a_distance_and_a_difference() -> None:
    assert value("distance", LOCATION, (1, 1), (1, 1)) == [0]
    assert value("difference", LOCATION, (1, 1), (1, 1)) == [0, 0]


ALL = catalogue(
    Schema(
        (
            Attribute("location", 2),
            Attribute("weight"),
            Attribute("color", 3, operations=("distance",)),
            HEADING,
        )
    )
)


@pytest.mark.parametrize("mapping", ALL, ids=lambda mapping: mapping.name)
def test_a_missing_object_makes_the_whole_value_undefined(mapping: Mapping) -> None:
    schema = Schema((mapping.attribute,))
    matrix = np.arange(12.0).reshape(-1, schema.width) ** 1.5
    complete = np.arange(mapping.arity)
    for missing in range(mapping.arity):
        rows = np.array([complete, complete])
        rows[0, missing] = -1
        found = mapping.evaluate(schema, matrix, rows)
        assert np.isnan(found[0]).all()
        assert np.isfinite(found[1]).all()


@pytest.mark.parametrize("mapping", ALL, ids=lambda mapping: mapping.name)
def test_an_unknown_component_makes_the_whole_value_undefined(mapping: Mapping) -> None:
    schema = Schema((mapping.attribute,))
    complete = np.arange(12.0).reshape(-1, schema.width) ** 1.5
    for row in range(mapping.arity):
        for component in range(schema.width):
            matrix = complete.copy()
            matrix[row, component] = np.nan
            found = mapping.evaluate(schema, matrix, np.arange(mapping.arity)[None])
            assert np.isnan(found).all()


def test_other_attributes_may_be_unknown() -> None:
    matrix = np.array([[np.nan, np.nan, np.nan, 1.0, 2.0, np.nan]])

    assert Mapping("identity", LOCATION).evaluate(SCHEMA, matrix, np.array([[0]])).tolist() == [[1, 2]]


def test_objects_that_are_not_asked_about_may_be_unknown() -> None:
    matrix = np.full((3, SCHEMA.width), np.nan)
    matrix[1:, SCHEMA.columns("location")] = [[0, 0], [3, 4]]

    assert Mapping("distance", LOCATION).evaluate(SCHEMA, matrix, np.array([[1, 2]])).tolist() == [[5]]


def test_no_tuples_give_no_values() -> None:
    found = Mapping("difference", COLOR).evaluate(SCHEMA, np.empty((0, 6)), np.empty((0, 2), dtype=np.int64))

    assert found.shape == (0, 3)


def moved(point: Point, turn: float, offset: Point, scale: float = 1.0) -> Point:
    x, y = point
    return (
        scale * (math.cos(turn) * x - math.sin(turn) * y) + offset[0],
        scale * (math.sin(turn) * x + math.cos(turn) * y) + offset[1],
    )


@given(points, points, points, st.floats(-4, 4), points)
def test_distance_and_frames_do_not_see_translation_and_rotation(
    a: Point, b: Point, c: Point, turn: float, offset: Point
) -> None:
    assume(math.dist(a, b) > 0.1)
    there = [moved(point, turn, offset) for point in (a, b, c)]

    assert value("distance", LOCATION, *there[:2]) == pytest.approx(
        value("distance", LOCATION, a, b), abs=1e-9
    )
    for operation in ("reframe", "scaled_reframe"):
        expected = value(operation, LOCATION, a, b, c)
        assert value(operation, LOCATION, *there) == pytest.approx(expected, rel=1e-9, abs=1e-7)


@given(points, points, points, st.floats(0.1, 10))
def test_scale_matters_to_the_unscaled_frame_only(a: Point, b: Point, c: Point, scale: float) -> None:
    assume(math.dist(a, b) > 0.1)
    grown = [moved(point, 0.0, (0.0, 0.0), scale) for point in (a, b, c)]
    expected = [scale * component for component in value("reframe", LOCATION, a, b, c)]

    assert value("reframe", LOCATION, *grown) == pytest.approx(expected, rel=1e-9, abs=1e-7)
    assert value("scaled_reframe", LOCATION, *grown) == pytest.approx(
        value("scaled_reframe", LOCATION, a, b, c), rel=1e-9, abs=1e-7
    )


@given(points, points, points)
def test_difference_does_not_see_translation(a: Point, b: Point, offset: Point) -> None:
    there = [moved(point, 0.0, offset) for point in (a, b)]

    assert value("difference", LOCATION, *there) == pytest.approx(
        value("difference", LOCATION, a, b), abs=1e-9
    )


@given(points, points, points)
def test_frames_are_complex_division(a: Point, b: Point, c: Point) -> None:
    assume(math.dist(a, b) > 0.1)
    scaled = (complex(*c) - complex(*a)) / (complex(*b) - complex(*a))
    unscaled = scaled * math.dist(a, b)

    assert value("scaled_reframe", LOCATION, a, b, c) == pytest.approx(
        [scaled.real, scaled.imag], rel=1e-9, abs=1e-9
    )
    assert value("reframe", LOCATION, a, b, c) == pytest.approx(
        [unscaled.real, unscaled.imag], rel=1e-9, abs=1e-9
    )


@pytest.mark.parametrize(
    ("operation", "attribute", "message"),
    [
        ("angle", LOCATION, "unknown operation 'angle': use one of identity, distance"),
        ("reframe", COLOR, r"reframe\(color\) needs a 2-dimensional attribute, 'color' has 3"),
        ("scaled_reframe", HEADING, r"needs a 2-dimensional attribute, 'heading' has 1"),
        (
            "distance",
            HEADING,
            r"distance\(heading\) is not defined for kind 'angle': use identity, difference",
        ),
    ],
)
def test_an_operation_that_makes_no_sense_is_refused(
    operation: str, attribute: Attribute, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        Mapping(operation, attribute)


@pytest.mark.parametrize(
    ("matrix", "rows", "message"),
    [
        (
            np.zeros((2, 6)),
            [[0, 1, 1]],
            r"distance\(location\) needs a matrix \(n_objects, 6\) and rows \(n, 2\)",
        ),
        (np.zeros((2, 6)), [0, 1], r"got \(2, 6\) and \(2,\)"),
        (np.zeros((2, 5)), [[0, 1]], r"got \(2, 5\) and \(1, 2\)"),
        (np.zeros(6), [[0, 1]], r"got \(6,\)"),
        (np.zeros((2, 6)), [[0, 2]], "-1 or row numbers of the matrix, 0 to 1"),
        (np.zeros((2, 6)), [[-2, 0]], "-1 or row numbers of the matrix, 0 to 1"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(matrix: NDArray[np.float64], rows: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Mapping("distance", LOCATION).evaluate(SCHEMA, matrix, np.array(rows))


def test_an_attribute_of_another_schema_is_refused() -> None:
    with pytest.raises(InputError, match="no attribute 'weight'"):
        Mapping("identity", Attribute("weight")).evaluate(SCHEMA, np.zeros((1, 6)), np.array([[0]]))
