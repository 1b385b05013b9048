"""How a player goes for a ball that it does not have: where to meet it, and the first command on the way.

Everything is planned in the body frame of the player (see `motion`), where the ball moves along a line too.
"""

from __future__ import annotations

import math
from typing import Final

from relforest.support.jit import kernel
from relforest.worlds.keepaway.players.close_interception import close_interception
from relforest.worlds.keepaway.players.commands import Command, dash, face, turn
from relforest.worlds.keepaway.players.memory import meeting_point, remember_meeting_point
from relforest.worlds.keepaway.players.motion import (
    BACK,
    BALL_PATH,
    BALL_SLOWING,
    HORIZON,
    LAUNCH,
    NARROW,
    PUSH,
    ROLL,
    Approach,
    Pursuit,
    after_dash,
    after_turn,
    approach_of,
    dash_power,
    pursuit_of,
    roll_factor,
    steer,
)
from relforest.worlds.keepaway.players.views import Work, ball_seen, opponents, player_seen
from relforest.worlds.keepaway.server.layout import Games, Setup
from relforest.worlds.keepaway.server.physics import PLAYER_DECAY, PLAYER_SPEED_MAX
from relforest.worlds.keepaway.server.referee import REACH
from relforest.worlds.keepaway.server.rounding import TIE, heading

_LATEST: Final = 30
_AFTER_FIRST: Final = 20
_WINDOW: Final = 3
_FAST: Final = 0.6
_SAME: Final = 1.0
_GAP: Final = 10.0
_SURE: Final = 0.7 * REACH
_HALF: Final = 0.5 * REACH

_STEADY: Final = PUSH * PLAYER_DECAY / (1.0 - PLAYER_DECAY)
_OUT_OF_REACH: Final = 10.0 * REACH

_BESIDE: Final = 0.5


@kernel
def intercept(games: Games, g: int, i: int, setup: Setup, work: Work) -> Command:
    """Return the command of player ``i`` on its way to the ball, remembering where it plans to meet it."""
    me, ball = player_seen(work, i, i), ball_seen(work, i)
    c, s = work.facing[i, i, 0], work.facing[i, i, 1]
    approach = approach_of(me, ball, c, s)
    old_x, old_y = meeting_point(games, g, i)
    x, y = old_x - me[0], old_y - me[1]
    cycle = meeting_cycle(approach, x * c + y * s, y * c - x * s)
    path = BALL_PATH[cycle]
    remember_meeting_point(games, g, i, ball[0] + path * ball[2], ball[1] + path * ball[3])
    if cycle < 3:
        found, command = close_interception(approach, me[4], c, _nearest_opponent(work, i, setup))
        if found:
            return command
    pursuit = pursuit_of(approach, path)
    roll = roll_factor(pursuit[2], pursuit[3], min(cycle, 4))
    x, y = pursuit[0] - roll * pursuit[2], pursuit[1] - roll * pursuit[3]
    if x * x + y * y < (_BESIDE - TIE) * (_BESIDE - TIE):
        return face(me, me[0] + 1.0, me[1], 1)
    return command_towards(pursuit, cycle)


@kernel
def command_towards(pursuit: Pursuit, cycles: int) -> Command:
    """Return the command that `steer` decides on."""
    turning, x, y = steer(pursuit, cycles, BACK)
    if turning:
        return turn(heading(x, y), math.sqrt(pursuit[2] * pursuit[2] + pursuit[3] * pursuit[3]))
    return dash(dash_power(pursuit[0], pursuit[2], cycles))


