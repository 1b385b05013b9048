from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from relforest.worlds.keepaway.players.close_interception import close_interception
from relforest.worlds.keepaway.players.interception import (
    command_towards,
    intercept,
    meeting_cycle,
    miss_after,
)
from relforest.worlds.keepaway.players.memory import meeting_point, remember_meeting_point
from relforest.worlds.keepaway.players.motion import (
    BACK,
    BALL_PATH,
    HORIZON,
    Pursuit,
    after_dash,
    after_turn,
    dash_power,
    steer,
)
from relforest.worlds.keepaway.server.layout import DASH, TURN
from worlds.keepaway.staged_games import exchanged, random_stage, staged

NAN = math.nan
FAR_AWAY = 400.0


def stepwise_miss(pursuit: Pursuit, cycles: int) -> float:
    """Go through all commands one by one."""
    for left in range(cycles, 0, -1):
        turning, x, y = steer(pursuit, left, BACK)
        if turning:
            pursuit, _, _ = after_turn(pursuit, x, y)
        else:
            pursuit = after_dash(pursuit, dash_power(pursuit[0], pursuit[2], left))
    return math.hypot(pursuit[0], pursuit[1])


@given(
    st.floats(-12.0, 12.0),
    st.floats(-12.0, 12.0),
    st.floats(-0.4, 0.4),
    st.floats(-0.4, 0.4),
    st.integers(0, 20),
)
@settings(deadline=None)
def test_shortcuts_do_not_change_how_far_a_player_misses(
    tx: float, ty: float, vx: float, vy: float, cycles: int
) -> None:
    exact = stepwise_miss((tx, ty, vx, vy), cycles)
    quick = miss_after((tx, ty, vx, vy), cycles)

    assert quick == pytest.approx(exact, abs=1e-9) if exact < 1.085 else quick >= 1.085


def test_a_resting_ball_is_met_as_soon_as_possible() -> None:
    # 5 m ahead: five full dashes from rest cover 4.34 m, four only 3.35 m.
    assert meeting_cycle((5.0, 0.0, 0.0, 0.0, 0.0, 0.0), NAN, NAN) == 5
    assert meeting_cycle((1.0, 0.0, 0.0, 0.0, 0.0, 0.0), NAN, NAN) == 0
    assert meeting_cycle((50.0, 0.0, 0.0, 0.0, 0.0, 0.0), NAN, NAN) == HORIZON


@given(st.floats(-12.0, 12.0), st.floats(-12.0, 12.0))
@settings(deadline=None, max_examples=30)
def test_no_plan_is_earlier_than_the_player_can_be_there(x: float, y: float) -> None:
    cycle = meeting_cycle((x, y, 0.0, 0.0, 0.0, 0.0), NAN, NAN)

    # From rest nobody covers a metre per cycle.
    assert math.hypot(x, y) - 1.085 <= cycle <= math.hypot(x, y) + 3.0


def test_an_old_plan_is_kept_while_it_is_good() -> None:
    # The ball comes straight at the player; it can be met from cycle 4 on.
    approach = (14.0, 0.0, -2.0, 0.0, 0.0, 0.0)
    first = meeting_cycle(approach, NAN, NAN)

    for later in range(first, first + 4):
        assert meeting_cycle(approach, 14.0 - 2.0 * BALL_PATH[later], 0.0) == later
    # A plan far from the way of the ball is given up.
    assert meeting_cycle(approach, 5.0, 5.0) == first


def test_a_plan_that_barely_works_is_put_off_by_a_cycle() -> None:
    # Five full dashes cover 4.34 m, 0.65 m short of the ball: more than half of the reach. In six it can be
    # met exactly.
    x = 0.65 + 4.34016 + 2.0 * BALL_PATH[5]

    assert meeting_cycle((x, 0.0, -2.0, 0.0, 0.0, 0.0), x - 2.0 * BALL_PATH[5], 0.0) == 6


def test_a_plan_for_a_slow_ball_is_not_kept() -> None:
    approach = (6.0, 0.0, -0.5, 0.0, 0.0, 0.0)

    assert meeting_cycle(approach, 6.0 - 0.5 * BALL_PATH[9], 0.0) == meeting_cycle(approach, NAN, NAN)


def test_without_pressure_a_player_lets_the_ball_come_and_faces_along_its_x_axis() -> None:
    # The ball will be at (0.5, 0.2), in reach. The body is 60 degrees off the x axis, one turn is enough.
    c, s = 0.5, math.sqrt(0.75)
    approach = (1.5 * c + 0.2 * s, 0.2 * c - 1.5 * s, -c, s, 0.0, 0.0)

    assert close_interception(approach, 60.0, c, FAR_AWAY) == (True, (TURN, -60, 0))


