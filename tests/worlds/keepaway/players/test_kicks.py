from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from relforest.worlds.keepaway.players.commands import Command
from relforest.worlds.keepaway.players.kicks import (
    KEEPER_HOLDS,
    TAKER_HOLDS,
    accelerate_to,
    freeze,
    full_power_heading,
    hold,
    kick_close,
    opponent_at_ball,
    pass_speed,
    pass_to,
    rate_of,
)
from relforest.worlds.keepaway.players.motion import Ball, Player
from relforest.worlds.keepaway.server.layout import KICK, TURN
from worlds.keepaway.staged_games import exchanged, random_stage, staged

ME: Player = (0.0, 0.0, 0.0, 0.0, 0.0)


def next_ball(me: Player, ball: Ball, command: Command) -> tuple[float, float]:
    """Where the ball is after a kick, without noise."""
    push, angle = command[1] * rate_of(me, ball), math.radians(me[4] + command[2])
    return ball[0] + ball[2] + push * math.cos(angle), ball[1] + ball[3] + push * math.sin(angle)


def test_rates_of_kicks() -> None:
    assert rate_of(ME, (0.385, 0.0, 0.0, 0.0)) == pytest.approx(0.027)
    # 0.1 m away, at a right angle: 1 - 0.125 - 0.25 / 7
    assert rate_of(ME, (0.0, 0.485, 0.0, 0.0)) == pytest.approx(0.027 * (0.875 - 0.25 / 7.0))


@pytest.mark.parametrize(
    ("distance", "speed"),
    [
        (0.0, 1.2),
        (5.0, 1.2 * 0.94**-4),  # ln(1 + 5 * 0.06383 / 1.2) / 0.061875 = 3.81
        (10.0, 1.2 * 0.94**-7),  # 6.89
        (15.0, 1.2 * 0.94**-9),  # 9.47
    ],
)
def test_speeds_of_passes(distance: float, speed: float) -> None:
    assert pass_speed(distance) == pytest.approx(speed)


def test_a_kick_gives_the_ball_a_velocity() -> None:
    # From (0.2, 0) to (0, 1): (-0.2, 1), length 1.0198, at 101.3 degrees. The rate is
    # 0.027 * (1 - 0.25 / 7) = 0.026036.
    assert accelerate_to(ME, (0.485, 0.0, 0.2, 0.0), 0.0, 1.0) == (KICK, 39, 101)


@given(st.floats(-180.0, 180.0), st.floats(-1.2, 1.2), st.floats(-1.2, 1.2))
@settings(deadline=None)
def test_at_full_power_the_ball_takes_the_direction_at_least(
    direction: float, bvx: float, bvy: float
) -> None:
    rate = 0.026
    kicked = math.radians(full_power_heading((0.0, 0.0, bvx, bvy), direction, rate))
    x, y = bvx + 100.0 * rate * math.cos(kicked), bvy + 100.0 * rate * math.sin(kicked)
    cosine, sine = math.cos(math.radians(direction)), math.sin(math.radians(direction))

    assert y * cosine - x * sine == pytest.approx(0.0, abs=1e-9)
    assert x * cosine + y * sine > 0.0


def test_a_velocity_out_of_reach_is_kicked_at_with_full_power() -> None:
    # The ball rolls to the side at 0.52; 100 * 0.026036 = 2.6036; asin(0.52 / 2.6036) = 11.5 degrees.
    assert accelerate_to(ME, (0.485, 0.0, 0.0, 0.52), 2.9, 0.0) == (KICK, 100, -11)


@given(
    st.floats(0.4, 1.0),
    st.floats(-180.0, 180.0),
    st.floats(-0.1, 0.1),
    st.floats(-0.05, 0.05),
    st.floats(-180.0, 180.0),
)
@settings(deadline=None, max_examples=50)
def test_a_ball_kept_close_goes_to_its_place(
    distance: float, bearing: float, vx: float, bvx: float, angle: float
) -> None:
    me = (0.0, 0.0, vx, 0.0, 30.0)
    ball = (distance * math.cos(math.radians(bearing)), distance * math.sin(math.radians(bearing)), bvx, 0.0)
    command = kick_close(me, ball, angle, 0.7)
    x, y = next_ball(me, ball, command)
    goal = math.radians(30.0 + angle)

    if command[1] < 100:
        # A power of 1 is 0.027 m, and a degree at most 0.04 m.
        assert math.dist((x, y), (vx + 0.875 * math.cos(goal), 0.875 * math.sin(goal))) < 0.07


def test_a_ball_too_fast_to_be_placed_is_stopped() -> None:
    # Rate at (0.4, 0) 0.02686, speed 1 -> power 37.2, straight back.
    assert freeze(ME, (0.4, 0.0, 0.0, 1.0)) == (KICK, 37, -90)
    assert kick_close(ME, (0.4, 0.0, 0.0, 2.0), -90.0, 0.7) == (KICK, 74, -90)


def test_a_ball_that_would_be_lost_when_stopped_is_brought_nearer() -> None:
    # At (1, 0), which is not within 0.868 m: to (0.7 * 1.085, 0) = (0.7595, 0).
    me, ball = ME, (1.0, 0.0, 0.0, 0.2)
    x, y = next_ball(me, ball, freeze(me, ball))

    assert (x, y) == pytest.approx((0.7595, 0.0), abs=0.03)


def test_stopping_a_ball_at_rest_needs_no_power() -> None:
    assert freeze(ME, (0.5, 0.0, -0.0, -0.0)) == (KICK, 0, 180)


