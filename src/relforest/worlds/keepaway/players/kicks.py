"""What a player does with a ball within its reach: pass it, hold it away from opponents, stop it.

Everything is in the player's own frame; directions of kicks are relative to its body, in degrees.
"""

from __future__ import annotations

import math
from typing import Final

from relforest.support.jit import kernel
from relforest.worlds.keepaway.players.commands import Command, face, kick
from relforest.worlds.keepaway.players.motion import Ball, Player, rolled
from relforest.worlds.keepaway.players.views import Work, ball_seen, opponents, player_seen
from relforest.worlds.keepaway.server.layout import BODY, Setup, X, Y
from relforest.worlds.keepaway.server.physics import (
    BALL_ACCELERATION_MAX,
    BALL_DECAY,
    BALL_SPEED_MAX,
    KICK_RATE,
    KICKABLE_MARGIN,
    POWER_MAX,
    TOUCH_BALL,
    kick_rate,
)
from relforest.worlds.keepaway.server.referee import REACH
from relforest.worlds.keepaway.server.rounding import TIE, heading, wrapped

KEEPER_HOLDS: Final = 0.7
"""Where a keeper holds the ball: a share of the margin between touching it and losing it."""

TAKER_HOLDS: Final = 0.3
"""The same for a taker."""

END_SPEED: Final = 1.2
"""Speed with which a pass should arrive, in metres per cycle."""

_ASIDE: Final = 45.0
_NEAR: Final = 5.0
_VERY_NEAR: Final = 2.0
_IN_PLACE: Final = 0.3
_GOAL_LINE: Final = 52.5
_READY: Final = 0.85
_PASS_READY: Final = 0.16


@kernel
def rate_of(me: Player, ball: Ball) -> float:
    """Return the speed that a kick gives to the ball per unit of power, as it lies now."""
    x, y = ball[0] - me[0], ball[1] - me[1]
    return kick_rate(math.sqrt(x * x + y * y), abs(wrapped(heading(x, y) - me[4])))


@kernel
def accelerate_to(me: Player, ball: Ball, vx: float, vy: float) -> Command:
    """Kick so that the ball gets a velocity, or at least its direction with full power."""
    rate = rate_of(me, ball)
    ax, ay = vx - ball[2], vy - ball[3]
    size = math.sqrt(ax * ax + ay * ay)
    if size < BALL_ACCELERATION_MAX and size <= POWER_MAX * rate:
        return kick(size / rate, heading(ax, ay) - me[4])
    return kick(POWER_MAX, full_power_heading(ball, heading(vx, vy), rate) - me[4])


@kernel
def full_power_heading(ball: Ball, direction: float, rate: float) -> float:
    """Return where to kick with full power so that the ball then moves in a direction, if it can be done."""
    radians = math.radians(direction)
    across = ball[3] * math.cos(radians) - ball[2] * math.sin(radians)
    return direction - math.degrees(math.asin(min(max(across / (POWER_MAX * rate), -1.0), 1.0)))


@kernel
def kick_close(me: Player, ball: Ball, angle: float, ratio: float) -> Command:
    """Kick the ball to a place near the body, at an angle to the body direction.

    ``ratio`` is a share of the margin between touching the ball and losing it.
    """
    rate = rate_of(me, ball)
    next_x, next_y = rolled(me, 1)
    radians = math.radians(me[4] + angle)
    distance = TOUCH_BALL + KICKABLE_MARGIN * ratio
    ax = next_x + distance * math.cos(radians) - ball[0] - ball[2]
    ay = next_y + distance * math.sin(radians) - ball[1] - ball[3]
    power = math.sqrt(ax * ax + ay * ay) / rate
    moving = ball[2] * ball[2] + ball[3] * ball[3] > (0.1 + TIE) * (0.1 + TIE)
    if power > POWER_MAX and moving:
        return freeze(me, ball)
    return kick(power, heading(ax, ay) - me[4])


@kernel
def freeze(me: Player, ball: Ball) -> Command:
    """Stop the ball or, if it would then be lost, kick it in front of where the player will be."""
    rate = rate_of(me, ball)
    speed = math.sqrt(ball[2] * ball[2] + ball[3] * ball[3])
    power = min(speed / rate, POWER_MAX)
    share = 1.0 - power * rate / speed if speed > 0.0 else 0.0
    next_x, next_y = rolled(me, 1)
    x, y = ball[0] + share * ball[2] - next_x, ball[1] + share * ball[3] - next_y
    if x * x + y * y < 0.64 * REACH * REACH:
        return kick(power, heading(ball[2], ball[3]) + 180.0 - me[4])
    x, y = ball[0] - next_x, ball[1] - next_y
    apart = math.sqrt(x * x + y * y)
    direction = math.radians(heading(x, y))
    distance = min(0.7 * REACH, apart - 0.1)
    vx = next_x + distance * math.cos(direction) - ball[0]
    vy = next_y + distance * math.sin(direction) - ball[1]
    return accelerate_to(me, ball, vx, vy)


