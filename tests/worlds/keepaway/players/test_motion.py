from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from relforest.worlds.keepaway.players.commands import dash, face, kick, turn
from relforest.worlds.keepaway.players.motion import (
    BACK,
    BALL_PATH,
    BALL_SLOWING,
    LAUNCH,
    ROLL,
    after_dash,
    after_turn,
    dash_power,
    moment,
    roll_factor,
    rolled,
    steer,
    turn_limit,
    turn_towards,
)
from relforest.worlds.keepaway.server.layout import DASH, KICK, TURN


def test_tables_of_what_rolls() -> None:
    assert BALL_PATH[:4] == pytest.approx([0.0, 1.0, 1.94, 2.8236])  # 1 + 0.94 + 0.8836
    assert BALL_SLOWING[2] == pytest.approx(0.8836)
    assert ROLL[:4] == pytest.approx([0.0, 1.0, 1.4, 1.56])
    assert LAUNCH[:3] == pytest.approx([1.0, 1.0, 1.0 / 1.4])


def test_players_roll_no_faster_than_they_can_run() -> None:
    assert rolled((1.0, 2.0, 0.4, -0.2, 77.0), 2) == pytest.approx((1.56, 1.72))
    assert roll_factor(0.4, 0.0, 3) == pytest.approx(1.56)
    assert roll_factor(0.0, 2.1, 3) == pytest.approx(0.78)


@pytest.mark.parametrize(
    ("forward", "velocity", "cycles", "power"),
    [
        (0.3, 0.0, 1, 50.0),  # 0.3 / 0.006
        (0.3, 0.1, 1, 200.0 / 6.0),
        (0.42, 0.0, 2, 50.0),  # 0.42 / 1.4 = 0.3
        (5.0, 0.0, 1, 100.0),
        (5.0, 0.9, 1, 25.0),  # no faster than 1.05
        (-0.3, 0.0, 1, -50.0),
        (-5.0, 0.4, 3, -100.0),
        (0.3, 0.0, 0, 50.0),  # no time counts as one cycle
    ],
)
def test_powers_of_dashes(forward: float, velocity: float, cycles: int, power: float) -> None:
    assert dash_power(forward, velocity, cycles) == pytest.approx(power)


def test_a_fast_player_turns_less() -> None:
    assert turn_limit(0.0) == 180.0
    assert turn_limit(0.4) == pytest.approx(60.0)  # 180 / (1 + 5 * 0.4)
    assert moment(30.0, 0.4) == pytest.approx(90.0)
    assert moment(-100.0, 0.4) == -180.0
    assert turn_towards(0.0, 2.0, 0.0) == (0.0, 1.0, True)
    assert turn_towards(-3.0, 4.0, 0.0) == pytest.approx((-0.6, 0.8, True))
    assert turn_towards(0.0, -2.0, 0.4) == pytest.approx((0.5, -math.sqrt(0.75), False))
    assert turn_towards(0.0, 0.0, 0.4) == (1.0, 0.0, True)
    # Exactly behind is 180 degrees, not -180.
    assert turn_towards(-2.0, -1e-15, 0.4) == pytest.approx((0.5, math.sqrt(0.75), False))


def test_full_dashes_from_rest() -> None:
    pursuit = (5.0, 0.0, 0.0, 0.0)
    steps = []
    for _ in range(4):
        before = pursuit[0]
        pursuit = after_dash(pursuit, 100.0)
        steps.append(before - pursuit[0])

    assert steps == pytest.approx([0.6, 0.84, 0.936, 0.9744])


def test_a_dash_cannot_exceed_the_largest_speed() -> None:
    tx, ty, vx, vy = after_dash((3.0, 0.0, 0.8, 0.3), 100.0)

    assert math.hypot(3.0 - tx, -ty) == pytest.approx(1.05)
    assert (vx, vy) == pytest.approx((0.4 * (3.0 - tx), -0.4 * ty))


@pytest.mark.parametrize(
    ("x", "y"),
    [
        (5.0, 0.98),  # 0.9 * 1.085 = 0.9765
        (11.0, -2.2),  # twice 1.085 beyond 10 m
        (21.0, 3.3),  # three times beyond 20 m
        (math.sqrt(97.75) + 1e-12, 1.5),  # 10 m but for rounding
        (-2.6, 0.0),  # backwards up to 2.5 m
    ],
)
def test_a_player_turns_if_the_target_lies_too_far_aside_or_behind(x: float, y: float) -> None:
    assert steer((x, y, 0.0, 0.0), 1, BACK) == (True, x, y)


