from __future__ import annotations

import gc
import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reference.blocks import PlainEngine
from relforest.support.errors import InputError, RelforestError
from relforest.worlds.blocks.box import shared
from relforest.worlds.blocks.engine import LOST, REST_SPEED, REST_SPIN, Engine, Spring
from relforest.worlds.blocks.grasp import springs


def lifted(half_extents: tuple[float, float]) -> int:
    """Return the steps that a box, grasped at its centre, takes from the table to a height of 20."""
    engine = Engine()
    box = engine.add_box(half_extents, (0.0, half_extents[1] + 0.02))
    engine.settle(100)
    engine.grab(box, springs((0.0, 0.0), half_extents))
    engine.step()
    steps, arrived = engine.carry((0.0, 20.0), 500)
    assert arrived
    return steps


def test_a_box_falls_twice_as_fast_as_the_clock_says() -> None:
    engine = Engine()
    engine.add_box((1.0, 1.0), (0.0, 50.0))
    engine.step(100)

    # 100 steps of 0.02 s at 10 per second squared: speed 20, and 0.02 * 0.2 * (1 + ... + 100) = 20.2 lower.
    assert engine.velocities()[0] == pytest.approx([0.0, -20.0, 0.0], abs=1e-4)
    assert engine.poses()[0] == pytest.approx([0.0, 29.8, 0.0], abs=1e-3)


def test_boxes_rest_on_the_table_and_on_each_other() -> None:
    engine = Engine()
    lower, upper = engine.add_box((3.0, 1.0), (5.0, 1.5)), engine.add_box((1.0, 2.0), (5.0, 5.0))
    _, resting = engine.settle(500)

    # The skin of Box2D keeps surfaces up to 0.015 apart.
    assert resting
    assert engine.pose(lower)[:2] == pytest.approx((5.0, 1.01), abs=0.02)
    assert engine.pose(upper)[:2] == pytest.approx((5.0, 4.02), abs=0.02)
    assert engine.contacts() == {(lower, upper)}


def test_settling_ends_with_the_first_step_at_rest() -> None:
    engine, twin = Engine(), PlainEngine()
    for world in (engine, twin):
        world.add_box((2.0, 1.0), (0.0, 8.0), 0.4)
    steps, _ = engine.settle(500)
    twin.step(steps - 1)

    assert not twin.is_resting()
    twin.step()
    assert twin.is_resting()
    assert engine.is_resting()
    speeds = engine.velocities()[0]
    assert math.hypot(*speeds[:2]) < REST_SPEED
    assert abs(speeds[2]) < REST_SPIN


def test_settling_takes_one_step_at_least_and_no_more_than_allowed() -> None:
    engine = Engine()

    assert engine.settle(500) == (1, True)
    engine.add_box((1.0, 1.0), (0.0, 30.0))
    assert engine.settle(7) == (7, False)
    assert engine.settle(0) == (0, False)


def test_spin_alone_can_be_left_out_of_rest() -> None:
    engine = Engine()
    engine.add_box((1.0, 1.0), (0.0, 30.0))

    assert engine.settle(50, speed=math.inf, spin=math.inf) == (1, True)


@pytest.mark.parametrize(
    ("half_extents", "steps"),
    [((0.5, 0.5), 57), ((5.0, 0.5), 153), ((2.75, 2.75), 245), ((4.0, 2.0), 252), ((2.0, 4.0), 248)],
)
def test_lifting_takes_as_long_as_in_the_source(half_extents: tuple[float, float], steps: int) -> None:
    # Measured in the author's simulator, which has another generation of the engine.
    assert lifted(half_extents) == pytest.approx(steps, rel=0.02)


def test_the_heaviest_box_is_lifted_nearly_as_fast_as_in_the_source() -> None:
    assert lifted((5.0, 5.0)) == pytest.approx(410, rel=0.05)


def test_a_held_box_cannot_be_pushed_through_the_table() -> None:
    engine = Engine()
    box = engine.add_box((2.0, 2.0), (0.0, 2.02))
    engine.grab(box, springs((0.0, 0.0), (2.0, 2.0)))
    steps, arrived = engine.carry((0.0, -3.0), 300)

    assert (steps, arrived) == (300, False)
    assert engine.pose(box)[1] > 1.9