@kernel
def pass_speed(distance: float) -> float:
    """Return the first speed of a ball that arrives over a distance with `END_SPEED`, in whole cycles."""
    cycles = math.log(1.0 + distance * (1.0 / BALL_DECAY - 1.0) / END_SPEED) / -math.log(BALL_DECAY)
    return END_SPEED * math.pow(BALL_DECAY, -round(cycles))


@kernel
def pass_to(work: Work, i: int, setup: Setup, x: float, y: float) -> Command:
    """Pass to a point, first bringing the ball in front of the body if it is badly placed."""
    me, ball = player_seen(work, i, i), ball_seen(work, i)
    dx, dy = x - ball[0], y - ball[1]
    distance = math.sqrt(dx * dx + dy * dy)
    speed = pass_speed(distance)
    direction = heading(dx, dy)
    rate = rate_of(me, ball)
    cosine, sine = math.cos(math.radians(direction)), math.sin(math.radians(direction))
    if speed > BALL_SPEED_MAX:
        radians = math.radians(full_power_heading(ball, direction, rate))
        vx = ball[2] + POWER_MAX * rate * math.cos(radians)
        vy = ball[3] + POWER_MAX * rate * math.sin(radians)
        if math.sqrt(vx * vx + vy * vy) > _READY * BALL_ACCELERATION_MAX:
            return kick(POWER_MAX, math.degrees(radians) - me[4])
        if rate > _READY * KICK_RATE:
            return freeze(me, ball)
        return kick_close(me, ball, 0.0, _PASS_READY)
    speed = _past_body(me, ball, speed, cosine, sine)
    ax, ay = speed * cosine - ball[2], speed * sine - ball[3]
    power = math.sqrt(ax * ax + ay * ay) / rate
    opponent = opponent_at_ball(work, i, setup)
    pressed = work.gaps[i, opponent] < (_VERY_NEAR - TIE) * (_VERY_NEAR - TIE)
    if power <= 105.0 or (pressed and power <= 130.0):
        return accelerate_to(me, ball, speed * cosine, speed * sine)
    return kick_close(me, ball, 0.0, _PASS_READY)


@kernel
def _past_body(me: Player, ball: Ball, speed: float, cosine: float, sine: float) -> float:
    """Return the speed of a kick that leaves the ball before or behind the player's body, not in it."""
    x, y = rolled(me, 1)
    x, y = x - ball[0], y - ball[1]
    off_x, off_y = x - speed * cosine, y - speed * sine
    if off_x * off_x + off_y * off_y < TOUCH_BALL * TOUCH_BALL:
        foot = abs(x * cosine + y * sine)
        return foot - TOUCH_BALL if speed < foot else foot + TOUCH_BALL
    return speed


@kernel
def hold(work: Work, i: int, setup: Setup, ratio: float) -> Command:
    """Keep the ball away from the opponent nearest to it.

    If that one is within 5 m of the ball, the ball goes behind the player as seen from there, at 45 degrees
    to the side to which the opponent does not face; else in front. If it lies there already and stays in
    reach, the player turns to the far end of its own x axis instead.

    Notes
    -----
    As in the benchmark's players, whether the ball lies there already is tested with the angle to the body
    taken as one to the x axis, and with the ratio taken as a distance. Players face along the x axis most of
    the time, so this matters little.
    """
    me, ball = player_seen(work, i, i), ball_seen(work, i)
    j = opponent_at_ball(work, i, setup)
    angle = 0.0
    if work.gaps[i, j] < (_NEAR - TIE) * (_NEAR - TIE):
        x, y = me[0] - work.views[i, j, X], me[1] - work.views[i, j, Y]
        behind = heading(x, y)
        turned = wrapped(work.views[i, j, BODY] - behind)
        side = -_ASIDE if TIE < turned < 180.0 - TIE else _ASIDE
        angle = wrapped(behind + side - me[4])
    radians = math.radians(angle)
    x = ball[0] - me[0] - ratio * math.cos(radians)
    y = ball[1] - me[1] - ratio * math.sin(radians)
    if x * x + y * y < (_IN_PLACE - TIE) * (_IN_PLACE - TIE):
        next_x, next_y = rolled(me, 1)
        x, y = ball[0] + ball[2] - next_x, ball[1] + ball[3] - next_y
        if x * x + y * y < (_READY * REACH) * (_READY * REACH):
            return face(me, _GOAL_LINE, 0.0, 1)
    return kick_close(me, ball, angle, ratio)


@kernel
def opponent_at_ball(work: Work, i: int, setup: Setup) -> int:
    """Find the opponent nearest to the ball, as player ``i`` sees it."""
    first, last = opponents(setup, i)
    best = last - 1
    for j in range(last - 2, first - 1, -1):
        if work.gaps[i, j] < work.gaps[i, best] - TIE:
            best = j
    return best