def test_under_pressure_a_player_dashes_at_the_ball() -> None:
    # The ball will be at (0.5, 0.2). The far point where it touches is sqrt(0.5017^2 - 0.2^2) = 0.46 m on,
    # farther than a full dash. From (0.6, 0) the ball is 0.22 m away.
    approach = (1.5, 0.2, -1.0, 0.0, 0.0, 0.0)

    assert close_interception(approach, 0.0, 1.0, 2.9 * 2.9) == (True, (DASH, 100, 0))
    assert close_interception(approach, 0.0, 1.0, 3.0 * 3.0) == (True, (TURN, 0, 0))
    # With the body against the x axis the near point comes first: at -0.5 + 0.46, a dash of 0.04 m.
    approach = (-1.5, -0.2, 1.0, 0.0, 0.0, 0.0)
    assert close_interception(approach, 180.0, -1.0, 2.9 * 2.9) == (True, (DASH, -100, 0))


def test_a_player_that_looks_elsewhere_lets_the_ball_hit_it() -> None:
    # The ball hits the player in one cycle, and is out of reach in two.
    approach = (3.0, 0.0, -2.9, 0.0, 0.42 * 0.25, 0.0)
    found, command = close_interception(approach, 180.0, -1.0, FAR_AWAY)

    assert found
    assert command == (TURN, 180, 0)


def test_a_fast_player_that_looks_back_dashes_into_the_ball() -> None:
    # At speed 0.45 two turns are 55 + 95 degrees, so it cannot face the x axis. The ball will be at (1, 0.2):
    # 0.59 m from where the player rolls, but 0.2 m from where a dash of 1 m ends; (1 - 0.45) / 0.006 = 91.7.
    assert close_interception((2.0, 0.2, -1.0, 0.0, 0.45, 0.0), 180.0, -1.0, FAR_AWAY) == (
        True,
        (DASH, 91, 0),
    )


def test_a_fast_player_that_looks_back_turns_while_the_ball_passes_in_reach() -> None:
    # The ball will be at (0.45, 0.6), 0.6 m beside the player: too far for the body to stop it.
    approach = (0.45, -1.4, 0.0, 2.0, 0.45, 0.0)

    assert close_interception(approach, 180.0, -1.0, FAR_AWAY) == (True, (TURN, 180, 0))


def test_a_ball_far_away_is_no_matter_of_two_cycles() -> None:
    assert close_interception((10.1, 0.0, -3.0, 0.0, 0.0, 0.0), 0.0, 1.0, 1.0)[0] is False
    assert close_interception((6.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.0, 1.0, 1.0)[0] is False


def test_commands_towards_a_point() -> None:
    assert command_towards((0.0, 5.0, 0.0, 0.0), 5) == (TURN, 90, 0)
    # 4.2 m in two cycles needs 3 m in the first.
    assert command_towards((4.2, 0.0, 0.0, 0.0), 2) == (DASH, 100, 0)
    # 0.42 / 1.4 = 0.3 = 50 * 0.006
    assert command_towards((0.42, 0.0, 0.0, 0.0), 2) == (DASH, 50, 0)


def test_a_player_where_the_ball_will_come_waits_and_faces_along_its_x_axis() -> None:
    stage = staged([[0.0, 0.0, 0.0, 0.0, 90.0], [15.0, 15.0]], [[-15.0, 0.0]], [8.0, 0.0, -1.2, 0.0])
    place = 8.0 - 1.2 * BALL_PATH[8]  # 0.19
    remember_meeting_point(stage.games, 0, 0, place, 0.0)

    assert intercept(stage.games, 0, 0, stage.setup, stage.work) == (TURN, -90, 0)
    assert meeting_point(stage.games, 0, 0) == pytest.approx((place, 0.0))


def test_a_plan_is_forgotten_after_two_cycles() -> None:
    stage = staged([[0.0, 0.0], [15.0, 15.0]], [[-15.0, 0.0]], [8.0, 0.0])
    assert math.isnan(meeting_point(stage.games, 0, 0)[0])
    remember_meeting_point(stage.games, 0, 0, 3.0, 4.0)
    for time, known in [(0, True), (2, True), (3, False)]:
        stage.games.counters[0, 0] = time
        assert (meeting_point(stage.games, 0, 0) == (3.0, 4.0)) == known


def test_keepers_and_takers_go_for_the_ball_alike() -> None:
    for seed in range(8):
        stage = random_stage(seed)
        turned = exchanged(stage)
        for i in range(4):
            one = intercept(stage.games, 0, i, stage.setup, stage.work)
            other = intercept(turned.games, 0, (i + 2) % 4, turned.setup, turned.work)
            assert one == other
