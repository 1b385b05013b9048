"""Which player can be where, and when: the estimates that decide which players go for the ball.

A player estimates its own time by simulating its commands. It assumes that others turn as it would and then
run straight at full power.
"""

from __future__ import annotations

import math
from typing import Final

from relforest.support.jit import kernel
from relforest.worlds.keepaway.players.motion import (
    BACK,
    BALL_PATH,
    HORIZON,
    PUSH,
    ROLL,
    Pursuit,
    after_dash,
    after_turn,
    dash_power,
    steer,
)
from relforest.worlds.keepaway.players.views import Work
from relforest.worlds.keepaway.server.layout import VX, VY, X, Y
from relforest.worlds.keepaway.server.physics import PLAYER_DECAY, PLAYER_SPEED_MAX
from relforest.worlds.keepaway.server.referee import REACH
from relforest.worlds.keepaway.server.rounding import TIE

Team = tuple[int, int]
"""The first player of a team, and the one after its last."""

LONGEST: Final = 2000
"""Cycles after which an estimate is given up; crossing the largest field takes fewer."""

_SEARCH: Final = 31
_TRIES: Final = 30
_RESTING: Final = 0.01
_ASIDE: Final = math.cos(math.radians(20.0))
_STEADY: Final = 1e-4
_SLACK: Final = 0.1


@kernel
def line_up(work: Work, i: int) -> None:
    """Prepare the estimates of player ``i``, for all players j.

    ``work.pursuits[j]`` becomes the position of the ball relative to player j (tx, ty), its velocity (bvx,
    bvy) and the velocity of player j (vx, vy), all in the body frame of j as i sees it; last comes by how
    much the speed of j exceeds that of a steady run, after the decay of a cycle.
    """
    views, facing, pursuits = work.views, work.facing, work.pursuits
    for j in range(views.shape[0]):
        c, s = facing[i, j, 0], facing[i, j, 1]
        x, y = work.balls[i, X] - views[i, j, X], work.balls[i, Y] - views[i, j, Y]
        pursuits[j, 0], pursuits[j, 1] = x * c + y * s, y * c - x * s
        x, y = work.balls[i, VX], work.balls[i, VY]
        pursuits[j, 2], pursuits[j, 3] = x * c + y * s, y * c - x * s
        x, y = views[i, j, VX], views[i, j, VY]
        pursuits[j, 4], pursuits[j, 5] = x * c + y * s, y * c - x * s
        steady = PUSH * PLAYER_DECAY / (1.0 - PLAYER_DECAY)
        pursuits[j, 6] = math.sqrt(x * x + y * y) - steady


@kernel
def pursuit_at(work: Work, j: int, path: float) -> Pursuit:
    """Return the pursuit of player j of where the ball is after rolling ``path`` times its velocity."""
    p = work.pursuits
    return p[j, 0] + path * p[j, 2], p[j, 1] + path * p[j, 3], p[j, 4], p[j, 5]


@kernel
def cycles_to_point(pursuit: Pursuit, i: int, j: int, most: int) -> int:
    """Estimate how many cycles player ``j`` needs until it has the target in reach, as player ``i`` sees it.

    Estimates longer than ``most`` need not be exact: any larger number may be returned for them.
    """
    if _within(pursuit):
        return 0
    tx, ty = pursuit[0], pursuit[1]
    aim_x, aim_y = tx, ty
    ahead = _ASIDE * math.sqrt(tx * tx + ty * ty) - TIE
    cycles = 0
    while cycles < most:
        turning, x, y = steer(pursuit, 1, BACK)
        if turning:
            pursuit, cosine, sine = after_turn(pursuit, x, y)
            aim_x, aim_y = aim_x * cosine + aim_y * sine, aim_y * cosine - aim_x * sine
        else:
            power = dash_power(pursuit[0], pursuit[2], 1)
            if power >= 0.0 or aim_x >= ahead:
                break
            pursuit = after_dash(pursuit, power)
        cycles += 1
        if _within(pursuit):
            return cycles
    if i == j:
        return cycles + _cycles_of_commands(pursuit, most - cycles)
    return cycles + _cycles_at_full_power(pursuit)


@kernel
def _within(pursuit: Pursuit) -> bool:
    return pursuit[0] * pursuit[0] + pursuit[1] * pursuit[1] < REACH * REACH


