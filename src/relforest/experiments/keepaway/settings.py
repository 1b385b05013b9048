"""What is played and learned, and what real games of the RoboCup 2-D server gave."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final

PHYSICS: Final = "physics"
DURATIONS: Final = "durations"
LEARNING: Final = "learning"
SPEED: Final = "speed"


@final
@dataclass(frozen=True, slots=True)
class KeepawaySetting:
    """One measurement."""

    part: str  # PHYSICS, DURATIONS, LEARNING or SPEED
    keepers: int = 3
    takers: int = 2
    size: float = 20.0  # side of the field in metres
    condition: str = ""  # policy of the keepers, or how they learn
    episodes: int = 0  # episodes played
    block: int = 500  # episodes over which durations are averaged while learning
    run: int = 0  # number of the run

    @property
    def game(self) -> str:
        """Such as 3v2."""
        return f"{self.keepers}v{self.takers}"

    def __str__(self) -> str:
        """Return the part, the game, the condition and the number of the run."""
        return f"{self.part}, {self.game} {self.condition} {self.run}"


POLICIES: Final = ("random", "hold", "hand")
SEPARATE: Final = "cmac-sarsa"
SHARED: Final = "cmac-sarsa-shared"
METHODS: Final = (SEPARATE, SHARED)
GAMES: Final = ((3, 2, 20.0), (4, 3, 25.0), (5, 4, 30.0), (6, 5, 35.0))
"""Keepers, takers and side of the field; the first two are those of the benchmark."""

N_EPISODES: Final = 2000
N_LEARNING: Final = 8000
N_RUNS: Final = 3

SERVER: Final[Mapping[str, Mapping[str, float]]] = {
    "random": {"mean": 55.1, "sd": 18.0, "q5": 33.0, "q50": 51.0, "q95": 89.0, "taken": 0.88},
    "hold": {"mean": 29.2, "sd": 9.8, "q5": 21.0, "q50": 27.0, "q95": 49.0, "taken": 0.48},
    "hand": {"mean": 155.0, "sd": 114.0, "q5": 34.0, "q50": 122.0, "q95": 366.0, "taken": 0.40},
}
"""3v2 on the real server: version 19 with the parameters of versions 13 to 16, the players of the benchmark,
a field of view of 360 degrees, synchronous mode; 968, 600 and 595 episodes. Durations in cycles."""

SERVER_EVENTS: Final[Mapping[str, tuple[str, float]]] = {
    "transfers": ("passes from keeper to keeper per episode", 5.4),
    "keeper_kicks": ("kicks of keepers per episode", 13.9),
    "taker_kicks": ("kicks of takers per episode", 3.5),
    "keeper_in_reach": ("share of cycles with a keeper at the ball", 0.273),
    "taker_in_reach": ("share of cycles with a taker at the ball", 0.072),
    "first_touch": ("first cycle with a keeper at the ball", 4.9),
    "dashes": ("share of dashes among the commands", 0.44),
    "turns": ("share of turns among the commands", 0.50),
    "nearest_pair": ("distance of the nearest two keepers (m)", 11.2),
    "middle_pair": ("distance of the middle pair (m)", 13.1),
    "farthest_pair": ("distance of the farthest two (m)", 16.5),
    "ball_q5": ("speed of the ball, 5 % quantile (m per cycle)", 0.0),
    "ball_q25": ("25 %", 0.55),
    "ball_q50": ("50 %", 1.46),
    "ball_q75": ("75 %", 1.71),
    "ball_q95": ("95 %", 2.01),
    "ball_q99": ("99 %", 2.22),
}
"""What happened in the same games with the random policy: what each number is called, and its value."""

DURATION_BOUNDS: Final[Mapping[str, tuple[float, float]]] = {
    "random": (53.0 * 0.9, 58.0 * 1.1),
    "hold": (29.2 * 0.9, 29.2 * 1.1),
    "hand": (141 * 0.85, 171 * 1.15),
}
"""Where the mean of 3v2 must lie: sessions on the real server gave 53 to 58, 29.2, and 141 to 171."""

_SEEDS: Final = 0.05
LEARNING_BOUNDS: Final[Mapping[int, tuple[float, float]]] = {
    1000: (70.0 * (1 - _SEEDS), 80.0 * (1 + _SEEDS)),
    2000: (90.0, math.inf),
    6000: (120.0 * (1 - _SEEDS), 150.0 * (1 + _SEEDS)),
}
"""Mean duration of 3v2 over the block of episodes that ends there (6000: all blocks from 5000 on): what
single runs of the benchmark gave, and a twentieth more on either side, as seeds differ."""

SPEED_BOUNDS: Final[Mapping[str, float]] = {"3v2": 30_000.0, "4v3": 15_000.0}
"""Game cycles per second of CPU time and core; the real server and its players manage about 480."""

SETTINGS: Final = (
    KeepawaySetting(PHYSICS),
    *(KeepawaySetting(DURATIONS, *game, policy, N_EPISODES) for game in GAMES[:2] for policy in POLICIES),
    *(
        KeepawaySetting(LEARNING, *GAMES[0], method, N_LEARNING, run=run)
        for method in METHODS
        for run in range(N_RUNS)
    ),
    *(KeepawaySetting(SPEED, *game, policy, 500) for game in GAMES for policy in ("random", "hand")),
)
SMOKE: Final = (
    KeepawaySetting(PHYSICS),
    *(KeepawaySetting(DURATIONS, *GAMES[0], policy, 2) for policy in POLICIES),
    *(KeepawaySetting(LEARNING, *GAMES[0], method, 4, 2, run) for method in METHODS for run in range(2)),
    KeepawaySetting(SPEED, *GAMES[0], "random", 1),
)