def test_a_pass_to_a_mate_ahead() -> None:
    stage = staged([[0.0, 0.0], [10.485, 0.0]], [[0.0, 9.0]], [0.485, 0.0])

    # 10 m: speed 1.2 * 0.94**-7 = 1.8505; / 0.026036 = 71.07
    assert pass_to(stage.work, 0, stage.setup, 10.485, 0.0) == (KICK, 71, 0)


def test_a_pass_does_not_end_in_the_passer() -> None:
    # The ball would go from (-1, 0) to (0.358, 0), into the body; so it goes 1 + 0.385 m, beyond it. The rate
    # behind the body, 0.615 m away, is 0.027 * (1 - 0.25 - 0.21964) = 0.01432; 1.385 / 0.01432 = 96.7.
    stage = staged([[0.0, 0.0], [1.0, 0.0]], [[0.0, 9.0]], [-1.0, 0.0])

    assert pass_to(stage.work, 0, stage.setup, 1.0, 0.0) == (KICK, 96, 0)


@pytest.mark.parametrize(
    ("taker", "power"),
    [
        ([-1.5, 1.0], 100),
        ([-4.0, 1.0], 91),  # to 0.497 m in front: 1.397 / 0.01528 = 91.4
    ],
)
def test_a_ball_that_lies_badly_is_prepared_unless_pressed(taker: list[float], power: int) -> None:
    # Behind the body the rate is 0.027 * (0.75 - 0.25 * 0.515 / 0.7) = 0.01528. 10.9 m need a speed of
    # 1.2 * 0.94**-7 = 1.8505; 1.8505 / 0.01528 = 121, which is too much unless a taker is within 2 m.
    stage = staged([[0.0, 0.0], [10.0, 0.0]], [taker], [-0.9, 0.0])

    assert pass_to(stage.work, 0, stage.setup, 10.0, 0.0) == (KICK, power, 0)


def test_a_pass_over_a_long_way_goes_with_full_power() -> None:
    stage = staged([[0.0, 0.0], [60.0, 0.0]], [[0.0, 9.0]], [0.485, 0.0], size=200.0)

    assert pass_to(stage.work, 0, stage.setup, 60.0, 0.0) == (KICK, 100, 0)
    # From the side the ball would get 0.02241 * 100 = 2.24 < 0.85 * 2.7: first it is brought in front.
    aside = staged([[0.0, 0.0], [60.0, 0.0]], [[0.0, 9.0]], [0.0, 0.535], size=200.0)
    assert pass_to(aside.work, 0, aside.setup, 60.0, 0.0) == (KICK, 32, -47)
    # If it rolls as well but could be kicked well, it is stopped.
    rolling = staged([[0.0, 0.0], [60.0, 0.0]], [[0.0, 9.0]], [0.4, 0.0, -0.5, 0.0], size=200.0)
    assert pass_to(rolling.work, 0, rolling.setup, 60.0, 0.0) == (KICK, 18, 0)


def test_a_ball_is_held_away_from_the_opponent() -> None:
    # The opponent 3 m ahead looks at the player: the ball goes to 180 + 45 = -135 degrees, 0.875 m away.
    # From (0.6, 0) that is (-1.2187, -0.6187), 1.3667 m at -153.1 degrees. The rate is
    # 0.027 * (1 - 0.25 * 0.215 / 0.7) = 0.02493; 1.3667 / 0.02493 = 54.8.
    stage = staged([[0.0, 0.0], [15.0, 15.0]], [[3.0, 0.0, 0.0, 0.0, 180.0]], [0.6, 0.0])
    assert hold(stage.work, 0, stage.setup, KEEPER_HOLDS) == (KICK, 54, -153)
    # It looks to the side of growing angles from there: still -135; to the other side: 135.
    for body, direction in [(200.0, 153), (160.0, -153)]:
        stage = staged([[0.0, 0.0], [15.0, 15.0]], [[3.0, 0.0, 0.0, 0.0, body]], [0.6, 0.0])
        assert hold(stage.work, 0, stage.setup, KEEPER_HOLDS) == (KICK, 54, direction)


def test_a_ball_in_place_is_left_there() -> None:
    # Nobody within 5 m: the ball belongs 0.7 m ahead, and lies 0.1 m from there. The far end of the x axis is
    # at atan2(-10, 52.5) = -10.8 degrees.
    stage = staged([[0.0, 10.0, 0.0, 0.0, 0.0], [15.0, 15.0]], [[-9.0, 0.0]], [0.8, 10.0])
    assert hold(stage.work, 0, stage.setup, KEEPER_HOLDS) == (TURN, -10, 0)
    # A taker wants it nearer: 0.595 m ahead.
    assert hold(stage.work, 0, stage.setup, TAKER_HOLDS)[0] == KICK


def test_the_nearest_opponent_is_that_of_the_highest_number_among_equals() -> None:
    stage = staged([[0.0, 0.0], [15.0, 15.0]], [[3.0, 0.0], [0.0, 3.0], [0.0, -4.0]], [0.0, 0.0])

    assert opponent_at_ball(stage.work, 0, stage.setup) == 3


def test_keepers_and_takers_kick_alike() -> None:
    for seed in range(8):
        stage = random_stage(seed)
        turned = exchanged(stage)
        for i in range(4):
            one = hold(stage.work, i, stage.setup, KEEPER_HOLDS)
            assert one == hold(turned.work, (i + 2) % 4, turned.setup, KEEPER_HOLDS)
