"""Maps of what learned policies prefer in keepaway, wherever takers stand (Palmer (2015), Figure 7.19)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import gymnasium
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from relforest.experiments.sarsa import trained_team
from relforest.experiments.vectors import vector_value
from relforest.reports.policy_map import Formation, on_variables, policy_map_figure
from relforest.rl.fitted.value import QValue
from relforest.rl.policy import ActionValues
from relforest.rl.rollout import Environment
from relforest.rl.saved_policy import read_policy
from relforest.runs.store import read_checkpoint
from relforest.smdp import Decision
from relforest.support.errors import InputError
from relforest.worlds.keepaway.decisions.scene import decision, describe, objects
from relforest.worlds.keepaway.decisions.variables import by_distance
from relforest.worlds.keepaway.env import KeepawayEnv
from relforest.worlds.keepaway.server.layout import BODY, Setup

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
    evaluate = on_variables(agent.values, keepers=setup.keepers, actor=_ACTOR)
    features = {"tiles": "CMAC", "bells": "RBF"}[agent.features.to_dict()["kind"]]
    return _figure(setup, evaluate, f"{features} Sarsa, the first keeper's agent")


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


def scene_decision(players: NDArray[np.float64], keepers: int, actor: int) -> Decision:
    """Return what a relational learner sees when a keeper must decide among players (n, 5)."""
    receivers = np.empty(keepers - 1, dtype=np.int64)
    by_distance(players, actor, 0, receivers)
    matrix = objects(keepers, len(players) - keepers)
    describe(players, matrix)
    return decision(matrix, actor, receivers)


def _value_map(folder: Path, env: Environment, value: ActionValues, name: str) -> Figure:
    setup = _setup(env)

    def evaluate(states: NDArray[np.float64]) -> NDArray[np.float64]:
        seen = (scene_decision(players, setup.keepers, _ACTOR) for players in states)
        return np.array([value.values(decision) for decision in seen])

    return _figure(setup, evaluate, f"{name} after {read_checkpoint(folder).iteration} iterations")


def _figure(setup: Setup, evaluate: Callable[[NDArray[np.float64]], NDArray[Any]], title: str) -> Figure:
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
