"""Plain words for where a volume lies, and that they are true of scenes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from relforest.mappings import Mapping
from relforest.scenes import Attribute, Schema
from relforest.trees.bounds import Bounds
from relforest.trees.places import place
from relforest.volumes import Arc, Ellipsoid, Slab

LOCATION = Attribute("location", 2)
SCHEMA = Schema((LOCATION,))


def where(
    operation: str, mean: Sequence[float], half: Sequence[float], attribute: Attribute = LOCATION
) -> str:
    volume = Ellipsoid(np.array(mean, dtype=np.float64), np.diag(np.square(half)), 1.0, 3, 0.1)
    return place(Mapping(operation, attribute), volume, ["A", "B", "C"])


LOOKING = "looking from A to B"


@pytest.mark.parametrize(
    ("mean", "half", "expected"),
    [
        ([0.5, 0], [0.4, 0.2], "around the middle of the way from A to B"),
        ([0.55, 0.05], [0.3, 0.2], "around the middle of the way from A to B"),
        ([0.25, 0], [0.2, 0.1], "between A and B"),
        ([0.5, 0.15], [0.4, 0.2], "between A and B"),
        ([0.5, 0.3], [0.4, 0.2], "on the left of the way from A to B"),
        ([0.5, -0.3], [0.4, 0.2], "on the right of the way from A to B"),
        ([0.05, 0], [0.2, 0.2], "around A"),
        ([0.95, 0], [0.2, 0.2], "around B"),
        ([2, 0], [0.9, 2], "beyond B, looking from A"),
        ([2, 3], [0.9, 2], "beyond B on the left, looking from A"),
        ([-2, 0], [1, 1], f"behind A, {LOOKING}"),
        ([-2, -2], [1, 1], f"behind A on the right, {LOOKING}"),
        ([2, 0], [1.9, 2], f"in front of A, {LOOKING}"),
        ([0.5, 3], [2, 1], f"on the left of A, {LOOKING}"),
        # As far beside the way as it is long is not between.
        ([0.5, 0], [0.4, 1], ""),
        # Across A, across the line, and nothing in its middle.
        ([1, 0.5], [2, 0.7], ""),
    ],
)
def test_places_measured_from_one_object_to_another(
    mean: Sequence[float], half: Sequence[float], expected: str
) -> None:
    assert where("scaled_reframe", mean, half) == expected


@pytest.mark.parametrize(
    ("mean", "half", "expected"),
    [
        ([3, 0], [2, 1], f"in front of A, {LOOKING}"),
        ([3, 2], [2, 1], f"in front of A on the left, {LOOKING}"),
        ([-3, -2], [2, 1], f"behind A on the right, {LOOKING}"),
        ([0, 2], [2, 1], f"on the left of A, {LOOKING}"),
        ([0, -2], [2, 1], f"on the right of A, {LOOKING}"),
        ([0.2, 0.1], [2, 1], "around A"),
        # A twentieth of the extent may be on the other side of the border, but not more.
        ([1.81, 0], [2, 1], f"in front of A, {LOOKING}"),
        ([1.79, 0], [2, 1], ""),
    ],
)
def test_places_seen_from_one_object_towards_another(
    mean: Sequence[float], half: Sequence[float], expected: str
) -> None:
    assert where("reframe", mean, half) == expected


@pytest.mark.parametrize(
    ("mean", "half", "expected"),
    [
        ([3, 0], [2, 1], "at larger x than A"),
        ([-3, 2], [2, 1], "at smaller x and larger y than A"),
        ([0, 0], [2, 1], "around A"),
        ([1.5, 0], [2, 1], ""),
    ],
)
def test_offsets(mean: Sequence[float], half: Sequence[float], expected: str) -> None:
    assert where("difference", mean, half) == expected


def test_where_only_one_coordinate_counts() -> None:
    location, names = Attribute("location", 2), ["A", "B", "C"]

    def said(operation: str, axis: int, centre: float, half: float) -> str:
        interval = Ellipsoid(np.array([centre]), np.array([[half * half]]), 1.0, 3, 0.1)
        bounds = (Bounds(axis, centre - half, centre + half),)
        return place(Mapping(operation, location), Slab(interval, axis, 2), names, bounds)

    assert said("difference", 1, -3, 2) == "at smaller y than A"
    assert said("difference", 1, 0, 2) == ""
    assert said("reframe", 0, 3, 2) == f"in front of A, {LOOKING}"
    assert said("reframe", 1, 3, 2) == f"on the left of A, {LOOKING}"
    assert said("reframe", 0, 0, 2) == ""
    assert said("scaled_reframe", 0, 3, 1) == "beyond B, looking from A"
    # The way has no end on either side.
    assert said("scaled_reframe", 0, 0.5, 0.2) == ""


def test_offsets_in_space() -> None:
    space = Attribute("location", 3)

    assert where("difference", [0, 0, -3], [1, 1, 1], space) == "at smaller z than A"
    assert where("difference", [0, 0, 0], [1, 1, 1], space) == "around A"


def test_a_single_point_on_a_border_is_on_neither_side() -> None:
    assert where("reframe", [2, 0], [0, 0]) == f"in front of A, {LOOKING}"
    assert where("scaled_reframe", [0.5, 0], [0, 0]) == "around the middle of the way from A to B"


def test_only_locations_have_places() -> None:
    assert where("reframe", [3, 0], [2, 1], Attribute("velocity", 2)) == ""
    assert where("identity", [3, 0], [2, 1]) == ""
    assert where("distance", [3], [2]) == ""
    assert where("difference", [3], [2], Attribute("location")) == ""
    heading = Mapping("difference", Attribute("heading", 1, "angle"))
    assert place(heading, Arc(0.0, 1.0, 1.0), ["A", "B"]) == ""


# North is up: A in the south faces B in the north, so west is on the left.
SOUTH, NORTH, WEST = (0.0, 0.0), (0.0, 4.0), (-2.0, 2.0)


@pytest.mark.parametrize("operation", ["reframe", "scaled_reframe"])
@pytest.mark.parametrize(("mirrored", "side"), [(1.0, "left"), (-1.0, "right")])
def test_sides_are_those_of_the_scene_and_a_mirror_swaps_them(
    operation: str, mirrored: float, side: str
) -> None:
    matrix = np.array([SOUTH, NORTH, WEST]) * [mirrored, 1.0]
    (point,) = Mapping(operation, LOCATION).evaluate(SCHEMA, matrix, np.array([[0, 1, 2]]))

    said = where(operation, point, [0.1, 0.1])
    other = {"left": "right", "right": "left"}[side]
    assert f"on the {side}" in said
    assert other not in said