def test_a_box_that_falls_off_the_table_is_removed() -> None:
    engine = Engine(table_half_width=10.0)
    stays, falls = engine.add_box((1.0, 1.0), (0.0, 1.02)), engine.add_box((1.0, 1.0), (13.0, 4.0))
    lowest = 4.0
    while falls in engine.keys:
        lowest = engine.bounds()[1, 3]
        engine.step()

    assert LOST <= lowest < LOST + 0.5
    assert engine.keys == (stays,)
    assert engine.poses().shape == (1, 3)
    with pytest.raises(InputError, match="box 1 does not exist"):
        engine.pose(falls)


def test_a_box_that_is_lost_is_let_go() -> None:
    engine = Engine(table_half_width=10.0)
    box = engine.add_box((1.0, 1.0), (0.0, 1.02))
    engine.grab(box, springs((0.0, 0.0), (1.0, 1.0)))
    engine.carry((20.0, 5.0), 500)
    _, ended = engine.carry((20.0, -40.0), 500)

    assert ended
    assert engine.held is None
    assert engine.keys == ()
    assert engine.carry((0.0, 0.0), 500) == (0, True)


def test_keys_are_not_used_again() -> None:
    engine = Engine()
    engine.remove(engine.add_box((1.0, 1.0), (0.0, 5.0)))

    assert engine.add_box((1.0, 1.0), (0.0, 5.0)) == 1


def test_removing_the_held_box_lets_it_go() -> None:
    engine = Engine()
    box = engine.add_box((1.0, 1.0), (0.0, 5.0))
    engine.grab(box, springs((0.0, 0.0), (1.0, 1.0)))
    engine.remove(box)

    assert engine.held is None
    engine.step(3)


def test_bounds_are_those_of_the_rotated_box() -> None:
    engine = Engine()
    engine.add_box((4.0, 2.0), (1.0, 10.0), math.pi / 6)

    # cos 30 = 0.8660, sin 30 = 0.5: 4 * 0.8660 + 2 * 0.5 = 4.4641 across, 4 * 0.5 + 2 * 0.8660 = 3.7321 up.
    assert engine.bounds()[0] == pytest.approx([1 - 4.4641, 1 + 4.4641, 10 - 3.7321, 10 + 3.7321], abs=1e-3)


def test_results_are_copies() -> None:
    engine = Engine()
    engine.add_box((1.0, 1.0), (0.0, 30.0))
    poses, velocities, bounds = engine.poses(), engine.velocities(), engine.bounds()
    engine.step(20)

    assert poses[0, 1] == 30.0
    assert velocities[0, 1] == 0.0
    assert bounds[0, 3] == 31.0


def test_empty_engines_give_empty_arrays() -> None:
    engine = Engine()
    engine.step(3)

    assert engine.poses().shape == engine.velocities().shape == (0, 3)
    assert engine.bounds().shape == (0, 4)
    assert engine.contacts() == frozenset()


def test_engines_do_not_touch_each_other() -> None:
    alone, beside, other = Engine(), Engine(), Engine()
    for engine in (alone, beside, other):
        engine.add_box((1.0, 2.0), (0.0, 9.0), 0.3)
    other.add_box((5.0, 5.0), (1.0, 20.0))
    alone.step(200)
    for _ in range(200):
        beside.step()
        other.step()
        gc.collect(0)

    assert beside.poses().tobytes() == alone.poses().tobytes()


