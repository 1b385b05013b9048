"""What ``relforest learn`` is asked to do, checked once."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, final

from relforest.experiments.methods import METHODS, Work
from relforest.experiments.tasks import MethodName, Task, task_named
from relforest.rl.baselines.settings import SarsaSettings
from relforest.rl.fitted.settings import QSettings, Source
from relforest.rl.settings import FEATURE_MODES, FeatureMode, RPISettings
from relforest.runs.manifest import Manifest
from relforest.support.errors import InputError
from relforest.support.options import at_least, in_range, one_of
from relforest.support.rng import seed_sequence, stream

if TYPE_CHECKING:
    import gymnasium

    from relforest.runs.learner import Learner

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
    features : {"densities+bits", "bits", "probability"}, optional
        What a tree contributes to the features, for SMRF-RPI. Default: as in `rpi`.
    method : str
        How to learn, see `relforest.experiments.methods.METHODS`.
    rpi : RPISettings, optional
        Options of SMRF-RPI. Default: those of the task.
    discount : float, optional
        Discount factor of the world, 0 to 1. Default: its own for SMRF-RPI, `Q_DISCOUNT` for fitted Q.
    sarsa : SarsaSettings, optional
        Options of Sarsa. Default: those of the keepaway benchmark.
    q : QSettings, optional
        Options of smrf-q.
    source : Source, optional
        A run to begin with: of smrf-q for smrf-q, of smrf-rpi for Sarsa on its trees.

    Raises
    ------
    InputError
        If an option is out of its range or belongs to another method, the task cannot be learned with this
        method, or the package that it needs is not installed.
    """

    task: str
    episodes: int = 500
    iterations: int = 5
    runs: int = 1
    seed: int = 0
    test_episodes: int | None = None
    features: FeatureMode | None = None
    method: MethodName = "smrf-rpi"
    rpi: RPISettings | None = None
    discount: float | None = None
    sarsa: SarsaSettings | None = None
    q: QSettings | None = None
    source: Source | None = None

    def __post_init__(self) -> None:
        task_named(self.task)
        for name in ("episodes", "iterations", "runs"):
            at_least(name, getattr(self, name), 1)
        at_least("seed", self.seed, 0)
        if self.test_episodes is not None:
            at_least("test_episodes", self.test_episodes, 1)
        if self.features is not None:
            one_of("features", self.features, FEATURE_MODES)
        if self.discount is not None:
            in_range("discount", self.discount, 0.0, 1.0)
        kinds = {"rpi": RPISettings, "sarsa": SarsaSettings, "q": QSettings, "source": Source}
        for name, expected in kinds.items():
            if not isinstance(getattr(self, name), expected | None):
                raise InputError(f"{name} must be {expected.__name__}(...), got {getattr(self, name)!r}")
        one_of("method", self.method, tuple(METHODS))
        one_of(f"the method for {self.task}", self.method, tuple(self.definition.pictures))
        if (chosen := METHODS[self.method]).is_missing:
            raise InputError(
                f"{self.method} learns with {chosen.needs}, which is not installed: "
                "install the extra 'relforest[bench]'"
            )
        if chosen.needs_source and (self.source is None or self.source.what != "policy"):
            raise InputError(f"{self.method} needs the trees of a run of smrf-rpi: pass it as source")
        every = {name for method in METHODS.values() for name in method.options}
        for name in sorted(every - self.options.keys()):
            if getattr(self, name) is not None:
                raise InputError(f"{name} is not an option of {self.method}: leave it out")

    @property
    def definition(self) -> Task:
        """The task itself."""
        return task_named(self.task)

    @property
    def options(self) -> dict[str, Any]:
        """The options that belong to the method."""
        return {name: getattr(self, name) for name in METHODS[self.method].options}

    @property
    def tests(self) -> int:
        """Test episodes after each iteration."""
        return self.episodes if self.test_episodes is None else self.test_episodes

    def make(self) -> gymnasium.Env[Any, Any]:
        """Return a new environment."""
        return self.definition.make(self.discount)

    def learner(self, run: int, *, n_jobs: int = 1) -> Learner[Any]:
        """Return what learns one of the runs; `n_jobs` candidate trees at the same time."""
        seed, episodes = stream(seed_sequence(self.seed), run), (self.episodes, self.tests)
        return METHODS[self.method].make(Work(self.definition, self.options, episodes, seed, n_jobs))

    def folders(self, out: Path) -> list[Path]:
        """Return the folder of each run: `out` itself for a single one, else ``out/run-00`` and so on."""
        return [out] if self.runs == 1 else [out / f"run-{run:02d}" for run in range(self.runs)]

    def manifest(self, run: int | None = None) -> Manifest:
        """Return what the folder of one of several runs, or of all (None), depends on."""
        content: dict[str, Any] = {
            "task": self.task,
            "method": self.method,
            "episodes": self.episodes,
            "test_episodes": self.tests,
            "iterations": self.iterations,
            "runs": self.runs,
            "seed": self.seed,
            **METHODS[self.method].manifest(self.definition, self.options),
        }
        if run is not None and self.runs > 1:
            content["run"] = run
        return Manifest(RUN, FORMAT, content, growing="iterations")
