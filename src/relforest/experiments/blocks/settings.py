"""What is dropped, lifted and played, and what the author's simulator gave."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final

from relforest.experiments.sheets import Estimate

SETTLE: Final = "settle"
LIFT: Final = "lift"
TOWERS: Final = "towers"
GROUPS: Final = "groups"
ARCHES: Final = "arches"
COLORS: Final = "colors"
OUTCOMES: Final = "outcomes"
SPEED: Final = "speed"

TASK_TITLES: Final[Mapping[str, str]] = {TOWERS: "high towers", GROUPS: "color grouping", ARCHES: "arch"}


@final
@dataclass(frozen=True, slots=True)
class BlocksSetting:
    """One measurement."""

    part: str  # SETTLE, LIFT, TOWERS, GROUPS, ARCHES, COLORS, OUTCOMES or SPEED
    condition: str  # which blocks, policy, colors or task
    count: int = 1  # drops, episodes, pairs of colors or scenes
    chunk: int = 0  # number of this share of the measurement; shares are computed side by side

    def __str__(self) -> str:
        """Return the part, the condition and the number of the share."""
        return f"{self.part}, {self.condition} {self.chunk}"


RANDOM_BLOCKS: Final = "5 random blocks"
ARCH_BLOCKS: Final = "3 arch blocks"
SCENARIOS: Final = (RANDOM_BLOCKS, ARCH_BLOCKS)

RANDOM: Final = "random"
LARGE_FIRST: Final = "large-first"
SMALL_FIRST: Final = "small-first"
MANUAL: Final = "manual"
MANUAL_RGB: Final = "manual, RGB"
RANDOM_RGB: Final = "random, RGB"
CAREFUL: Final = "careful"
TRAINER: Final = "trainer"
POLICIES: Final[Mapping[str, tuple[str, ...]]] = {
    TOWERS: (RANDOM, SMALL_FIRST, LARGE_FIRST),
    GROUPS: (RANDOM, MANUAL, RANDOM_RGB, MANUAL_RGB),
    ARCHES: (RANDOM, TRAINER, CAREFUL),
}
"""Task -> the policies that play it, from the weakest to the best."""

UNIFORM_RGB: Final = "uniform RGB"
BLOCK_COLORS: Final = "colors of blocks"

BALANCE: Final = "balance scale, 1 to 4 weights"
BALANCE_LARGE: Final = "balance scale, 5 to 6 weights"
DROP_ON: Final = "dropOn, 0 to 3 interferers"
DROP_ON_LARGE: Final = "dropOn, 4 to 5 interferers"
OUTCOME_TASKS: Final[Mapping[str, tuple[int, int]]] = {
    BALANCE: (1, 4),
    BALANCE_LARGE: (5, 6),
    DROP_ON: (0, 3),
    DROP_ON_LARGE: (4, 5),
}
"""Name of an outcome task -> its smallest and largest number of weights or interferers."""

BALANCE_TASKS: Final = (BALANCE, BALANCE_LARGE)

AUTHOR: Final = "author's simulator"
PLAIN: Final = "a plain Box2D 2.3 port"

SETTLE_REFERENCE: Final[Mapping[tuple[str, str], Mapping[str, float]]] = {
    (RANDOM_BLOCKS, AUTHOR): {
        "n": 400,
        "mean": 249,
        "median": 230,
        "p90": 392,
        "max": 859,
        "over": 10 / 400,
        "height": 3.278,
    },
    (RANDOM_BLOCKS, PLAIN): {
        "n": 400,
        "mean": 230,
        "median": 206,
        "p90": 367,
        "max": 878,
        "over": 8 / 400,
        "height": 3.297,
    },
    (ARCH_BLOCKS, AUTHOR): {
        "n": 200,
        "mean": 259,
        "median": 242,
        "p90": 383,
        "max": 579,
        "over": 3 / 200,
        "height": 2.638,
    },
    (ARCH_BLOCKS, PLAIN): {
        "n": 400,
        "mean": 259,
        "median": 247,
        "p90": 374,
        "max": 673,
        "over": 5 / 400,
        "height": 2.681,
    },
}
"""Steps until dropped blocks lie still, the share above 500, and the mean height of their centres then."""

LIFT_REFERENCE: Final[Mapping[str, tuple[int, int]]] = {
    "0.5 x 0.5": (57, 58),
    "5 x 0.5": (153, 153),
    "2.75 x 2.75": (245, 245),
    "4 x 2": (252, 252),
    "2 x 4": (248, 248),
    "5 x 5": (410, 401),
}
"""Half sizes of a block that is lifted alone -> steps of its lift to a height of 20 in the author's simulator
and in a plain port to Box2D 2.3."""

OPTION_REFERENCE: Final[Mapping[tuple[str, str, str], tuple[float, float]]] = {
    (TOWERS, RANDOM, "put_duration"): (8.98, 8.63),
    (TOWERS, RANDOM, "put_success"): (0.82, 0.81),
    (TOWERS, RANDOM, "rotate_duration"): (7.63, 7.54),
    (TOWERS, RANDOM, "rotate_success"): (0.88, 0.89),
    (TOWERS, RANDOM, "episode_steps"): (4600.0, 4390.0),
    (TOWERS, RANDOM, "score_before"): (3.50, 3.54),
    (GROUPS, RANDOM, "isolate_covered_duration"): (7.5, math.nan),
    (GROUPS, RANDOM, "isolate_free_duration"): (1.04, math.nan),
    (ARCHES, RANDOM, "move_duration"): (8.10, 8.03),
    (ARCHES, RANDOM, "move_success"): (0.80, 0.81),
    (ARCHES, RANDOM, "rotate_duration"): (8.29, 8.13),
    (ARCHES, RANDOM, "rotate_success"): (0.94, 0.96),
    (TOWERS, SMALL_FIRST, "put_success"): (0.70, 0.69),
    (TOWERS, LARGE_FIRST, "put_success"): (0.74, 0.80),
}
"""Part, policy and measure -> its mean in the author's simulator and in the plain port; NaN = unknown."""

