"""Where players without the ball go: keepers get open for a pass, takers mark keepers."""

from __future__ import annotations

import math
from typing import Final

from relforest.support.jit import kernel
from relforest.worlds.keepaway.players.arrival import cycles_to_ball, fastest
from relforest.worlds.keepaway.players.commands import Command, dash, face
from relforest.worlds.keepaway.players.motion import BALL_PATH, HORIZON, Player, dash_power, turn_limit
from relforest.worlds.keepaway.players.views import N_GRID, Work, ball_seen, opponents, player_seen
from relforest.worlds.keepaway.server.layout import Setup, X, Y
from relforest.worlds.keepaway.server.physics import PLAYER_DECAY
from relforest.worlds.keepaway.server.rounding import TIE, heading, wrapped

_CONE: Final = 0.3
_ARRIVED: Final = 1.5
_OPEN_TOLERANCE: Final = 7.0
_ROLL_OUT: Final = 1.0 / (1.0 - PLAYER_DECAY)

_BEFORE: Final = 1.0
_MARKING: Final = 4.0
_MARKED: Final = 2.0
_MARK_TOLERANCE: Final = 25.0
_MARK_BACK: Final = 3.0
_LOOK: Final = 80.0


@kernel
def get_open(work: Work, i: int, setup: Setup, passer: int, earliest: int) -> Command:
    """Go to the least crowded place to which the ball can be passed, and face the ball there.

    Places are a grid of 5 x 5 in the inner 70 % of the field, in fractions of its length (x) and width (y).
    Crowding is the sum of 1 / distance over all other players. The pass is assumed to come from
    where ``passer`` gets the ball. ``earliest`` is as in `cycles_to_ball`.
    """
    me, ball = player_seen(work, i, i), ball_seen(work, i)
    path = BALL_PATH[min(cycles_to_ball(work, i, passer, earliest), HORIZON)]
    start_x, start_y = ball[0] + path * ball[2], ball[1] + path * ball[3]
    measure_crowding(work, i)
    first, last = opponents(setup, i)
    best_x, best_y, least = 0.0, 0.0, math.inf
    for place in range(N_GRID):
        x, y = work.grid[0, place], work.grid[1, place]
        if (
            work.crowding[place] < least
            and count_in_cone(work, i, (first, last), (start_x, start_y), (x, y)) == 0
        ):
            best_x, best_y, least = x, y, work.crowding[place]
    x, y = best_x - me[0], best_y - me[1]
    if x * x + y * y < _ARRIVED * _ARRIVED:
        return face(me, ball[0], ball[1], 1)
    return move_to(me, best_x, best_y, _OPEN_TOLERANCE, 0.0)


@kernel
def measure_crowding(work: Work, i: int) -> None:
    """Set ``work.crowding`` to the sums of 1 / distance to all players but ``i``, for all places."""
    crowding, grid = work.crowding, work.grid
    crowding[:] = 0.0
    for j in range(work.views.shape[0]):
        if j != i:
            px, py = work.views[i, j, X], work.views[i, j, Y]
            for place in range(N_GRID):
                x, y = grid[0, place] - px, grid[1, place] - py
                crowding[place] += 1.0 / math.sqrt(max(x * x + y * y, TIE * TIE))


@kernel
def count_in_cone(
    work: Work,
    i: int,
    team: tuple[int, int],
    start: tuple[float, float],
    end: tuple[float, float],
) -> int:
    """Count the players of a team that can cut off a pass, as player ``i`` sees them.

    They stand beside the way from start to end, no farther from it than 0.3 times the distance from the start
    to the point next to them, and nearer to the start than the end is.
    """
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = dx * dx + dy * dy
    count = 0
    for j in range(team[0], team[1]):
        x, y = work.views[i, j, X] - start[0], work.views[i, j, Y] - start[1]
        along, across = x * dx + y * dy, abs(x * dy - y * dx)
        beside = 0.0 < along < length and across < _CONE * along - TIE
        if beside and x * x + y * y < length - TIE:
            count += 1
    return count


@kernel
def move_to(me: Player, x: float, y: float, tolerance: float, back: float) -> Command:
    """Go to a point: dash if it lies ahead within ``tolerance`` degrees, else turn to it.

    A point up to ``back`` metres behind is reached backwards. A player so fast that it would need three turns
    or more stops first.
    """
    end_x, end_y = me[0] + me[2] * _ROLL_OUT, me[1] + me[3] * _ROLL_OUT
    angle = wrapped(heading(x - end_x, y - end_y) - me[4])
    radians = math.radians(me[4])
    cosine, sine = math.cos(radians), math.sin(radians)
    velocity = me[2] * cosine + me[3] * sine
    dx, dy = x - me[0], y - me[1]
    ahead = abs(angle) < tolerance
    behind = abs(wrapped(angle + 180.0)) < tolerance and dx * dx + dy * dy < back * back
    if ahead or behind:
        return dash(dash_power(dx * cosine + dy * sine, velocity, 1))
    speed = math.sqrt(me[2] * me[2] + me[3] * me[3])
    left = abs(angle)
    for _ in range(2):
        left -= turn_limit(speed)
        if left < tolerance:
            return face(me, x, y, 2)
        speed *= PLAYER_DECAY
    return dash(dash_power(0.0, velocity, 1))


@kernel
def mark(work: Work, i: int, setup: Setup) -> Command:
    """Stand between the ball and the keeper with the fewest takers cutting off the pass, 4 m from it.

    The pass is assumed to come from the keeper that is fastest to the ball, after `line_up`. At its place the
    taker faces aside, so that it sees both ball and keeper.
    """
    me, ball = player_seen(work, i, i), ball_seen(work, i)
    holder, _ = fastest(work, i, (0, setup.keepers), (0, 0))
    keeper = _freest_keeper(work, i, setup, holder)
    x, y = work.views[i, keeper, X], work.views[i, keeper, Y]
    before = x - _BEFORE
    dx, dy = ball[0] - before, ball[1] - y
    direction = math.radians(heading(dx, dy))
    target_x, target_y = before + _MARKING * math.cos(direction), y + _MARKING * math.sin(direction)
    dx, dy = target_x - me[0], target_y - me[1]
    if dx * dx + dy * dy < _MARKED * _MARKED:
        to_keeper = heading(x - me[0], y - me[1])
        to_ball = wrapped(heading(ball[0] - me[0], ball[1] - me[1]) - to_keeper)
        look = math.radians(to_keeper + (_LOOK if TIE < to_ball < 180.0 - TIE else -_LOOK))
        return face(me, me[0] + math.cos(look), me[1] + math.sin(look), 1)
    return move_to(me, target_x, target_y, _MARK_TOLERANCE, _MARK_BACK)


@kernel
def _freest_keeper(work: Work, i: int, setup: Setup, holder: int) -> int:
    takers = (setup.keepers, setup.keepers + setup.takers)
    start = (work.views[i, holder, X], work.views[i, holder, Y])
    best, least = -1, setup.takers + 1
    for j in range(setup.keepers - 1, -1, -1):
        count = 0
        if j != holder:
            count = count_in_cone(work, i, takers, start, (work.views[i, j, X], work.views[i, j, Y]))
        if count < least:
            best, least = j, count
    return best