@kernel
def meeting_cycle(approach: Approach, old_x: float, old_y: float) -> int:
    """Find in which cycle the player will meet the ball: the first possible one, or one near the old plan.

    The plan is a point of the body frame; NaN for no plan. Returns 0 to 30; `HORIZON` if the player cannot
    get the ball.
    """
    speed = math.sqrt(approach[2] * approach[2] + approach[3] * approach[3])
    last_old = _last_near_old_plan(approach, speed, old_x, old_y)
    first, least, kept = -1, -1, -1
    gap, nearest = _GAP, _SAME
    for cycle in range(_LATEST + 1):
        if 0 <= first < cycle - _AFTER_FIRST:
            break
        # Later cycles may not change the choice.
        if first >= 0 and cycle > last_old and (kept < 0 or cycle > max(least, kept) + _WINDOW):
            break
        pursuit = pursuit_of(approach, BALL_PATH[cycle])
        if not _may_reach(pursuit, cycle):
            continue
        miss = miss_after(pursuit, cycle)
        if miss >= REACH:
            continue
        if first < 0:
            first = least = cycle
        change = math.hypot(pursuit[0] - old_x, pursuit[1] - old_y)
        if change < nearest and miss < _SURE and speed * BALL_SLOWING[cycle] > _FAST + TIE:
            kept, gap, nearest = cycle, miss, change
        elif miss < gap and gap > _HALF and (cycle <= least + _WINDOW or 0 <= kept >= cycle - _WINDOW):
            if 0 <= kept == cycle - 1:
                kept = cycle
            least, gap = cycle, miss
    if kept >= 0 and least <= kept + 2:
        return kept
    return first if first >= 0 else HORIZON


@kernel
def _last_near_old_plan(approach: Approach, speed: float, old_x: float, old_y: float) -> int:
    """Find the last cycle in which the ball is fast, and near the place where it was to be met; -1 = none."""
    last = -1
    if not math.isnan(old_x):
        for cycle in range(_LATEST + 1):
            if speed * BALL_SLOWING[cycle] <= _FAST:
                break
            x = approach[0] + BALL_PATH[cycle] * approach[2] - old_x
            y = approach[1] + BALL_PATH[cycle] * approach[3] - old_y
            if x * x + y * y < _SAME * _SAME:
                last = cycle
    return last


@kernel
def _may_reach(pursuit: Pursuit, cycle: int) -> bool:
    tx, ty, vx, vy = pursuit
    roll = roll_factor(vx, vy, min(cycle, 4))
    x, y = tx - roll * vx, ty - roll * vy
    longest = PLAYER_SPEED_MAX * (cycle + REACH)
    return x * x + y * y <= longest * longest


@kernel
def miss_after(pursuit: Pursuit, cycles: int) -> float:
    """Return how far from the target a player ends up that moves to it in some cycles.

    Beyond reach the number may be smaller or larger than the true distance, but never less than `REACH`.
    """
    for left in range(cycles, 0, -1):
        tx, ty, vx, vy = pursuit
        longest = left + REACH + max(math.sqrt(vx * vx + vy * vy) - _STEADY, 0.0) * ROLL[left]
        if tx * tx + ty * ty > longest * longest:
            return _OUT_OF_REACH
        turning, x, y = steer(pursuit, left, BACK)
        if turning:
            pursuit, x, y = after_turn(pursuit, x, y)
            continue
        power = dash_power(tx, vx, left)
        pursuit = after_dash(pursuit, power)
        # A dash that no limit cuts short needs no other: from here the player rolls to beside the target.
        speed = tx * LAUNCH[left]
        side = float(ty - vy * ROLL[left])
        if (
            abs(side) <= NARROW
            and abs(speed - vx) < PUSH
            and speed * speed + vy * vy < PLAYER_SPEED_MAX * PLAYER_SPEED_MAX
        ):
            return abs(side)
    tx, ty, _, _ = pursuit
    return math.sqrt(tx * tx + ty * ty)


@kernel
def _nearest_opponent(work: Work, i: int, setup: Setup) -> float:
    """Return the squared distance to the opponent nearest to player ``i``."""
    first, last = opponents(setup, i)
    me, nearest = player_seen(work, i, i), math.inf
    for j in range(first, last):
        other = player_seen(work, i, j)
        x, y = other[0] - me[0], other[1] - me[1]
        nearest = min(nearest, x * x + y * y)
    return nearest
