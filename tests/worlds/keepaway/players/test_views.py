from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from relforest.worlds.keepaway.players.views import in_reach, observe, opponents
from relforest.worlds.keepaway.server.layout import BODY, TIME
from worlds.keepaway.staged_games import exchanged, random_stage, staged

FAR = [[18.0, 18.0]]


@pytest.mark.parametrize(
    ("distance", "seen"),
    [
        (0.4, 0.4),  # 10 ln 0.4 = -9.16 -> -9; exp(-0.9) = 0.407
        (1.04, 1.0),  # 10 ln 1.04 = 0.39 -> 0
        (1.06, 1.1),  # 0.58 -> 1; exp(0.1) = 1.105
        (3.0, 3.0),  # 10.99 -> 11; exp(1.1) = 3.004
        (7.0, 6.7),  # 19.46 -> 19; exp(1.9) = 6.686
        (10.0, 10.0),  # 23.03 -> 23; exp(2.3) = 9.974
        (14.0, 13.5),  # 26.39 -> 26; exp(2.6) = 13.464
    ],
)
def test_distances_are_seen_in_steps(distance: float, seen: float) -> None:
    stage = staged([[0.0, 0.0], [distance, 0.0]], FAR, [0.0, -distance], perception="quantised")

    assert stage.work.views[0, 1, :2] == pytest.approx([seen, 0.0], abs=1e-12)
    assert stage.work.balls[0, :2] == pytest.approx([0.0, -seen], abs=1e-12)


def test_directions_are_seen_in_whole_degrees_from_the_body() -> None:
    # atan2(1, 10) = 5.71 degrees, 3.21 from the body -> 3; the other's body is 40.0 off -> 40.
    stage = staged(
        [[0.0, 0.0, 0.0, 0.0, 2.5], [10.0, 1.0, 0.0, 0.0, 42.5]], FAR, [5.0, 0.0], perception="quantised"
    )
    seen = stage.work.views[0, 1]

    assert math.degrees(math.atan2(seen[1], seen[0])) == pytest.approx(5.5)
    assert seen[BODY] == pytest.approx(42.5)
    assert stage.work.facing[0, 1] == pytest.approx(
        [math.cos(math.radians(42.5)), math.sin(math.radians(42.5))]
    )


def test_velocities_are_seen_in_steps_of_the_distance() -> None:
    # Radial 1 / 10 = 0.1 = 5 steps -> 10 * 0.1; tangential 0.5 / 10 = 2.865 degrees -> 2.9 -> 0.50615.
    stage = staged([[0.0, 0.0], [0.0, 15.0]], FAR, [10.0, 0.0, 1.0, 0.5], perception="quantised")

    assert stage.work.balls[0, 2:] == pytest.approx([1.0, 10.0 * math.radians(2.9)])


def test_a_velocity_is_seen_relative_to_the_own_one() -> None:
    # Relative (0.8, 0) at 10 m: 0.08 = 4 steps of 0.02.
    stage = staged([[0.0, 0.0, 0.2, 0.1], [0.0, 15.0]], FAR, [10.0, 0.0, 1.0, 0.1], perception="quantised")

    assert stage.work.balls[0, 2:] == pytest.approx([1.0, 0.1])


@given(st.integers(0, 10_000))
@settings(deadline=None, max_examples=20)
def test_what_is_seen_is_near_the_truth(seed: int) -> None:
    rough = random_stage(seed, keepers=3, perception="quantised").work.views
    exact = random_stage(seed, keepers=3).work.views
    for i in range(5):
        own = exact[i, i]
        assert rough[i, i] == pytest.approx(own)
        for j in set(range(5)) - {i}:
            offset, seen = exact[i, j, :2] - own[:2], rough[i, j, :2] - own[:2]
            distance = math.hypot(*offset)
            # Half a step of the logarithm, and half of a tenth.
            assert abs(math.hypot(*seen) - distance) <= (math.exp(0.05) - 1.0) * distance + 0.05 + 1e-9
            turned = math.degrees(math.atan2(seen[1], seen[0]) - math.atan2(offset[1], offset[0]))
            assert abs((turned + 180.0) % 360.0 - 180.0) <= 0.5 + 1e-9
            assert abs((rough[i, j, BODY] - exact[i, j, BODY] + 180.0) % 360.0 - 180.0) <= 0.5 + 1e-9