TOTAL_REFERENCE: Final[Mapping[tuple[str, str], tuple[Estimate, Estimate]]] = {
    (TOWERS, RANDOM): (Estimate(0.96, 0.39), Estimate(1.07, 0.27)),
    (TOWERS, SMALL_FIRST): (Estimate(5.4, 1.0), Estimate(5.5, 0.6)),
    (TOWERS, LARGE_FIRST): (Estimate(8.9, 1.8), Estimate(7.9, 1.0)),
}
"""Totals in the author's simulator and in the plain port, with 95 % intervals."""

COLOR_REFERENCE: Final[Mapping[str, Mapping[str, float]]] = {
    UNIFORM_RGB: {"lab_q25": 28.1, "lab_q50": 43.0, "lab_max": 114.6, "lab_near": 0.28, "rgb_q25": 0.479}
    | {"rgb_near": 0.28},
    BLOCK_COLORS: {"lab_q25": 25.0, "lab_q50": 36.8, "lab_max": 115.0, "lab_near": 0.355, "rgb_q25": 0.357}
    | {"rgb_near": 0.42},
}
"""Distances of random pairs of colors: CIEDE2000 quartile, median, maximum and share up to 30; the same
quartile and the share up to 0.5 of distances in RGB."""

SETTLE_TOLERANCE: Final[Mapping[str, float]] = {"mean": 0.10, "median": 0.15}
LIFT_TOLERANCE: Final = 0.05
BOUNDS: Final[Mapping[tuple[str, str, str], tuple[float, float]]] = {
    (TOWERS, RANDOM, "put_duration"): (8.98 * 0.92, 8.98 * 1.08),
    (TOWERS, RANDOM, "put_success"): (0.78, 0.84),
    (TOWERS, RANDOM, "rotate_success"): (0.84, 0.92),
    # The author's simulator was asked for 21 and 6 of these: two and a half standard errors.
    (GROUPS, RANDOM, "isolate_free_duration"): (0.94, 1.14),
    (GROUPS, RANDOM, "isolate_covered_duration"): (5.0, 10.0),
    (TOWERS, RANDOM, "total"): (0.8, 1.2),
}
"""Part, policy and measure -> where its mean must lie."""

LAB_TOLERANCE: Final = 1.0
SHARE_TOLERANCE: Final = 0.02
N_EPISODES: Final = 1000
N_PAIRS: Final = 200_000
_SHARE: Final = 250
# So many times more where 1000 values would leave open whether their mean is where it must be.
_MORE_DROPS: Final = 8
_MORE_RANDOM: Final = 4
_N_SPEED: Final = 100


def _shares(part: str, condition: str, count: int) -> tuple[BlocksSetting, ...]:
    """Return a measurement in parts that are computed side by side."""
    size = min(_SHARE, count)
    return tuple(BlocksSetting(part, condition, size, chunk) for chunk in range(count // size))


def _settings(episodes: int, pairs: int, speed: int) -> tuple[BlocksSetting, ...]:
    played = {(part, policy): episodes for part, policies in POLICIES.items() for policy in policies}
    played[TOWERS, RANDOM] *= _MORE_RANDOM
    return (
        *(share for scenario in SCENARIOS for share in _shares(SETTLE, scenario, _MORE_DROPS * episodes)),
        *(BlocksSetting(LIFT, size) for size in LIFT_REFERENCE),
        *(share for (part, policy), count in played.items() for share in _shares(part, policy, count)),
        *(share for task in OUTCOME_TASKS for share in _shares(OUTCOMES, task, episodes)),
        *(BlocksSetting(COLORS, sampling, pairs) for sampling in COLOR_REFERENCE),
        *(BlocksSetting(SPEED, policy, speed) for policy in POLICIES[TOWERS]),
    )


SETTINGS: Final = _settings(N_EPISODES, N_PAIRS, _N_SPEED)
SMOKE: Final = _settings(3, 1000, 1)
