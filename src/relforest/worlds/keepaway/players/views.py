"""What each player sees in a cycle: the work space of one game.

Every player sees the whole field in its own frame: keepers that of the server, takers the field turned by 180
degrees about its centre, as in the RoboCup 2-D server, so that every player plays to the right. It knows
itself exactly. Of everything else it sees, with ``QUANTISED`` perception,

- the distance d as 0.1 round(10 exp(0.1 round(10 ln d))), about 5 % up or down;
- the direction, relative to its body, in whole degrees, as is the body direction of other players;
- the radial velocity in steps of 0.02 of the distance, and the angular velocity in steps of 0.1 degrees;
- the velocity of the ball, as the mean of what it sees and what it expected if the two agree within a tenth.

A player without the ball assumes that a ball held by an opponent is at rest; otherwise takers would chase
where a holder might kick it and never close in. ``EXACT`` perception keeps only this rule, ``FULLSTATE`` not
even that.

Letters: n players; player i sees player j.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from relforest.support.jit import kernel
from relforest.worlds.keepaway.players.memory import foresee, remember_look
from relforest.worlds.keepaway.players.motion import Ball, Player, table
from relforest.worlds.keepaway.server.layout import BODY, FULLSTATE, QUANTISED, VX, VY, Games, Setup, X, Y
from relforest.worlds.keepaway.server.referee import REACH
from relforest.worlds.keepaway.server.rounding import wrapped

N_GRID: Final = 25
N_PURSUIT: Final = 7

_NEAREST: Final = -30
_FARTHEST: Final = 80
_AGREEMENT: Final = 0.1


_DISTANCES: Final = table(np.rint(10.0 * np.exp(0.1 * np.arange(_NEAREST, _FARTHEST + 1))) / 10.0)
# Whole degrees from -180 to 180.
_COSINES: Final = table(np.cos(np.deg2rad(np.arange(-180.0, 181.0))))
_SINES: Final = table(np.sin(np.deg2rad(np.arange(-180.0, 181.0))))


class Work(NamedTuple):
    """Views of one game in one cycle, and space to plan in. Metres, metres per cycle, degrees."""

    views: NDArray[np.float64]  # (n, n, 5) x, y, vx, vy, body of player j as i sees it, in the frame of i
    balls: NDArray[np.float64]  # (n, 4) the ball as i sees it, in the frame of i
    facing: NDArray[np.float64]  # (n, n, 2) cosine and sine of the bodies in ``views``
    gaps: NDArray[np.float64]  # (n, n) squared distance between player j and the ball as i sees them
    pursuits: NDArray[np.float64]  # (n, 7) see `arrival.line_up`
    grid: NDArray[np.float64]  # (2, 25) places for a keeper to get open, x and y
    crowding: NDArray[np.float64]  # (25,)


@kernel
def new_work(setup: Setup) -> Work:
    """Return work space for one game at a time; every thread needs its own."""
    n = setup.keepers + setup.takers
    grid = np.empty((2, N_GRID))
    for place in range(N_GRID):
        grid[0, place] = (place // 5 - 2) * 0.175 * setup.length
        grid[1, place] = (place % 5 - 2) * 0.175 * setup.width
    return Work(
        np.zeros((n, n, 5)),
        np.zeros((n, 4)),
        np.zeros((n, n, 2)),
        np.zeros((n, n)),
        np.zeros((n, N_PURSUIT)),
        grid,
        np.zeros(N_GRID),
    )


@kernel
def observe(games: Games, g: int, setup: Setup, work: Work) -> None:
    """Let all players of game ``g`` look; looking again in the same cycle changes nothing."""
    n = setup.keepers + setup.takers
    views, balls, gaps = work.views, work.balls, work.gaps
    _see_bodies(games, g, setup, work)
    if setup.perception == QUANTISED:
        _see_roughly(games, g, setup, work)
        for i in range(n):
            _expect(games, g, i, balls)
    else:
        _see_exactly(games, g, setup, work)
    for i in range(n):
        for j in range(n):
            x, y = views[i, j, X] - balls[i, X], views[i, j, Y] - balls[i, Y]
            gaps[i, j] = x * x + y * y
        if setup.perception != FULLSTATE and gaps[i, i] > REACH * REACH:
            first, last = opponents(setup, i)
            for j in range(first, last):
                if gaps[i, j] <= REACH * REACH:
                    balls[i, VX] = 0.0
                    balls[i, VY] = 0.0
        remember_look(games, g, i, balls[i, VX], balls[i, VY])


@kernel
def opponents(setup: Setup, i: int) -> tuple[int, int]:
    """Return the first opponent of player ``i``, and the player after the last one."""
    if i >= setup.keepers:
        return 0, setup.keepers
    return setup.keepers, setup.keepers + setup.takers


@kernel
def in_reach(work: Work, i: int) -> bool:
    """Whether player ``i`` sees the ball near enough to kick it."""
    return bool(work.gaps[i, i] < REACH * REACH)


@kernel
def player_seen(work: Work, i: int, j: int) -> Player:
    """Return player ``j`` as player ``i`` sees it."""
    view = work.views
    return view[i, j, X], view[i, j, Y], view[i, j, VX], view[i, j, VY], view[i, j, BODY]


@kernel
def ball_seen(work: Work, i: int) -> Ball:
    """Return the ball as player ``i`` sees it."""
    return work.balls[i, X], work.balls[i, Y], work.balls[i, VX], work.balls[i, VY]


@kernel
def _see_bodies(games: Games, g: int, setup: Setup, work: Work) -> None:
    """Every player knows itself."""
    players, views, facing = games.players, work.views, work.facing
    for i in range(setup.keepers + setup.takers):
        sign = 1.0 if i < setup.keepers else -1.0
        for k in range(BODY):
            views[i, i, k] = sign * players[g, i, k]
        body = players[g, i, BODY] if i < setup.keepers else wrapped(players[g, i, BODY] + 180.0)
        views[i, i, BODY] = body
        facing[i, i, 0] = math.cos(math.radians(body))
        facing[i, i, 1] = math.sin(math.radians(body))


@kernel
def _see_exactly(games: Games, g: int, setup: Setup, work: Work) -> None:
    views, facing = work.views, work.facing
    n = setup.keepers + setup.takers
    for i in range(n):
        sign = 1.0 if i < setup.keepers else -1.0
        for k in range(4):
            work.balls[i, k] = sign * games.ball[g, k]
        for j in range(n):
            same = (i < setup.keepers) == (j < setup.keepers)
            for k in range(BODY):
                views[i, j, k] = views[j, j, k] if same else -views[j, j, k]
            views[i, j, BODY] = views[j, j, BODY] if same else wrapped(views[j, j, BODY] + 180.0)
            for k in range(2):
                facing[i, j, k] = facing[j, j, k] if same else -facing[j, j, k]


@kernel
def _see_roughly(games: Games, g: int, setup: Setup, work: Work) -> None:
    # All that two players see of each other but the direction is the same for both.
    players, ball, views, facing = games.players, games.ball, work.views, work.facing
    n = setup.keepers + setup.takers
    for i in range(n):
        sight = _sight(
            ball[g, X] - players[g, i, X],
            ball[g, Y] - players[g, i, Y],
            ball[g, VX] - players[g, i, VX],
            ball[g, VY] - players[g, i, VY],
        )
        work.balls[i, X], work.balls[i, Y], work.balls[i, VX], work.balls[i, VY] = _placed(
            views, facing, i, players[g, i, BODY], sight
        )
        for j in range(i):
            sight = _sight(
                players[g, j, X] - players[g, i, X],
                players[g, j, Y] - players[g, i, Y],
                players[g, j, VX] - players[g, i, VX],
                players[g, j, VY] - players[g, i, VY],
            )
            views[i, j, X], views[i, j, Y], views[i, j, VX], views[i, j, VY] = _placed(
                views, facing, i, players[g, i, BODY], sight
            )
            back = (sight[0], sight[1] + 180.0, sight[2], sight[3])
            views[j, i, X], views[j, i, Y], views[j, i, VX], views[j, i, VY] = _placed(
                views, facing, j, players[g, j, BODY], back
            )
            turned = round(wrapped(players[g, j, BODY] - players[g, i, BODY]))
            _see_body(views, facing, i, j, turned)
            _see_body(views, facing, j, i, -turned)


@kernel
def _sight(x: float, y: float, vx: float, vy: float) -> tuple[float, float, float, float]:
    """Return distance as seen, true direction, and radial and tangential velocity as seen."""
    distance = max(math.sqrt(x * x + y * y), 1e-10)
    step = min(max(round(10.0 * math.log(distance)), _NEAREST), _FARTHEST)
    seen = _DISTANCES[step - _NEAREST]
    approach = (vx * x + vy * y) / (distance * distance)
    turning = math.degrees((vy * x - vx * y) / (distance * distance))
    radial = seen * 0.02 * np.rint(approach / 0.02)
    tangential = seen * math.radians(0.1 * np.rint(turning / 0.1))
    return seen, math.degrees(math.atan2(y, x)), radial, tangential


@kernel
def _placed(
    views: NDArray[np.float64],
    facing: NDArray[np.float64],
    i: int,
    body: float,
    sight: tuple[float, float, float, float],
) -> tuple[float, float, float, float]:
    """Return position and velocity of what player ``i`` sees, in its own frame."""
    degrees = round(wrapped(sight[1] - body)) + 180
    ex, ey = _rotated(facing[i, i, 0], facing[i, i, 1], degrees)
    return (
        views[i, i, X] + sight[0] * ex,
        views[i, i, Y] + sight[0] * ey,
        views[i, i, VX] + sight[2] * ex - sight[3] * ey,
        views[i, i, VY] + sight[2] * ey + sight[3] * ex,
    )


@kernel
def _see_body(views: NDArray[np.float64], facing: NDArray[np.float64], i: int, j: int, turned: int) -> None:
    views[i, j, BODY] = wrapped(views[i, i, BODY] + turned)
    facing[i, j, 0], facing[i, j, 1] = _rotated(facing[i, i, 0], facing[i, i, 1], turned + 180)


@kernel
def _rotated(cosine: float, sine: float, degrees: int) -> tuple[float, float]:
    """Rotate a unit vector by ``degrees - 180`` whole degrees."""
    c, s = _COSINES[degrees], _SINES[degrees]
    return cosine * c - sine * s, sine * c + cosine * s


@kernel
def _expect(games: Games, g: int, i: int, balls: NDArray[np.float64]) -> None:
    """Average the velocity of the ball with the expected one, if they agree."""
    vx, vy = foresee(games, g, i, balls[i, VX], balls[i, VY])
    tolerance = _AGREEMENT * math.sqrt(vx * vx + vy * vy)
    if abs(balls[i, VX] - vx) <= tolerance and abs(balls[i, VY] - vy) <= tolerance:
        balls[i, VX] = 0.5 * (balls[i, VX] + vx)
        balls[i, VY] = 0.5 * (balls[i, VY] + vy)
