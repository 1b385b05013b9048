from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from relforest.worlds.blocks.scene import (
    FARTHEST,
    SCHEMA,
    bounds,
    colors,
    describe,
    describe_state,
    extents,
    locations,
    scene,
    virtual_objects,
)
from worlds.blocks.staged_blocks import LONG, staged

RED = (1.0, 0.0, 0.0)


def test_a_block_as_an_object_by_hand() -> None:
    state = staged(((2, 4), (3, 4, 0.0)), (LONG, (-1, 2, 0.1)), colors=[RED, (0.0, 0.5, 1.0)])
    objects = describe_state(state)
    # x, y, the longer half side, the shorter, twice the angle of the longer side, RGB.
    np.testing.assert_allclose(objects[0], [3, 4, 4, 2, math.pi, 1, 0, 0])
    np.testing.assert_allclose(objects[1], [-1, 2, 4, 2, 0.2, 0, 0.5, 1])
    assert SCHEMA.names == ("location", "extent", "orientation", "color")
    assert SCHEMA["orientation"].kind == "angle"
    assert locations(objects).tolist() == [[3, 4], [-1, 2]]
    assert extents(objects).tolist() == [[4, 2], [4, 2]]
    assert colors(objects).tolist() == [[1, 0, 0], [0, 0.5, 1]]


@given(st.integers(0, 2**32 - 1))
def test_a_block_looks_the_same_after_half_a_turn_or_with_its_sides_renamed(seed: int) -> None:
    rng = np.random.default_rng(seed)
    half, (x, y, angle) = rng.uniform(0.5, 5.0, 2), rng.uniform(-10, 10, 3)
    color = rng.random((1, 3))
    looks = [
        describe(sides[np.newaxis], np.array([[x, y, turned]]), color)
        for sides, turned in ((half, angle), (half, angle + math.pi), (half[::-1], angle + math.pi / 2))
    ]
    # Angles on both ends of the interval are the same.
    for other in looks[1:]:
        difference = other - looks[0]
        difference[:, 4] = np.remainder(difference[:, 4] + math.pi, 2 * math.pi) - math.pi
        np.testing.assert_allclose(difference, 0.0, atol=1e-9)
    assert -math.pi < looks[0][0, 4] <= math.pi


@given(st.integers(0, 2**32 - 1))
def test_bounds_can_be_told_from_objects(seed: int) -> None:
    rng = np.random.default_rng(seed)
    state = staged(*((tuple(rng.uniform(0.5, 5, 2)), tuple(rng.uniform(-10, 10, 3))) for _ in range(4)))
    np.testing.assert_allclose(bounds(describe_state(state)), state.bounds, atol=1e-9)


def test_a_virtual_object_has_a_location_only() -> None:
    objects = virtual_objects(np.array([-3.5, 1e9]))
    assert locations(objects).tolist() == [[-3.5, 0.0], [FARTHEST, 0.0]]
    assert np.isnan(objects[:, 2:]).all()


def test_a_lost_block_is_shown_within_bounds() -> None:
    assert locations(describe_state(staged((LONG, (5000, -7000, 0))))).tolist() == [[1000, -1000]]


def test_the_scene_names_its_blocks() -> None:
    objects = describe_state(staged((LONG, (0, 2, 0)), (LONG, (9, 2, 0))))
    found = scene(objects, [17, 18])
    assert found.object_ids.tolist() == ["block_17", "block_18"]
    assert len(found) == 1
    np.testing.assert_array_equal(found.matrix, objects)
