"""How a player takes a ball that comes within its reach in one or two cycles."""

from __future__ import annotations

import math
from typing import Final

from relforest.support.jit import kernel
from relforest.worlds.keepaway.players.commands import Command, dash, turn
from relforest.worlds.keepaway.players.motion import (
    BALL_PATH,
    Approach,
    Pursuit,
    after_dash,
    dash_power,
    pursuit_of,
    roll_factor,
    turn_limit,
)
from relforest.worlds.keepaway.server.physics import (
    BALL_SPEED_MAX,
    KICKABLE_MARGIN,
    PLAYER_DECAY,
    PLAYER_SPEED_MAX,
    TOUCH_BALL,
)
from relforest.worlds.keepaway.server.referee import REACH
from relforest.worlds.keepaway.server.rounding import TIE, wrapped

NO_COMMAND: Final = (0, 0, 0)

_CLOSE_RANGE: Final = 3.0 * PLAYER_SPEED_MAX + 1.94 * BALL_SPEED_MAX + REACH
_SAFE: Final = 0.8 * REACH
_DASH_SAFE: Final = 0.95 * REACH
_TOUCH: Final = TOUCH_BALL + KICKABLE_MARGIN / 6.0
_STRAIGHT: Final = 25.0
_PRESSURE: Final = 3.0


@kernel
def close_interception(
    approach: Approach, body: float, cosine: float, nearest_opponent: float
) -> tuple[bool, Command]:
    """Find a command that has the ball in reach in one or two cycles, if possible without running.

    Without an opponent near, the player lets the ball come and turns to the x axis of its own frame; under
    pressure it dashes to where it touches the ball. ``cosine`` is that of its body direction (degrees), and
    ``nearest_opponent`` a squared distance. Returns whether there is such a command, and the command.
    """
    if approach[0] * approach[0] + approach[1] * approach[1] > _CLOSE_RANGE * _CLOSE_RANGE:
        return False, NO_COMMAND
    dashing, one_dash = _one_dash(pursuit_of(approach, BALL_PATH[1]), cosine)
    if dashing and nearest_opponent < (_PRESSURE - TIE) * (_PRESSURE - TIE):
        return True, one_dash
    straighten = turn(-body, math.sqrt(approach[4] * approach[4] + approach[5] * approach[5]))
    in_time, straight = _let_it_come(approach, body)
    if straight:
        return True, straighten
    if abs(wrapped(body)) > _STRAIGHT:
        found, command = _take_it(approach, straighten)
        if found:
            return True, command
    if in_time:
        return True, straighten
    return dashing, one_dash


@kernel
def _let_it_come(approach: Approach, body: float) -> tuple[bool, bool]:
    """Whether the ball is in reach after one or two turns to the x axis, and the body is straight by then."""
    speed = math.sqrt(approach[4] * approach[4] + approach[5] * approach[5])
    left = max(abs(wrapped(body)) - turn_limit(speed), 0.0)
    in_time = _missed_rolling(pursuit_of(approach, BALL_PATH[1]), 1) < _SAFE
    if in_time and left <= _STRAIGHT:
        return True, True
    left = max(left - turn_limit(min(speed, PLAYER_SPEED_MAX) * PLAYER_DECAY), 0.0)
    if _missed_rolling(pursuit_of(approach, BALL_PATH[2]), 2) < _SAFE:
        return True, left <= _STRAIGHT
    return in_time, False


@kernel
def _take_it(approach: Approach, straighten: Command) -> tuple[bool, Command]:
    """Let the ball run into the body if it is as near as that, or else brake if it stays in reach then."""
    x, y, bvx, bvy, vx, _ = approach
    first = pursuit_of(approach, BALL_PATH[1])
    if math.sqrt(x * x + y * y) <= math.sqrt(bvx * bvx + bvy * bvy) + PLAYER_SPEED_MAX:
        if _missed_rolling(first, 1) < TOUCH_BALL:
            return True, straighten
        power = dash_power(first[0], vx, 1)
        if _missed_dashing(first, power) < TOUCH_BALL:
            return True, dash(power)
    power = dash_power(0.0, vx, 1)
    return _missed_dashing(pursuit_of(approach, BALL_PATH[2]), power) < _SAFE, dash(power)


@kernel
def _one_dash(pursuit: Pursuit, cosine: float) -> tuple[bool, Command]:
    """Find the dash after which the ball is in reach in front or behind; ``cosine`` is that of the body."""
    tx, ty, vx, vy = pursuit
    side = ty - vy * roll_factor(vx, vy, 1)
    if abs(side) <= _TOUCH:
        half = math.copysign(math.sqrt(_TOUCH * _TOUCH - side * side), cosine)
        for forward in (tx + half, tx - half):
            command = dash(dash_power(forward, vx, 1))
            if _missed_dashing(pursuit, float(command[1])) < _DASH_SAFE:
                return True, command
    power = dash_power(tx, vx, 1)
    return _missed_dashing(pursuit, power) < _DASH_SAFE, dash(power)


@kernel
def _missed_rolling(pursuit: Pursuit, cycles: int) -> float:
    tx, ty, vx, vy = pursuit
    roll = roll_factor(vx, vy, cycles)
    x, y = tx - roll * vx, ty - roll * vy
    return math.sqrt(x * x + y * y)


@kernel
def _missed_dashing(pursuit: Pursuit, power: float) -> float:
    tx, ty, _, _ = after_dash(pursuit, power)
    return math.sqrt(tx * tx + ty * ty)
