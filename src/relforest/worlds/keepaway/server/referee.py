"""The referee of keepaway: how an episode begins and when it is over.

The ball must stay on the field and out of the takers' reach (Stone et al. (2006); the rules are those of the
RoboCup 2-D server since version 10.0.4).
"""

from __future__ import annotations

from typing import Final

from relforest.support.jit import kernel
from relforest.worlds.keepaway.server.layout import (
    CAPPED,
    END,
    EPISODE,
    NEXT,
    NONE,
    OUT,
    PLAYING,
    STUCK_COUNT,
    TAKE_COUNT,
    TAKEN,
    TIME,
    VX,
    VY,
    Games,
    Setup,
    X,
    Y,
)
from relforest.worlds.keepaway.server.randomness import below, uniform

REACH: Final = 1.085
"""Metres between the centres of player and ball up to which a player has the ball: 0.3 + 0.085 + 0.7."""

TAKE_CYCLES: Final = 4
"""Cycles with a taker at the ball after which the ball is lost."""

CORNER: Final = 3.0
"""Side of the squares in the corners of the field, in metres, where players start."""

BALL_START: Final = 4.0
"""Distance of the ball from two sides of the field, in metres, when an episode starts."""

STUCK_DISTANCE: Final = 3.0
"""Metres that the ball must move so as not to count as stuck."""


@kernel
def place(games: Games, g: int, setup: Setup) -> None:
    """Begin an episode of game ``g``: place players and ball, and set the clock to zero.

    Three keepers start in random corners, the others at the centre. All takers start in the fourth corner,
    and the ball near the keeper in the first. Everything stands still.
    Players go on facing where they faced when the last episode ended, and the stuck-ball rule goes on
    counting.
    """
    streams, players = games.streams, games.players
    far_x, far_y = setup.length / 2.0, setup.width / 2.0
    shift = below(streams, g, setup.keepers)
    for i in range(setup.keepers + setup.takers):
        slot = (shift + i) % setup.keepers
        if i < setup.keepers and slot >= 3:
            players[g, i, X] = uniform(streams, g, -1.0, 1.0)
            players[g, i, Y] = uniform(streams, g, -1.0, 1.0)
        else:
            x = far_x - uniform(streams, g, 0.0, CORNER)
            y = far_y - uniform(streams, g, 0.0, CORNER)
            players[g, i, X] = -x if i >= setup.keepers or slot == 0 else x
            players[g, i, Y] = y if i >= setup.keepers or slot == 2 else -y
        players[g, i, VX] = 0.0
        players[g, i, VY] = 0.0
        games.commands[g, i] = NONE
    games.ball[g, X] = BALL_START - far_x
    games.ball[g, Y] = BALL_START - far_y
    games.ball[g, VX] = 0.0
    games.ball[g, VY] = 0.0
    games.memory[g] = 0.0
    counters = games.counters
    counters[g, TIME] = 0
    counters[g, EPISODE] += 1
    counters[g, TAKE_COUNT] = 0
    counters[g, END] = PLAYING
    counters[g, NEXT] = 0


@kernel
def judge(games: Games, g: int, setup: Setup) -> None:
    """Move the clock of game ``g`` on by one cycle and see whether the episode is over.

    In this order: the ball is out; the takers have had it for `TAKE_CYCLES` cycles, not necessarily in a
    row; then this cycle is counted, so that the takers win one cycle after their fourth. A keeper in reach
    sets the count to zero only if no taker is in reach.
    """
    counters, ball = games.counters, games.ball
    counters[g, TIME] += 1
    if setup.stuck_ball > 0:
        _free_stuck_ball(games, g, setup)
    # Written so that a ball that is nowhere (NaN) is not on the field either.
    inside = abs(ball[g, X]) < setup.length / 2.0 and abs(ball[g, Y]) < setup.width / 2.0
    if not inside:
        counters[g, END] = OUT
    elif counters[g, TAKE_COUNT] >= TAKE_CYCLES:
        counters[g, END] = TAKEN
    elif _anyone_in_reach(games, g, setup.keepers, setup.keepers + setup.takers):
        counters[g, TAKE_COUNT] += 1
    elif _anyone_in_reach(games, g, 0, setup.keepers):
        counters[g, TAKE_COUNT] = 0
    if counters[g, END] == PLAYING and 0 < setup.max_cycles <= counters[g, TIME]:
        counters[g, END] = CAPPED


@kernel
def _anyone_in_reach(games: Games, g: int, first: int, last: int) -> bool:
    for i in range(first, last):
        x = games.players[g, i, X] - games.ball[g, X]
        y = games.players[g, i, Y] - games.ball[g, Y]
        if x * x + y * y < REACH * REACH:
            return True
    return False


@kernel
def _free_stuck_ball(games: Games, g: int, setup: Setup) -> None:
    ball, anchor, counters = games.ball, games.anchor, games.counters
    x, y = ball[g, X] - anchor[g, 0], ball[g, Y] - anchor[g, 1]
    if x * x + y * y <= STUCK_DISTANCE * STUCK_DISTANCE:
        counters[g, STUCK_COUNT] += 1
        if counters[g, STUCK_COUNT] < setup.stuck_ball:
            return
        ball[g, VX] = 0.0
        ball[g, VY] = 0.0
    anchor[g, 0] = ball[g, X]
    anchor[g, 1] = ball[g, Y]
    counters[g, STUCK_COUNT] = 0
