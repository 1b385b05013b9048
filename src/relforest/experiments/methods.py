"""How an agent can learn: the methods of ``relforest learn``, a row each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from importlib.util import find_spec
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeAlias, final

from relforest.experiments.tasks import MethodName, Task
from relforest.rl.baselines.settings import SarsaSettings
from relforest.rl.fitted.settings import Q_DISCOUNT, QSettings, Source

if TYPE_CHECKING:
    import numpy as np

    from relforest.rl.baselines.tile_coding import TileKind
    from relforest.rl.settings import RPISettings
    from relforest.runs.learner import Learner

Options: TypeAlias = Mapping[str, Any]
"""The options of `relforest.experiments.run_config.RunConfig` that belong to a method; None = the default."""


class Work(NamedTuple):
    """What a learner is made for."""

    task: Task
    options: Options
    episodes: tuple[int, int]  # of training and of tests, per iteration
    seed: np.random.SeedSequence  # of the run
    n_jobs: int  # threads


@final
@dataclass(frozen=True, slots=True)
class Method:
    """A learner: everything that the rest of ``relforest learn`` must know of it.

    The functions are named by module and function and imported when they are called.
    """

    title: str  # its name in messages
    settings: str | None
    """Where `relforest.experiments.run_config.RunConfig` and the command line have its settings."""
    others: tuple[str, ...]  # further options of `RunConfig` that belong to it
    make: Callable[[Work], Learner[Any]]
    manifest: Callable[[Task, Options], dict[str, Any]]
    """Turns a task and options into what ``run.json`` says of them."""
    report: str | None
    """The function that tells what the folder of a run holds. Without one, there are only rewards to tell."""
    policy: str  # the function that turns the folder of a run and an environment into a policy
    mark: str
    """The entry of ``checkpoint.json`` that tells its runs from those of learners with another `policy`."""
    needs: str | None = None  # the package that it learns with and that the extra ``bench`` installs
    needs_source: bool = False  # whether it must begin with another run

    @property
    def options(self) -> tuple[str, ...]:
        """The options of `RunConfig` that belong to it."""
        return self.others if self.settings is None else (self.settings, *self.others)

    @property
    def is_missing(self) -> bool:
        """Whether the package that it needs is not installed."""
        return self.needs is not None and find_spec(self.needs) is None


# Importing learners takes long, and checking options does not need them.
# ruff: noqa: PLC0415


def _rpi_learner(work: Work) -> Learner[Any]:
    from relforest.rl.learner import RPILearner

    task, discount = work.task, work.options["discount"]
    env, settings = task.make(discount), _rpi_settings(task, work.options)
    return RPILearner(env, settings, work.seed, *work.episodes, work.n_jobs, task.practice(env, discount))


def _rpi_manifest(task: Task, options: Options) -> dict[str, Any]:
    settings = _rpi_settings(task, options).to_dict()
    # Older runs name no discount.
    discount = {} if options["discount"] is None else {"discount": float(options["discount"])}
    return {"features": settings.pop("features"), "settings": settings, **discount}


def _rpi_settings(task: Task, options: Options) -> RPISettings:
    settings: RPISettings = options["rpi"] or task.settings
    return replace(settings, features=options["features"] or settings.features)


def _q_learner(work: Work) -> Learner[Any]:
    from relforest.rl.fitted.learner import QLearner

    options, discount = work.options, _q_discount(work.options)
    env, settings = work.task.make(discount), options["q"] or QSettings()
    practice = work.task.practice(env, discount)
    return QLearner(env, settings, work.seed, *work.episodes, work.n_jobs, options["source"], practice)


def _q_manifest(task: Task, options: Options) -> dict[str, Any]:  # noqa: ARG001 - of every learner
    settings = (options["q"] or QSettings()).to_dict()
    return {"settings": settings, "discount": _q_discount(options), **_begun(options)}


def _begun(options: Options) -> dict[str, str]:
    source: Source | None = options.get("source")
    return {} if source is None else source.to_dict()


def _q_discount(options: Options) -> float:
    return Q_DISCOUNT if options["discount"] is None else float(options["discount"])


def _sarsa_learner(work: Work, *, shared: bool, kind: TileKind) -> Learner[Any]:
    from relforest.experiments.sarsa import SarsaLearner
    from relforest.worlds.keepaway.server.options import KeepawayOptions

    rules, settings = KeepawayOptions(**work.task.options), work.options["sarsa"] or SarsaSettings()
    source: Source | None = work.options.get("source")
    trees = None if source is None else source.folder
    return SarsaLearner(rules, settings, shared, work.seed, *work.episodes, kind, trees)


def _sarsa_manifest(task: Task, options: Options) -> dict[str, Any]:  # noqa: ARG001 - of every learner
    # Older runs name no options of Sarsa.
    sarsa: SarsaSettings | None = options["sarsa"]
    settings = {} if sarsa in (None, SarsaSettings()) else {"sarsa": sarsa.to_dict()}
    return settings | _begun(options)


def _sarsa(*others: str, shared: bool = False, kind: TileKind = "tiles") -> Method:
    return Method(
        "Sarsa",
        "sarsa",
        others,
        partial(_sarsa_learner, shared=shared, kind=kind),
        _sarsa_manifest,
        None,
        "relforest.experiments.learned_policies.team_policy",
        "team",
    )


def _vector_learner(work: Work, *, method: MethodName) -> Learner[Any]:
    from relforest.experiments.vectors import vector_learner

    return vector_learner(method, work.task.make(_q_discount(work.options)), work.seed, work.episodes)


def _vector_manifest(task: Task, options: Options) -> dict[str, Any]:  # noqa: ARG001 - of every learner
    return {"discount": _q_discount(options)}


def _vectors(method: MethodName, needs: str | None = None) -> Method:
    return Method(
        method,
        None,
        ("discount",),
        partial(_vector_learner, method=method),
        _vector_manifest,
        None,
        "relforest.experiments.learned_policies.vector_policy",
        "vectors",
        needs,
    )


METHODS: Final[Mapping[MethodName, Method]] = MappingProxyType(
    {
        "smrf-rpi": Method(
            "SMRF-RPI",
            "rpi",
            ("features", "discount"),
            _rpi_learner,
            _rpi_manifest,
            "relforest.reports.run_report.run_report",
            "relforest.experiments.learned_policies.agent_policy",
            "policy",
        ),
        "smrf-q": Method(
            "smrf-q",
            "q",
            ("discount", "source"),
            _q_learner,
            _q_manifest,
            "relforest.reports.run_report.run_report",
            "relforest.experiments.learned_policies.agent_policy",
            "fitted",
        ),
        "cmac-sarsa": _sarsa(),
        "cmac-sarsa-shared": _sarsa(shared=True),
        "rbf-sarsa": _sarsa(kind="bells"),
        "sarsa-on-smrf": replace(_sarsa("source"), needs_source=True),
        "linear-q": _vectors("linear-q"),
        "lspi": _vectors("lspi"),
        "trees-q": _vectors("trees-q"),
        "boosting-q": _vectors("boosting-q"),
        "dqn": _vectors("dqn", "torch"),
        "deep-sets-q": _vectors("deep-sets-q", "torch"),
    }
)
"""Name of a method -> SMRF-RPI; fitted Q on relational questions; Sarsa on the benchmark's tile coding, each
keeper alone or all together; Sarsa on radial basis functions, and on the trees of a run of SMRF-RPI; fitted Q
and LSPI on curves of the benchmark's state variables, fitted Q by trees and by boosting of them, and by
networks of the players as they are."""