def test_takers_see_the_field_turned_round() -> None:
    stage = staged(
        [[1.0, 2.0, 0.1, 0.2, 30.0], [9.0, 9.0]], [[-3.0, 4.0, 0.0, 0.1, -90.0]], [5.0, 6.0, 0.5, 0.0]
    )

    assert stage.work.views[2, 2] == pytest.approx([3.0, -4.0, 0.0, -0.1, 90.0])
    assert stage.work.views[2, 0] == pytest.approx([-1.0, -2.0, -0.1, -0.2, -150.0])
    assert stage.work.balls[2] == pytest.approx([-5.0, -6.0, -0.5, 0.0])
    assert stage.work.views[1, 0] == pytest.approx([1.0, 2.0, 0.1, 0.2, 30.0])


@pytest.mark.parametrize("perception", ["exact", "quantised"])
def test_turning_the_scene_exchanges_the_frames_of_the_teams(perception: str) -> None:
    for seed in range(5):
        stage = random_stage(seed, perception=perception)
        turned = exchanged(stage, perception=perception)
        order = [2, 3, 0, 1]
        difference = turned.work.views[np.ix_(order, order)] - stage.work.views

        assert np.allclose(difference[..., :BODY], 0.0, atol=1e-9)
        assert np.allclose((difference[..., BODY] + 180.0) % 360.0 - 180.0, 0.0, atol=1e-9)
        assert np.allclose(turned.work.balls[order], stage.work.balls, atol=1e-9)


def test_a_ball_that_an_opponent_has_is_taken_to_be_at_rest() -> None:
    near_ball, at_ball, other = [1.0, 0.0], [-0.9, 0.0], [10.0, 0.0]
    ball = [0.0, 0.0, 1.0, 0.5]
    exact = staged([near_ball, other], [at_ball, [0.0, 9.0]], ball).work.balls

    assert exact[0, 2:].tolist() == [1.0, 0.5]  # it has the ball itself
    assert exact[1, 2:].tolist() == [0.0, 0.0]
    assert exact[2, 2:].tolist() == [-1.0, -0.5]
    assert exact[3, 2:].tolist() == [0.0, 0.0]  # a keeper has it, too
    fullstate = staged([near_ball, other], [at_ball, [0.0, 9.0]], ball, perception="fullstate").work.balls
    assert fullstate[1, 2:].tolist() == [1.0, 0.5]


def test_the_ball_is_as_fast_as_expected_if_that_is_about_what_is_seen() -> None:
    stage = staged([[0.0, 0.0], [0.0, 15.0]], FAR, [10.0, 0.0, 1.0, 0.0], perception="quantised")
    games, setup, work = stage
    games.counters[0, TIME] = 1
    observe(games, 0, setup, work)

    # Seen again as 1.0, expected 0.94, which differs by less than a tenth of 0.94.
    assert work.balls[0, 2] == pytest.approx(0.97)

    games.counters[0, TIME], games.ball[0, 2] = 2, 0.8
    observe(games, 0, setup, work)

    # Expected 0.94 * 0.97 = 0.9118: seen 0.8 differs by more than a tenth.
    assert work.balls[0, 2] == pytest.approx(0.8)


def test_looking_again_in_the_same_cycle_changes_nothing() -> None:
    stage = random_stage(1, perception="quantised")
    games, setup, work = stage
    for time in range(1, 4):
        games.counters[0, TIME] = time
        games.ball[0, :2] += games.ball[0, 2:]
        games.ball[0, 2:] *= 0.94
        observe(games, 0, setup, work)
        before = [array.copy() for array in (games.memory, work.views, work.balls, work.gaps)]
        observe(games, 0, setup, work)
        for array, old in zip((games.memory, work.views, work.balls, work.gaps), before, strict=True):
            np.testing.assert_array_equal(array, old)


def test_teams_and_reach() -> None:
    stage = staged([[0.0, 0.0], [5.0, 0.0], [0.0, 5.0]], [[1.2, 0.0]], [1.08, 0.0])

    assert [in_reach(stage.work, i) for i in range(4)] == [True, False, False, True]
    assert opponents(stage.setup, 1) == (3, 4)
    assert opponents(stage.setup, 3) == (0, 3)
