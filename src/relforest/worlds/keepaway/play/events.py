"""Counts of events in a game, beyond its duration, to compare simulated with real games."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from relforest.support.jit import kernel
from relforest.worlds.keepaway.server.layout import DASH, KICK, TIME, TURN, VX, VY, Games, Setup, X, Y
from relforest.worlds.keepaway.server.referee import REACH

KEEPER_KICKS: Final = 0
TAKER_KICKS: Final = 1
TRANSFERS: Final = 2
KEEPER_CYCLES: Final = 3
TAKER_CYCLES: Final = 4
FIRST_TOUCH: Final = 5
DASHES: Final = 6
TURNS: Final = 7
HOLDER: Final = 8
N_EVENTS: Final = 9

SPEED_STEP: Final = 0.01
"""Width of a cell of `Tally.speeds`, in metres per cycle."""

N_SPEEDS: Final = 320


class Tally(NamedTuple):
    """Counts that `count_events` adds to.

    ``events`` holds, for one episode: kicks of keepers and of takers; changes of the ball from one keeper to
    another; cycles with the ball in reach of a keeper, and of a taker; the first cycle with a keeper at the
    ball (-1 = none yet); dashes and turns of all players; the last keeper that had the ball (-1 = none yet).
    """

    events: NDArray[np.int64]  # (N_EVENTS,) KEEPER_KICKS ... HOLDER
    speeds: NDArray[np.int64]  # (N_SPEEDS,) cycles by speed of the ball, the last cell is open
    pairs: NDArray[np.float64]  # (K (K - 1) / 2,) sums of distances between keepers, ascending, metres


def new_tally(setup: Setup) -> Tally:
    """Return a tally with nothing counted."""
    tally = Tally(
        np.zeros(N_EVENTS, dtype=np.int64),
        np.zeros(N_SPEEDS, dtype=np.int64),
        np.zeros(setup.keepers * (setup.keepers - 1) // 2),
    )
    forget_events(tally)
    return tally


@kernel
def forget_events(tally: Tally) -> None:
    """Begin to count another episode; speeds and distances of keepers go on."""
    tally.events[:] = 0
    tally.events[FIRST_TOUCH] = -1
    tally.events[HOLDER] = -1


@kernel
def count_events(games: Games, g: int, setup: Setup, tally: Tally) -> None:
    """Count one cycle of game ``g``: its state, and the commands chosen in it but not yet carried out."""
    events, ball = tally.events, games.ball[g]
    nearest_keeper, keeper_distance = _nearest(games, g, 0, setup.keepers)
    _, taker_distance = _nearest(games, g, setup.keepers, setup.keepers + setup.takers)
    if keeper_distance < REACH:
        events[KEEPER_CYCLES] += 1
        if events[FIRST_TOUCH] < 0:
            events[FIRST_TOUCH] = games.counters[g, TIME]
        if 0 <= events[HOLDER] != nearest_keeper:
            events[TRANSFERS] += 1
        events[HOLDER] = nearest_keeper
    if taker_distance < REACH:
        events[TAKER_CYCLES] += 1
    for i in range(setup.keepers + setup.takers):
        verb = games.commands[g, i, 0]
        if verb == KICK:
            events[KEEPER_KICKS if i < setup.keepers else TAKER_KICKS] += 1
        elif verb == DASH:
            events[DASHES] += 1
        elif verb == TURN:
            events[TURNS] += 1
    speed = math.hypot(ball[VX], ball[VY])
    tally.speeds[min(int(speed / SPEED_STEP), N_SPEEDS - 1)] += 1
    _add_distances(games, g, setup.keepers, tally)


@kernel
def _nearest(games: Games, g: int, first: int, last: int) -> tuple[int, float]:
    nearest, least = -1, math.inf
    for i in range(first, last):
        x = games.players[g, i, X] - games.ball[g, X]
        y = games.players[g, i, Y] - games.ball[g, Y]
        distance = math.hypot(x, y)
        if distance < least:
            nearest, least = i, distance
    return nearest, least


@kernel
def _add_distances(games: Games, g: int, keepers: int, tally: Tally) -> None:
    distances = np.empty(len(tally.pairs))
    filled = 0
    for i in range(keepers):
        for j in range(i):
            x = games.players[g, i, X] - games.players[g, j, X]
            y = games.players[g, i, Y] - games.players[g, j, Y]
            distance = math.hypot(x, y)
            place = filled
            while place > 0 and distances[place - 1] > distance:
                distances[place] = distances[place - 1]
                place -= 1
            distances[place] = distance
            filled += 1
    for place in range(filled):
        tally.pairs[place] += distances[place]
