"""Maps of what learned policies prefer in keepaway, wherever takers stand (Palmer (2015), Figure 7.19)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, TypeAlias

import gymnasium
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from relforest.experiments.keepaway_team import scene_decision
from relforest.experiments.sarsa import trained_team
from relforest.experiments.vectors import vector_value
from relforest.reports.policy_map import Formation, on_variables, policy_map_figure
from relforest.rl.fitted.value import QValue
from relforest.rl.frozen import ForestFeatures
from relforest.rl.policy import ActionValues
from relforest.rl.rollout import Environment
from relforest.rl.saved_policy import read_policy
from relforest.runs.store import read_checkpoint
from relforest.smdp import Decision
from relforest.support.errors import InputError
from relforest.worlds.keepaway.env import KeepawayEnv
from relforest.worlds.keepaway.server.layout import BODY, Setup

_Evaluation: TypeAlias = Callable[[NDArray[np.float64]], NDArray[Any]]

_STEP: Final = 0.5
_ACTOR: Final = 0

# Corners of the field and then its sides, in shares of half a side: where the others wait for the ball.
_PLACES: Final = (
    (-0.7, -0.7),
    (0.7, -0.7),
    (0.7, 0.7),
    (0.0, -0.7),
    (0.7, 0.0),
    (0.0, 0.7),
    (-0.7, 0.0),
)
_HOLDERS: Final = {"ball in a corner": (-0.7, 0.7), "ball in the centre": (0.0, 0.0)}


def agent_policy_map(folder: Path, env: Environment) -> Figure:
    """Draw what a relational policy of keepaway prefers."""
    value = read_policy(folder)
    return _value_map(folder, env, value, "smrf-q" if isinstance(value, QValue) else "SMRF-RPI")


def vector_policy_map(folder: Path, env: gymnasium.Env[Any, Any]) -> Figure:
    """Draw what a policy by fitted Q on vectors prefers."""
    name, value = vector_value(folder, env)
    return _value_map(folder, env, value, name)


def team_policy_map(folder: Path, env: Environment) -> Figure:
    """Draw what the first agent of a Sarsa team prefers."""
    setup, agent = _setup(env), trained_team(folder)[0]
    features = {"tiles": "CMAC", "bells": "RBF", "trees": "SMRF"}[agent.features.to_dict()["kind"]]
    title = f"{features} Sarsa, the first keeper's agent"
    if isinstance(agent.features, ForestFeatures):
        return _figure(setup, _on_scenes(setup, agent.values), title)
    return _figure(setup, on_variables(agent.values, keepers=setup.keepers, actor=_ACTOR), title)


def formations(setup: Setup) -> tuple[Formation, ...]:
    """Return two formations: the ball in a corner, and in the centre of the field."""
    half = np.array([setup.length, setup.width]) / 2
    made = []
    for title, first in _HOLDERS.items():
        others = [_PLACES[i % len(_PLACES)] for i in range(setup.keepers - 1)]
        players = np.zeros((setup.keepers + setup.takers, BODY + 1))
        players[: setup.keepers, :2] = np.array([first, *others]) * half
        # Side by side, a metre apart, as they run for the ball.
        players[setup.keepers :, :2] = 0.35 * half
        players[setup.keepers :, 0] += np.arange(setup.takers) - (setup.takers - 1) / 2
        made.append(Formation(players, _ACTOR, title))
    return tuple(made)


def _value_map(folder: Path, env: Environment, value: ActionValues, name: str) -> Figure:
    setup = _setup(env)
    title = f"{name} after {read_checkpoint(folder).iteration} iterations"
    return _figure(setup, _on_scenes(setup, value.values), title)


def _on_scenes(setup: Setup, values: Callable[[Decision], NDArray[np.float64]]) -> _Evaluation:
    """Return what values many states of players."""

    def evaluate(states: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array([values(scene_decision(players, setup.keepers, _ACTOR)) for players in states])

    return evaluate


def _figure(setup: Setup, evaluate: _Evaluation, title: str) -> Figure:
    return policy_map_figure(
        formations(setup),
        evaluate,
        keepers=setup.keepers,
        field=(setup.length, setup.width),
        step=_STEP,
        title=title,
    )


def _setup(env: Environment) -> Setup:
    world = env.unwrapped
    if not isinstance(world, KeepawayEnv):
        raise InputError(f"a map of keepaway needs a KeepawayEnv, got {type(world).__name__}")
    return world.setup
