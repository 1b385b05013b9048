"""What a player does in a cycle: the scripts of keepers and takers (Stone et al. (2006)).

See `views` and `memory` for their information, `motion` and `arrival` for their predictions, and
`interception`, `kicks` and `positioning` for their skills. The functions here combine these, one player at a
time, after `observe`.
"""

from __future__ import annotations

import math

from relforest.support.jit import kernel
from relforest.worlds.keepaway.players.arrival import fastest, line_up
from relforest.worlds.keepaway.players.commands import Command, face
from relforest.worlds.keepaway.players.interception import intercept
from relforest.worlds.keepaway.players.kicks import KEEPER_HOLDS, TAKER_HOLDS, hold, pass_to, rate_of
from relforest.worlds.keepaway.players.memory import LAST_ACTION, expect_kicked, remember_decision
from relforest.worlds.keepaway.players.positioning import get_open, mark
from relforest.worlds.keepaway.players.views import Work, ball_seen, in_reach, player_seen
from relforest.worlds.keepaway.server.layout import KICK, Games, Setup, X, Y
from relforest.worlds.keepaway.server.referee import REACH
from relforest.worlds.keepaway.server.rounding import TIE


@kernel
def command_keeper(games: Games, g: int, i: int, action: int, setup: Setup, work: Work) -> None:
    """Let keeper ``i`` choose its command for this cycle, from what the players see; its memory changes too.

    If it has the ball in reach, it follows the action: 0 = hold, a = pass to the a-th nearest teammate, -1 =
    what it did last. Otherwise it goes for the ball if it is the fastest keeper, and else gets open.
    """
    if in_reach(work, i):
        chosen = action if action >= 0 else int(games.memory[g, i, LAST_ACTION])
        remember_decision(games, g, i, chosen)
        if chosen == 0:
            command = hold(work, i, setup, KEEPER_HOLDS)
        else:
            mate = nearest_mate(work, i, setup.keepers, chosen)
            command = pass_to(work, i, setup, work.views[i, mate, X], work.views[i, mate, Y])
    else:
        line_up(work, i)
        rivals = (setup.keepers, setup.keepers + setup.takers)
        first, cycle = fastest(work, i, (0, setup.keepers), rivals)
        if first == i:
            command = intercept(games, g, i, setup, work)
        else:
            command = get_open(work, i, setup, first, cycle)
    _give(games, g, i, command, work)


@kernel
def command_taker(games: Games, g: int, i: int, setup: Setup, work: Work) -> None:
    """Let taker ``i`` choose its command for this cycle.

    The taker nearest to the ball keeps it once it has it. The two nearest go for the ball, unless a taker
    already has it; all others mark keepers.
    """
    nearer = _takers_nearer(work, i, setup)
    if nearer == 0 and in_reach(work, i):
        command = hold(work, i, setup, TAKER_HOLDS)
    elif nearer >= 2:
        line_up(work, i)
        command = mark(work, i, setup)
    elif _another_taker_has_it(work, i, setup):
        ball = ball_seen(work, i)
        command = face(player_seen(work, i, i), ball[0] + ball[2], ball[1] + ball[3], 1)
    else:
        command = intercept(games, g, i, setup, work)
    _give(games, g, i, command, work)


@kernel
def nearest_mate(work: Work, i: int, keepers: int, rank: int) -> int:
    """Find the keeper that is the ``rank``-th nearest to keeper ``i``, 1 = nearest, as it sees them.

    Of equally distant ones the higher number comes first.
    """
    for j in range(keepers - 1, -1, -1):
        if j != i:
            before = 0
            for k in range(keepers - 1, -1, -1):
                if k not in (i, j):
                    further = _squared_distance(work, i, k) - _squared_distance(work, i, j)
                    if further < -TIE or (further <= TIE and k > j):
                        before += 1
            if before == rank - 1:
                return j
    return -1


@kernel
def _squared_distance(work: Work, i: int, j: int) -> float:
    x = work.views[i, j, X] - work.views[i, i, X]
    y = work.views[i, j, Y] - work.views[i, i, Y]
    return float(x * x + y * y)


@kernel
def _takers_nearer(work: Work, i: int, setup: Setup) -> int:
    """Count the takers that come before taker ``i`` in the order of their distances to the ball."""
    count = 0
    for j in range(setup.keepers, setup.keepers + setup.takers):
        further = work.gaps[i, j] - work.gaps[i, i]
        if further < -TIE or (further <= TIE and j > i):
            count += 1
    return count


@kernel
def _another_taker_has_it(work: Work, i: int, setup: Setup) -> bool:
    """Whether another taker is nearest to the ball of all players, and has it in reach."""
    best = setup.keepers + setup.takers - 1
    for j in range(best - 1, -1, -1):
        if work.gaps[i, j] < work.gaps[i, best] - TIE:
            best = j
    return best >= setup.keepers and best != i and work.gaps[i, best] < REACH * REACH


@kernel
def _give(games: Games, g: int, i: int, command: Command, work: Work) -> None:
    """Send a command; a player that kicks expects the ball to go where it kicks it."""
    games.commands[g, i, 0], games.commands[g, i, 1], games.commands[g, i, 2] = command
    if command[0] == KICK:
        me, ball = player_seen(work, i, i), ball_seen(work, i)
        push = command[1] * rate_of(me, ball)
        radians = math.radians(me[4] + command[2])
        vx, vy = ball[2] + push * math.cos(radians), ball[3] + push * math.sin(radians)
        expect_kicked(games, g, i, vx, vy)