@kernel
def _cycles_of_commands(pursuit: Pursuit, most: int) -> int:
    cycles = 0
    while cycles <= most and not _within(pursuit):
        turning, x, y = steer(pursuit, 1, BACK)
        if turning:
            pursuit, _, _ = after_turn(pursuit, x, y)
        else:
            pursuit = after_dash(pursuit, dash_power(pursuit[0], pursuit[2], 1))
        cycles += 1
    return cycles


@kernel
def _cycles_at_full_power(pursuit: Pursuit) -> int:
    distance = math.sqrt(pursuit[0] * pursuit[0] + pursuit[1] * pursuit[1])
    speed = pursuit[2]
    cycles = 0
    while distance > REACH:
        previous = speed
        speed = min(speed + PUSH, PLAYER_SPEED_MAX)
        distance -= speed
        speed *= PLAYER_DECAY
        cycles += 1
        if abs(speed - previous) < _STEADY and speed >= 0.3:
            break
    if distance > REACH:
        cycles += math.ceil((distance - REACH) * PLAYER_DECAY / speed)
    return cycles


@kernel
def fastest(work: Work, i: int, team: Team, rivals: Team) -> tuple[int, int]:
    """Find the player of a team that gets to the ball first, as player ``i`` sees it after `line_up`.

    That is the player that can meet the rolling ball in the earliest cycle. If rivals (an empty range for
    nobody) can meet it earlier, it is the player that needs the fewest cycles to the place where they do. Of
    equally fast players, the one with the highest number is chosen. Returns it, and the cycle in which it has
    the ball, -1 = not by itself.
    """
    for cycle in range(_SEARCH + 1):
        first = _first_there(work, i, team, cycle)
        if first >= 0:
            return first, cycle
        if _first_there(work, i, rivals, cycle) >= 0:
            return _nearest_in_time(work, i, team, cycle), -1
    return _nearest_in_time(work, i, team, HORIZON), -1


@kernel
def _first_there(work: Work, i: int, team: Team, cycle: int) -> int:
    """Find the player with the fewest cycles, at most ``cycle``, to where the ball will be; -1 = none."""
    first, least = -1, cycle + 1
    horizon = PLAYER_SPEED_MAX * (cycle + 1) - TIE
    for j in range(team[1] - 1, team[0] - 1, -1):
        pursuit = pursuit_at(work, j, BALL_PATH[cycle])
        squared = pursuit[0] * pursuit[0] + pursuit[1] * pursuit[1]
        longest = min(horizon, _run(work, j, cycle))
        if squared < longest * longest:
            cycles = cycles_to_point(pursuit, i, j, least - 1)
            if cycles < least:
                first, least = j, cycles
    return first


@kernel
def _run(work: Work, j: int, cycles: int) -> float:
    """Return the largest distance that full dashes cover, and a little more for estimates."""
    return float(REACH + cycles + work.pursuits[j, 6] * ROLL[cycles] + _SLACK)


@kernel
def _nearest_in_time(work: Work, i: int, team: Team, cycle: int) -> int:
    first, least = -1, LONGEST + 1
    for j in range(team[1] - 1, team[0] - 1, -1):
        cycles = cycles_to_point(pursuit_at(work, j, BALL_PATH[cycle]), i, j, least - 1)
        if first < 0 or cycles < least:
            first, least = j, cycles
    return first


@kernel
def cycles_to_ball(work: Work, i: int, j: int, earliest: int) -> int:
    """Estimate when player ``j`` has the ball, as player ``i`` sees it after `line_up`.

    It is known not to have the ball before cycle ``earliest``; 1 if nothing is known.
    """
    bvx, bvy = work.balls[i, VX], work.balls[i, VY]
    here = pursuit_at(work, j, 0.0)
    if _within(here):
        return 0
    if bvx * bvx + bvy * bvy < (_RESTING - TIE) * (_RESTING - TIE):
        return cycles_to_point(here, i, j, LONGEST)
    for cycle in range(max(earliest, 1), _TRIES):
        pursuit = pursuit_at(work, j, BALL_PATH[cycle])
        longest = _run(work, j, cycle - 1)
        if pursuit[0] * pursuit[0] + pursuit[1] * pursuit[1] < longest * longest:
            cycles = cycles_to_point(pursuit, i, j, cycle - 1)
            if cycles < cycle:
                return cycles
    return _TRIES
