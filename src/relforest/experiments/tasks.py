"""What an agent can learn, by its name on the command line, and how."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from pkgutil import resolve_name
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias, final

from relforest.rl.settings import RPISettings
from relforest.support.options import in_range, one_of
from relforest.trees.settings import TreeSettings

if TYPE_CHECKING:
    import gymnasium
    from matplotlib.figure import Figure

    from relforest.rl.practice import Practice

MethodName: TypeAlias = Literal[
    "smrf-rpi",
    "smrf-q",
    "cmac-sarsa",
    "cmac-sarsa-shared",
    "rbf-sarsa",
    "sarsa-on-smrf",
    "linear-q",
    "lspi",
    "trees-q",
    "boosting-q",
    "dqn",
    "deep-sets-q",
]
"""A key of `relforest.experiments.methods.METHODS`."""


@final
@dataclass(frozen=True, slots=True)
class Picture:
    """A picture of what a run has learned."""

    name: str  # name of its file
    source: str
    """The module and the function that turn the folder of a run and a new environment into the figure,
    imported when it is drawn."""

    def draw(self, folder: Path, env: gymnasium.Env[Any, Any]) -> Figure:
        """Draw what the run in a folder has learned."""
        function: Callable[[Path, gymnasium.Env[Any, Any]], Figure] = resolve_name(self.source)
        return function(folder, env)


@final
@dataclass(frozen=True, slots=True)
class Task:
    """A world and how it can be learned.

    Parameters
    ----------
    name : str
        As on the command line.
    world : str
        A key of `relforest.worlds.ENVIRONMENT_IDS`.
    options : mapping
        Options of the environment.
    training : mapping
        Options of the environment in training that differ from those in tests.
    explorers : pair of str, optional
        Policies of the world that act instead of uniformly random ones: in training, and in tests before
        anything is known.
    settings : RPISettings
        Options of SMRF-RPI.
    optimum : float, optional
        Mean reward per episode of an optimal policy, if known.
    pictures : mapping
        Each method that can learn the task -> its picture of what was learned, or None.
    """

    name: str
    world: str
    options: Mapping[str, Any] = field(default_factory=dict)
    training: Mapping[str, Any] = field(default_factory=dict)
    explorers: tuple[str, str] | None = None
    settings: RPISettings = field(default_factory=RPISettings)
    optimum: float | None = None
    pictures: Mapping[MethodName, Picture | None] = field(
        default_factory=lambda: {"smrf-rpi": None, "smrf-q": None}
    )

    def make(self, discount: float | None = None) -> gymnasium.Env[Any, Any]:
        """Return a new environment for tests, with a discount factor other than its own if one is given.

        Raises
        ------
        InputError
            If the discount is not between 0 and 1.
        """
        return self._made(self.options, discount)

    def practice(self, env: gymnasium.Env[Any, Any], discount: float | None = None) -> Practice:
        """Return how the task is practised, if `env` is where it is tested."""
        from relforest.rl.practice import Practice  # noqa: PLC0415

        training = self._made({**self.options, **self.training}, discount) if self.training else None
        if self.explorers is None:
            return Practice(training)
        where: Any = (training or env).unwrapped, env.unwrapped
        explorer, beginner = (world.policies[name] for world, name in zip(where, self.explorers, strict=True))
        return Practice(training, explorer, beginner)

    def _made(self, options: Mapping[str, Any], discount: float | None) -> gymnasium.Env[Any, Any]:
        # Importing these takes long, and most uses of a task do not need them.
        import gymnasium  # noqa: PLC0415

        from relforest.worlds import environment_id  # noqa: PLC0415

        # The checker would check every step of every episode; `relforest.testing` does that once.
        env: gymnasium.Env[Any, Any] = gymnasium.make(
            environment_id(self.world), disable_env_checker=True, **options
        )
        if discount is not None:
            vars(env.unwrapped)["discount"] = in_range("discount", discount, 0.0, 1.0)
        return env


_PICTURES: Final = "relforest.experiments"
# The exhaustive search of the source takes five to nine times as long where there are many objects.
_SCREENED: Final = RPISettings(tree=TreeSettings(search="screened"))


def _policy_map(function: str) -> Picture:
    return Picture("policy-map.png", f"{_PICTURES}.keepaway_picture.{function}")


_KEEPAWAY_PICTURES: Final[Mapping[MethodName, Picture]] = MappingProxyType(
    {
        "smrf-rpi": _policy_map("agent_policy_map"),
        "smrf-q": _policy_map("agent_policy_map"),
        "cmac-sarsa": _policy_map("team_policy_map"),
        "cmac-sarsa-shared": _policy_map("team_policy_map"),
        "rbf-sarsa": _policy_map("team_policy_map"),
        "sarsa-on-smrf": _policy_map("team_policy_map"),
        "linear-q": _policy_map("vector_policy_map"),
        "lspi": _policy_map("vector_policy_map"),
        "trees-q": _policy_map("vector_policy_map"),
        "boosting-q": _policy_map("vector_policy_map"),
        "dqn": _policy_map("vector_policy_map"),
        "deep-sets-q": _policy_map("vector_policy_map"),
    }
)


def _keepaway(name: str, keepers: int, takers: int, size: float) -> Task:
    options = {"keepers": keepers, "takers": takers, "size": size}
    return Task(name, "keepaway", options, settings=_SCREENED, pictures=_KEEPAWAY_PICTURES)


def _arch(name: str, training: Mapping[str, Any]) -> Task:
    # An arch counts when it stands at the end, even if nothing was left to say so.
    options, explorers = {"pays": "end"}, ("trainer", "random")
    return Task(name, "arch", options, training, explorers, _SCREENED)


TASKS: Final[Mapping[str, Task]] = MappingProxyType(
    {
        task.name: task
        for task in (
            Task(
                "corridor",
                "corridor",
                optimum=8.69,
                pictures={
                    "smrf-rpi": Picture("q-function.png", f"{_PICTURES}.corridor_picture.q_function_picture"),
                    "smrf-q": None,
                },
            ),
            _keepaway("keepaway", 3, 2, 20.0),
            _keepaway("keepaway-25", 3, 2, 25.0),
            _keepaway("keepaway-4v3", 4, 3, 25.0),
            _keepaway("keepaway-5v4", 5, 4, 30.0),
            _keepaway("keepaway-6v5", 6, 5, 35.0),
            Task("high-towers", "high-towers", explorers=("random", "random"), settings=_SCREENED),
            Task("color-grouping", "color-grouping", explorers=("random", "random"), settings=_SCREENED),
            Task(
                "color-grouping-rgb",
                "color-grouping",
                options={"distance": "rgb"},
                explorers=("random", "random"),
                settings=_SCREENED,
            ),
            _arch("arch", {}),
            _arch("arch-done", {"pays": "done", "sampler": "training"}),
        )
    }
)
"""Name of a task -> the task.

Keepaway on 20 m by 20 m, and 4 against 3 on 25 m by 25 m, are those of the source; 3 against 2 on 25 m by
25 m is that of Taylor and Stone (2007), "Cross-domain transfer for reinforcement learning". The source has no
larger teams: they get 5 m more for each further pair. The source practises arches as in ``arch-done``: only
what is claimed to be done pays in training, though tests pay for whatever stands at the end.
"""


def task_named(name: str) -> Task:
    """Return a task.

    Raises
    ------
    InputError
        If the name is unknown; the message lists the known ones.
    """
    return TASKS[one_of("task", name, tuple(TASKS))]
