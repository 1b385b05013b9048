"""What an agent can be told to learn, by the name that the command line has."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Final, final

import gymnasium
from matplotlib.figure import Figure

from relforest.experiments.corridor_picture import q_function_figure
from relforest.rl.rpi import SMRFRPI
from relforest.rl.settings import RPISettings
from relforest.support.options import one_of
from relforest.worlds import environment_id


@final
@dataclass(frozen=True, slots=True)
class Task:
    """A world and how SMRF-RPI learns in it.

    Parameters
    ----------
    name : str
        As the command line has it.
    world : str
        A key of `relforest.worlds.ENVIRONMENT_IDS`.
    description : str
        One sentence.
    settings : RPISettings
        Options of the learner.
    optimum : float, optional
        Mean reward per episode of an optimal policy, where it is known.
    draw_values : callable, optional
        Draws what an agent has learned, where one picture can show it.
    """

    name: str
    world: str
    description: str
    settings: RPISettings = field(default_factory=RPISettings)
    optimum: float | None = None
    draw_values: Callable[[SMRFRPI], Figure] | None = None

    def make(self) -> gymnasium.Env[Any, Any]:
        """Return a new environment."""
        # The checker looks at every step of every episode; `relforest.testing` does that once.
        return gymnasium.make(environment_id(self.world), disable_env_checker=True)


TASKS: Final[Mapping[str, Task]] = MappingProxyType(
    {
        task.name: task
        for task in (
            Task(
                "corridor",
                "corridor",
                "Walk along a corridor whose two ends pay (Palmer (2015), section 7.3).",
                optimum=8.69,
                draw_values=q_function_figure,
            ),
        )
    }
)
"""Name of a task -> the task."""


def task_named(name: str) -> Task:
    """Return a task.

    Raises
    ------
    InputError
        If there is none of this name; the message lists those that exist.
    """
    return TASKS[one_of("task", name, tuple(TASKS))]
