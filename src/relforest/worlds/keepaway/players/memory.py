"""What a player remembers from cycle to cycle: its last decision, its plan, and how fast the ball was.

A row of zeros is a player without memories, as at the beginning of an episode; moments are therefore stored
as the cycle plus one. Points and velocities are in the player's own frame.
"""

from __future__ import annotations

import math
from typing import Final

from relforest.support.jit import kernel
from relforest.worlds.keepaway.server.layout import TIME, Games
from relforest.worlds.keepaway.server.physics import BALL_DECAY, BALL_SPEED_MAX

LAST_ACTION: Final = 0
DECIDED: Final = 1
"""When the player last had the ball within reach and acted on it."""

POINT_X: Final = 2
POINT_Y: Final = 3
CHASED: Final = 4
"""When the player last ran for the ball, to meet it at the point."""

SEEN: Final = 5
"""When the player last looked."""

FORESEEN_X: Final = 6
FORESEEN_Y: Final = 7
"""Velocity of the ball that the player expected when it looked."""

NEXT_X: Final = 8
NEXT_Y: Final = 9
"""Velocity of the ball that it expects for the next cycle."""

N_MEMORY: Final = 10

_PATIENCE: Final = 2


@kernel
def continues_pass(games: Games, g: int, i: int) -> bool:
    """Whether player ``i`` was passing one cycle ago: it goes on until the ball has left."""
    memory = games.memory
    before = memory[g, i, DECIDED] == games.counters[g, TIME]
    return bool(before and memory[g, i, LAST_ACTION] > 0)


@kernel
def remember_decision(games: Games, g: int, i: int, action: int) -> None:
    """Record what player ``i`` does with the ball in this cycle: 0 = hold, a = pass to the a-th mate."""
    games.memory[g, i, LAST_ACTION] = action
    games.memory[g, i, DECIDED] = games.counters[g, TIME] + 1


@kernel
def meeting_point(games: Games, g: int, i: int) -> tuple[float, float]:
    """Return where player ``i`` planned to meet the ball in the last two cycles; NaN if it did not plan."""
    memory = games.memory
    age = games.counters[g, TIME] + 1 - memory[g, i, CHASED]
    if memory[g, i, CHASED] == 0.0 or age > _PATIENCE:
        return math.nan, math.nan
    return memory[g, i, POINT_X], memory[g, i, POINT_Y]


@kernel
def remember_meeting_point(games: Games, g: int, i: int, x: float, y: float) -> None:
    """Note where player ``i`` plans to meet the ball."""
    games.memory[g, i, POINT_X] = x
    games.memory[g, i, POINT_Y] = y
    games.memory[g, i, CHASED] = games.counters[g, TIME] + 1


@kernel
def looks_again(games: Games, g: int, i: int) -> bool:
    """Whether player ``i`` has looked in this cycle before."""
    return bool(games.memory[g, i, SEEN] == games.counters[g, TIME] + 1)


@kernel
def foresee(games: Games, g: int, i: int, vx: float, vy: float) -> tuple[float, float]:
    """Return the velocity of the ball that player ``i`` expected for this cycle.

    Repeated calls in the same cycle give the same result. A player that did not look one cycle ago expected
    exactly what it sees: (``vx``, ``vy``).
    """
    memory, now = games.memory, games.counters[g, TIME]
    if not looks_again(games, g, i):
        follows = now > 0 and memory[g, i, SEEN] == now
        memory[g, i, FORESEEN_X] = memory[g, i, NEXT_X] if follows else vx
        memory[g, i, FORESEEN_Y] = memory[g, i, NEXT_Y] if follows else vy
    return memory[g, i, FORESEEN_X], memory[g, i, FORESEEN_Y]


@kernel
def remember_look(games: Games, g: int, i: int, vx: float, vy: float) -> None:
    """Note that player ``i`` has looked in this cycle, and seen the ball with this velocity."""
    if not looks_again(games, g, i):
        games.memory[g, i, SEEN] = games.counters[g, TIME] + 1
        expect_velocity(games, g, i, vx, vy)


@kernel
def expect_velocity(games: Games, g: int, i: int, vx: float, vy: float) -> None:
    """Note that player ``i`` believes that the ball now begins to roll with this velocity."""
    games.memory[g, i, NEXT_X] = vx * BALL_DECAY
    games.memory[g, i, NEXT_Y] = vy * BALL_DECAY


@kernel
def expect_kicked(games: Games, g: int, i: int, vx: float, vy: float) -> None:
    """Record that player ``i`` has just kicked the ball to give it this velocity, if that is possible."""
    limit = min(BALL_SPEED_MAX / max(math.sqrt(vx * vx + vy * vy), BALL_SPEED_MAX), 1.0)
    expect_velocity(games, g, i, vx * limit, vy * limit)
