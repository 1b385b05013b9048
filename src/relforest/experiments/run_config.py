"""What ``relforest learn`` is asked to do, checked once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, final

from relforest.experiments.folders import Identity
from relforest.experiments.tasks import METHODS, Method, Task, task_named
from relforest.rl.features import FEATURE_MODES, FeatureMode
from relforest.rl.settings import RPISettings
from relforest.support.options import at_least, one_of

RUN: Final = "run.json"
FORMAT: Final = "relforest-run"


@final
@dataclass(frozen=True, slots=True)
class RunConfig:
    """One run of a learner, or several that differ only in their random numbers.

    Parameters
    ----------
    task : str
        A key of `relforest.experiments.tasks.TASKS`.
    episodes : int
        Episodes of training experience per iteration, at least 1.
    iterations : int
        Iterations of each run, at least 1.
    runs : int
        Independent runs, at least 1.
    seed : int
        At least 0. Run ``k`` uses stream ``k`` of it, so one run is the first of many with the same seed.
    test_episodes : int, optional
        Test episodes after each iteration. Default: as many as `episodes`.
    features : {"densities+bits", "bits", "probability"}
        What a tree contributes to the features, for SMRF-RPI.
    method : {"smrf-rpi", "cmac-sarsa", "cmac-sarsa-shared"}
        How to learn, see `relforest.experiments.tasks.METHODS`.

    Raises
    ------
    InputError
        If an option is out of its range, or the task cannot be learned with this method.
    """

    task: str
    episodes: int = 500
    iterations: int = 5
    runs: int = 1
    seed: int = 0
    test_episodes: int | None = None
    features: FeatureMode = "densities+bits"
    method: Method = "smrf-rpi"

    def __post_init__(self) -> None:
        task_named(self.task)
        for name in ("episodes", "iterations", "runs"):
            at_least(name, getattr(self, name), 1)
        at_least("seed", self.seed, 0)
        if self.test_episodes is not None:
            at_least("test_episodes", self.test_episodes, 1)
        one_of("features", self.features, FEATURE_MODES)
        one_of("method", self.method, METHODS)
        one_of(f"the method for {self.task}", self.method, tuple(self.definition.pictures))

    @property
    def definition(self) -> Task:
        """The task itself."""
        return task_named(self.task)

    @property
    def is_shared(self) -> bool:
        """Whether all agents of a team learn from everyone's experience."""
        return self.method == "cmac-sarsa-shared"

    @property
    def settings(self) -> RPISettings:
        """Options of the learner: those of the task, with the features asked for."""
        return replace(self.definition.settings, features=self.features)

    def folders(self, out: Path) -> list[Path]:
        """Return the folder of each run: `out` itself for a single one, else ``out/run-00`` and so on."""
        return [out] if self.runs == 1 else [out / f"run-{run:02d}" for run in range(self.runs)]

    def identity(self, run: int | None = None) -> Identity:
        """Return what the folder of one of several runs, or of all (None), depends on."""
        content: dict[str, Any] = {
            "task": self.task,
            "method": self.method,
            "episodes": self.episodes,
            "test_episodes": self.episodes if self.test_episodes is None else self.test_episodes,
            "iterations": self.iterations,
            "runs": self.runs,
            "seed": self.seed,
        }
        if self.method == "smrf-rpi":
            settings = self.settings.to_dict()
            del settings["features"]
            content |= {"features": self.features, "settings": settings}
        if run is not None and self.runs > 1:
            content["run"] = run
        return Identity(RUN, FORMAT, content, growing="iterations")