class TestTwin:
    """The plain engine does the same, bit for bit."""

    @given(
        boxes=st.lists(
            st.tuples(st.floats(0.5, 5.0), st.floats(0.5, 5.0), st.floats(-14.0, 14.0), st.floats(3.0, 40.0)),
            min_size=1,
            max_size=5,
        ),
        angle=st.floats(-math.pi, math.pi),
        goal=st.tuples(st.floats(-25.0, 25.0), st.floats(-2.0, 30.0)),
        at=st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)),
    )
    @settings(max_examples=25, deadline=None)
    def test_small_tables_agree(
        self,
        boxes: list[tuple[float, float, float, float]],
        angle: float,
        goal: tuple[float, float],
        at: tuple[float, float],
    ) -> None:
        results = []
        for engine in (Engine(table_half_width=12.0), PlainEngine(table_half_width=12.0)):
            for width, height, x, y in boxes:
                engine.add_box((width, height), (x, y), angle)
            seen: list[object] = [engine.settle(400), engine.keys]
            if engine.keys:
                key = engine.keys[0]
                width, height = boxes[key][:2]
                engine.grab(key, springs((at[0] * width, at[1] * height), (width, height)))
                seen += [engine.carry(goal, 200), engine.held]
                engine.let_go()
                seen += [engine.settle(300), engine.keys]
            seen += [part.tobytes() for part in (engine.poses(), engine.velocities(), engine.bounds())]
            results.append([*seen, engine.contacts()])

        assert results[0] == results[1]

    def test_boxes_that_fall_while_others_rest_agree(self) -> None:
        results = []
        for engine in (Engine(table_half_width=4.0), PlainEngine(table_half_width=4.0)):
            engine.add_box((1.0, 1.0), (0.0, 1.02))
            engine.add_box((1.0, 1.0), (6.0, 20.0))
            results.append((engine.settle(500), engine.keys))

        assert results[0] == results[1]
        assert results[0][1] == (0,)

    def test_a_box_that_falls_asleep_on_the_way_agrees(self) -> None:
        results = []
        for engine in (Engine(), PlainEngine()):
            heavy, light = engine.add_box((5.0, 5.0), (0.0, 5.02)), engine.add_box((1.0, 1.0), (-6.1, 1.02))
            engine.settle(300)
            engine.grab(light, [Spring((0.0, 0.0), 5.0, 12.0, 8.0)])
            seen = [engine.carry((1.0, 1.02), 300), engine.carry((1.0, 1.05), 300)]
            results.append((seen, engine.poses().tobytes(), heavy))

        assert results[0] == results[1]
        assert results[0][0] == [(300, False), (300, False)]


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e300])
def test_numbers_must_be_finite_and_near(bad: float) -> None:
    engine = Engine()
    with pytest.raises(InputError, match="position"):
        engine.add_box((1.0, 1.0), (bad, 1.0))
    with pytest.raises(InputError, match="angle"):
        engine.add_box((1.0, 1.0), (0.0, 1.0), bad)
    with pytest.raises(InputError, match="half extent"):
        engine.add_box((1.0, bad), (0.0, 1.0))
    box = engine.add_box((1.0, 1.0), (0.0, 1.0))
    engine.grab(box, springs((0.0, 0.0), (1.0, 1.0)))
    with pytest.raises(InputError, match="goal"):
        engine.carry((0.0, bad), 5)
    with pytest.raises(InputError, match="table_half_width"):
        Engine(table_half_width=bad)

    assert engine.keys == (box,)


@pytest.mark.parametrize("half", [0.0, -1.0, 1e-3, 101.0])
def test_boxes_have_a_reasonable_size(half: float) -> None:
    with pytest.raises(InputError, match="half extent"):
        Engine().add_box((half, 1.0), (0.0, 1.0))


def test_boxes_that_are_not_there_cannot_be_handled() -> None:
    engine = Engine()
    for use in (engine.pose, engine.remove, lambda key: engine.grab(key, springs((0, 0), (1, 1)))):
        with pytest.raises(InputError, match="box 7 does not exist"):
            use(7)


@pytest.mark.parametrize("count", [0, 4])
def test_a_box_is_held_by_one_to_three_springs(count: int) -> None:
    engine = Engine()
    box = engine.add_box((1.0, 1.0), (0.0, 1.0))

    with pytest.raises(InputError, match="1 to 3 springs"):
        engine.grab(box, [Spring((0.0, 0.0), 100.0, 2.0, 1.0)] * count)


@pytest.mark.parametrize("half", [0.01, 100.0])
def test_extreme_boxes_stay_finite(half: float) -> None:
    engine = Engine()
    engine.add_box((half, 0.01), (0.0, 101.0))
    for _ in range(4):
        engine.add_box((1.0, 100.0), (0.0, 100.0))
    engine.settle(300)

    assert np.isfinite(engine.poses()).all()


def test_other_layouts_in_memory_are_noticed() -> None:
    pair = np.array([1.5, 2.5], dtype=np.float32)
    reference = SimpleNamespace(this=pair.ctypes.data)

    assert list(shared(reference, 1.5, 2.5)) == [1.5, 2.5]
    with pytest.raises(RelforestError, match=r"install Box2D 2.3.10"):
        shared(reference, 2.5, 1.5)


def test_the_tool_is_where_a_box_is_held_or_was() -> None:
    engine = Engine()
    box = engine.add_box((2.0, 1.0), (5.0, 1.0))
    assert engine.tool is None
    engine.grab(box, springs((1.0, 0.0), (2.0, 1.0)))
    assert engine.tool == pytest.approx((6.0, 1.0))
    engine.carry((0.0, 20.0), 500)
    assert engine.tool == pytest.approx((1.0, 20.0), abs=0.1)
    engine.let_go()
    held = engine.tool
    engine.settle(500)
    assert engine.tool == held
    engine.remove(box)
    assert engine.tool == held
