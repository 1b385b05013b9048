"""The memory layout of a batch of games: the arrays, and the meaning of their columns and codes.

Letters: G games, n players (K keepers first, then T takers). Lengths are metres, speeds metres per cycle
of 0.1 s, and angles degrees from -180 to 180, counted from the x axis towards the y axis; the centre of the
field is (0, 0).
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

EXACT: Final = 0
QUANTISED: Final = 1
FULLSTATE: Final = 2

PERCEPTIONS: Final[Mapping[str, int]] = MappingProxyType(
    {"exact": EXACT, "quantised": QUANTISED, "fullstate": FULLSTATE}
)
"""Name of a perception in the options -> its code."""

NONE: Final = 0
DASH: Final = 1
TURN: Final = 2
KICK: Final = 3

PLAYING: Final = 0
OUT: Final = 1
TAKEN: Final = 2
CAPPED: Final = 3

X: Final = 0
Y: Final = 1
VX: Final = 2
VY: Final = 3
BODY: Final = 4

TIME: Final = 0
EPISODE: Final = 1
TAKE_COUNT: Final = 2
END: Final = 3
STUCK_COUNT: Final = 4
NEXT: Final = 5
N_COUNTERS: Final = 6


SECOND: Final = 10
"""Cycles in a second."""


class Setup(NamedTuple):
    """What all games of a batch have in common, as plain numbers; `KeepawayOptions.setup` makes it."""

    keepers: int
    takers: int
    length: float  # metres, along x
    width: float  # metres, along y
    perception: int  # EXACT, QUANTISED or FULLSTATE
    stuck_ball: int  # cycles until a ball that stays within 3 m is dropped; 0 = never
    max_cycles: int  # cycles after which an episode is cut off; 0 = never


class Games(NamedTuple):
    """The state of G games; the kernels change it in place, one game at a time.

    ``counters`` holds TIME (cycles since the episode began), EPISODE (how many have begun), TAKE_COUNT
    (cycles with a taker at the ball, as the referee counts them), END (PLAYING, or how the episode ended),
    STUCK_COUNT (cycles that the ball has stayed near ``anchor``) and NEXT (0 = a new cycle, nobody has
    looked yet; i + 1 = player i has yet to choose its command).
    """

    players: NDArray[np.float64]  # (G, n, 5) x, y, vx, vy, body
    ball: NDArray[np.float64]  # (G, 4) x, y, vx, vy
    commands: NDArray[np.int64]  # (G, n, 3) verb, power (dash, kick) or moment (turn), direction (kick)
    memory: NDArray[np.float64]  # (G, n, N_MEMORY) what each player remembers
    counters: NDArray[np.int64]  # (G, N_COUNTERS)
    anchor: NDArray[np.float64]  # (G, 2) where the stuck-ball rule saw the ball move last
    streams: NDArray[np.int64]  # (G, 6) random numbers, see `randomness`
