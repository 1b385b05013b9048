"""The learners and hand-made policies of each task, and what the better learner must reach."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final, final

from relforest.experiments.tasks import MethodName

KEEPAWAY: Final = "keepaway"
TOWERS: Final = "high-towers"
COLORS: Final = "color-grouping"
RGB: Final = "color-grouping-rgb"
ARCH: Final = "arch"
DONE: Final = "arch-done"


@final
@dataclass(frozen=True, slots=True)
class LearningSetting:
    """One run of a learner, or one hand-made policy.

    Parameters
    ----------
    task : str
        Where it learns, a key of `relforest.experiments.tasks.TASKS`.
    condition : str
        A key of `LEARNERS`, or the name of a policy of the world.
    run : int
        Number of the run.
    runs : int
        How many there are.
    episodes : int
        Training episodes per iteration; 0 for a hand-made policy.
    iterations : int
    tests : int
        Test episodes after each iteration; in the end, five times as many, which begin alike for all.
    others : int
        How many of `LARGER` are played too in the end, without any more learning.
    """

    task: str
    condition: str
    run: int
    runs: int
    episodes: int
    iterations: int
    tests: int
    others: int = 0

    def __str__(self) -> str:
        """Return condition, task and number."""
        return f"{self.condition} in {self.task}, run {self.run}"

    def longer(self, iterations: int) -> tuple[LearningSetting, ...]:
        """Return the setting with other iterations, unless its meaning depends on them."""
        is_fixed = not self.episodes or (self.task, self.condition) in FIXED
        return (self if is_fixed else replace(self, iterations=iterations),)

    def larger(self, episodes: int) -> tuple[LearningSetting, ...]:
        """Return the setting with batches of another size, if it learns anything."""
        return (replace(self, episodes=episodes) if self.episodes else self,)


@final
@dataclass(frozen=True, slots=True)
class LearnerChoice:
    """A learner under one condition.

    Parameters
    ----------
    method : str
        A key of `relforest.experiments.methods.METHODS`.
    discount : float, optional
        Discount factor of the world.
    source : str, optional
        The condition of the run that it begins with, which has the same number.
    rpi : mapping
        Options of SMRF-RPI that differ from those of the task.
    """

    method: MethodName
    discount: float | None = None
    source: str | None = None
    rpi: Mapping[str, Any] = field(default_factory=dict)


_ONE_ROUND: Final = {"max_rounds": 1}


LEARNERS: Final[Mapping[str, LearnerChoice]] = {
    "smrf-q": LearnerChoice("smrf-q"),
    "cmac-sarsa": LearnerChoice("cmac-sarsa"),
    "rbf-sarsa": LearnerChoice("rbf-sarsa"),
    "smrf-rpi-50": LearnerChoice("smrf-rpi"),
    "smrf-rpi-500": LearnerChoice("smrf-rpi"),
    "smrf-rpi-50-discount-.99": LearnerChoice("smrf-rpi", 0.99),
    "smrf-rpi-500-discount-.99": LearnerChoice("smrf-rpi", 0.99),
    "linear-q": LearnerChoice("linear-q"),
    "lspi": LearnerChoice("lspi"),
    "trees-q": LearnerChoice("trees-q"),
    "boosting-q": LearnerChoice("boosting-q"),
    "dqn": LearnerChoice("dqn"),
    "deep-sets-q": LearnerChoice("deep-sets-q"),
    "sarsa-on-smrf": LearnerChoice("sarsa-on-smrf", source="smrf-rpi-500"),
    "smrf-rpi-500-once": LearnerChoice("smrf-rpi"),
    "smrf-rpi-500-long": LearnerChoice("smrf-rpi"),
    "smrf-rpi-500-single": LearnerChoice("smrf-rpi", rpi=_ONE_ROUND),
    "smrf-rpi-500-single-tree": LearnerChoice("smrf-rpi", rpi={**_ONE_ROUND, "trees_per_label": 1}),
    "smrf-rpi-50-single": LearnerChoice("smrf-rpi", rpi=_ONE_ROUND),
    "smrf-rpi-500-rgb": LearnerChoice("smrf-rpi"),
    "cmac-sarsa-shared-50": LearnerChoice("cmac-sarsa-shared"),
    "cmac-sarsa-shared-500": LearnerChoice("cmac-sarsa-shared"),
    "cmac-sarsa-shared-4v3": LearnerChoice("cmac-sarsa-shared"),
}
"""Condition -> what learns; the order gives each condition its seed.

