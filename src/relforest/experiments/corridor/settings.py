"""The conditions, and the rewards that they must reach."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final

from relforest.rl.settings import FeatureMode


@final
@dataclass(frozen=True, slots=True)
class CorridorSetting:
    """One run under one condition.

    Parameters
    ----------
    condition : str
        A key of `CONDITIONS`.
    run : int
        Number of the run.
    runs : int
        Runs under this condition.
    iterations : int
        Iterations of each run.
    episodes : int
        Episodes of training experience per iteration, and of test experience after each.
    features : {"densities+bits", "bits"}
        What a tree contributes to the features.
    wrapper : bool
        Whether trees must pass the test of section 6.3.
    """

    condition: str
    run: int
    runs: int
    iterations: int
    episodes: int
    features: FeatureMode
    wrapper: bool = True

    def __str__(self) -> str:
        """Return the title of the condition and the number of the run."""
        return f"{CONDITIONS[self.condition]}, run {self.run}"


CONDITIONS: Final[Mapping[str, str]] = {
    "500-densities": "500 episodes, densities and bits",
    "10-densities": "10 episodes, densities and bits",
    "10-bits": "10 episodes, bits only",
    "500-untested": "500 episodes, trees untested",
}
"""Condition -> its title; the order gives each condition its seed."""

OPTIMUM: Final = 8.69
"""Mean reward of the optimal policy; the source reports about 8.68."""

THRESHOLDS: Final[Mapping[tuple[str, int], float]] = {
    ("500-densities", 1): 8.5,
    ("500-densities", 3): 8.6,
    ("10-densities", 5): 8.3,
}
"""Mean test reward to be reached, by condition and iteration."""

N_RUNS: Final = 30

SETTINGS: Final = (
    *(CorridorSetting("500-densities", run, N_RUNS, 5, 500, "densities+bits") for run in range(N_RUNS)),
    *(CorridorSetting("10-densities", run, N_RUNS, 10, 10, "densities+bits") for run in range(N_RUNS)),
    *(CorridorSetting("10-bits", run, N_RUNS, 10, 10, "bits") for run in range(N_RUNS)),
    *(
        CorridorSetting("500-untested", run, N_RUNS, 1, 500, "densities+bits", wrapper=False)
        for run in range(N_RUNS)
    ),
)
SMOKE: Final = (
    *(CorridorSetting("500-densities", run, 2, 1, 12, "densities+bits") for run in range(2)),
    *(CorridorSetting("10-densities", run, 2, 1, 6, "densities+bits") for run in range(2)),
    *(CorridorSetting("10-bits", run, 2, 1, 6, "bits") for run in range(2)),
)