@pytest.mark.parametrize(
    ("x", "y"),
    [(5.0, 0.97), (11.0, 2.1), (21.0, -3.2), (-2.4, 0.0), (-2.5 - 1e-12, 0.0)],
)
def test_a_player_dashes_if_that_brings_the_target_in_reach(x: float, y: float) -> None:
    assert steer((x, y, 0.0, 0.0), 1, BACK) == (False, 0.0, 0.0)


def test_a_player_turns_its_back_if_facing_the_target_takes_too_long() -> None:
    # At speed 0.4 one turn is at most 60 degrees. The target is 1.5 m away at 120 degrees from where the
    # player rolls in one cycle: after the turn it lies 1.5 sin 60 = 1.3 m aside, but its back can face it.
    x, y = 1.5 * math.cos(math.radians(120.0)), 1.5 * math.sin(math.radians(120.0))
    assert steer((x + 0.4, y, 0.4, 0.0), 1, BACK) == pytest.approx((True, -x, -y))
    # With four cycles there is time. It will have rolled 0.4 * 1.624 by then.
    roll = 0.4 * ROLL[4]
    assert steer((x + roll, y, 0.4, 0.0), 4, BACK) == pytest.approx((True, x, y))
    # At rest one turn is enough.
    assert steer((x, y, 0.0, 0.0), 1, BACK) == pytest.approx((True, x, y))


def test_a_player_seen_too_fast_turns_as_slowly_as_it_seems_but_rolls_as_it_can() -> None:
    # Seen at 2.1: at most 180 / 11.5 = 15.7 degrees, and 1.05 m in the cycle.
    (tx, ty, vx, vy), cosine, sine = after_turn((3.0, 0.0, 2.1, 0.0), 0.0, 1.0)

    assert math.degrees(math.atan2(sine, cosine)) == pytest.approx(180.0 / 11.5)
    assert (tx * cosine - ty * sine, tx * sine + ty * cosine) == pytest.approx((1.95, 0.0))
    assert (vx * cosine - vy * sine, vx * sine + vy * cosine) == pytest.approx((0.42, 0.0))


coordinate = st.floats(-8.0, 8.0)
slow = st.floats(-0.3, 0.3)


@given(coordinate, coordinate, slow, slow, st.floats(-180.0, 180.0))
@settings(deadline=None)
def test_turning_moves_and_rotates(tx: float, ty: float, vx: float, vy: float, aim: float) -> None:
    (x, y, wx, wy), cosine, sine = after_turn(
        (tx, ty, vx, vy), math.cos(math.radians(aim)), math.sin(math.radians(aim))
    )
    limit = turn_limit(math.hypot(vx, vy))
    turned = math.degrees(math.atan2(sine, cosine))

    assert abs(abs(turned) - min(abs(aim), limit)) <= 1e-6
    # Back in the old frame: the player rolled for a cycle, and the target is where it was.
    old_x, old_y = x * cosine - y * sine, x * sine + y * cosine
    assert (old_x, old_y) == pytest.approx((tx - vx, ty - vy), abs=1e-9)
    assert math.hypot(wx, wy) == pytest.approx(0.4 * math.hypot(vx, vy), abs=1e-12)
    assert wx * cosine - wy * sine == pytest.approx(0.4 * vx, abs=1e-9)


def test_commands_are_whole_numbers_in_range() -> None:
    assert dash(33.9) == (DASH, 33, 0)
    assert dash(-133.9) == (DASH, -100, 0)
    assert turn(-30.5, 0.0) == (TURN, -30, 0)
    assert turn(190.0, 0.4) == (TURN, -180, 0)  # -170 degrees, at this speed cut off
    assert kick(120.0, 200.7) == (KICK, 100, -159)


def test_a_player_faces_a_point_from_where_it_will_be() -> None:
    # In one cycle at (0.3, 0), the point then at 90 degrees; 90 * (1 + 5 * 0.3) is cut off at 180.
    assert face((0.0, 0.0, 0.3, 0.0, 0.0), 0.3, 5.0, 1) == (TURN, 180, 0)
    # In two cycles at (0.042, 0): 45 degrees, less 30 of the body, times 1.15.
    assert face((0.0, 0.0, 0.03, 0.0, 30.0), 1.042, 1.0, 2) == (TURN, 17, 0)