Those of SMRF-RPI and of Sarsa with shared experience that have a number are the source's: so many episodes in
a batch; *once* is a single batch, *long* ten; *single* a single round of representation and policy learning
for every batch, *single-tree* with a single tree per label.
"""

FIXED: Final = ((KEEPAWAY, "smrf-rpi-500"), (KEEPAWAY, "smrf-rpi-500-once"))
"""Conditions that stand for a number of batches, whatever the length of the others."""

OURS: Final = "smrf-q"
SARSA: Final = "cmac-sarsa"
LINEAR: Final = "linear-q"
LARGER: Final = ("keepaway-4v3", "keepaway-5v4", "keepaway-6v5")
_OTHERS: Final = {OURS: len(LARGER), "smrf-rpi-500-once": 1, "smrf-rpi-500-long": 1}
HAND: Final[Mapping[str, str]] = {KEEPAWAY: "hand", TOWERS: "large-first", COLORS: "manual", ARCH: "trainer"}
"""Task -> the policy to beat."""

BUDGETS: Final = (5, 10, 20, 30, 40)
"""Numbers of questions with which the policies of `OURS` in keepaway are also tested in the end."""

N_RUNS: Final = 10
_TESTS: Final = 200
_FEWER: Final = 100
_BATCH: Final = 100


def _runs(
    task: str, condition: str, episodes: int, iterations: int, *, runs: int = N_RUNS, tests: int = _TESTS
) -> tuple[LearningSetting, ...]:
    others = _OTHERS.get(condition, 0) if task == KEEPAWAY else 0
    return tuple(
        LearningSetting(task, condition, run, runs, episodes, iterations, tests, others)
        for run in range(runs)
    )


def _hand_made(task: str, *policies: str, tests: int) -> tuple[LearningSetting, ...]:
    others = len(LARGER) if task == KEEPAWAY else 0
    return tuple(
        LearningSetting(task, name, run, N_RUNS, 0, 0, tests, others)
        for name in policies
        for run in range(N_RUNS)
    )


SETTINGS: Final[Mapping[str, tuple[LearningSetting, ...]]] = {
    KEEPAWAY: (
        *_hand_made(KEEPAWAY, "hand", "random", tests=_TESTS),
        *_runs(KEEPAWAY, OURS, _BATCH, 10),
        *_runs(KEEPAWAY, SARSA, 1000, 6),
        *_runs(KEEPAWAY, "rbf-sarsa", 1000, 6),
        *(
            setting
            for size, count in ((50, 20), (500, 2))
            for discount in ("", "-discount-.99")
            for setting in _runs(KEEPAWAY, f"smrf-rpi-{size}{discount}", size, count, runs=5)
        ),
        *_runs(KEEPAWAY, "sarsa-on-smrf", 1000, 6, runs=5),
        *(
            setting
            for name in (LINEAR, "lspi", "trees-q", "boosting-q")
            for setting in _runs(KEEPAWAY, name, _BATCH, 10)
        ),
        *_runs(KEEPAWAY, "dqn", _BATCH, 10, runs=5),
        *_runs(KEEPAWAY, "deep-sets-q", _BATCH, 10, runs=5),
        *_runs(KEEPAWAY, "cmac-sarsa-shared-50", 50, 10),
        *_runs(KEEPAWAY, "cmac-sarsa-shared-500", 500, 10),
        *_runs(LARGER[0], "cmac-sarsa-shared-4v3", 500, 10),
        *_runs(KEEPAWAY, "smrf-rpi-500-once", 500, 1),
        *_runs(KEEPAWAY, "smrf-rpi-50-single", 50, 10),
        *(
            setting
            for length in ("long", "single", "single-tree")
            for setting in _runs(KEEPAWAY, f"smrf-rpi-500-{length}", 500, 10)
        ),
    ),
    TOWERS: (
        *_hand_made(TOWERS, "large-first", "small-first", "random", tests=_FEWER),
        *_runs(TOWERS, OURS, _BATCH, 10, tests=_FEWER),
        *_runs(TOWERS, "smrf-rpi-500", 500, 10, tests=_FEWER),
    ),
    COLORS: (
        *_hand_made(COLORS, "manual", "random", tests=_FEWER),
        *_hand_made(RGB, "manual", tests=_FEWER),
        *_runs(COLORS, OURS, _BATCH, 20, tests=_FEWER),
        *_runs(COLORS, "smrf-rpi-500", 500, 10, tests=_FEWER),
        *_runs(RGB, "smrf-rpi-500-rgb", 500, 10, tests=_FEWER),
    ),
    ARCH: (
        *_hand_made(ARCH, "trainer", "careful", "random", tests=_FEWER),
        *_runs(ARCH, OURS, 500, 6, runs=5, tests=_FEWER),
        *_runs(DONE, "smrf-rpi-500", 500, 4, runs=5, tests=_FEWER),
    ),
}
SMOKE: Final[Mapping[str, tuple[LearningSetting, ...]]] = {
    task: tuple(
        LearningSetting(task, name, run, 2, episodes, iterations, 5, int(task == KEEPAWAY))
        for name, episodes, iterations in ((HAND[task], 0, 0), (OURS, 20, 2))
        for run in range(2)
    )
    for task in SETTINGS
}

GOALS: Final[Mapping[str, Mapping[int, float]]] = {
    KEEPAWAY: {500: 172.0, 1000: 182.0},
    TOWERS: {100: 5.7, 500: 8.0},
    COLORS: {500: 0.83},
    ARCH: {3000: 31.0},
}
"""Task -> training episodes -> the mean reward that `OURS` must reach."""
LEAST: Final[Mapping[str, tuple[int, float]]] = {KEEPAWAY: (500, 155.0)}
"""Task -> training episodes, and what every run must reach by then."""
TRANSFER: Final[Mapping[str, float]] = {"keepaway-4v3": 95.0}
"""Task -> what must be reached there without learning."""
STANDING: Final = 0.53
"""Share of the test episodes in the arch task that must end with an arch."""
