"""Fitted Q on vectors of keepaway, by the names of ``relforest learn``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, TypeAlias

import gymnasium
import numpy as np

from relforest.experiments.tasks import MethodName
from relforest.rl.vectors.approximator import Approximator
from relforest.rl.vectors.curves import LSPI, LinearQ
from relforest.rl.vectors.learner import VectorLearner, VectorValue, read_value
from relforest.rl.vectors.networks import NetworkQ
from relforest.rl.vectors.trees import TreesQ
from relforest.runs.store import read_checkpoint
from relforest.support.documents import well_formed
from relforest.support.errors import InputError
from relforest.worlds.keepaway.decisions.vectors import ActionObjects, ActionVariables
from relforest.worlds.keepaway.env import KeepawayEnv
from relforest.worlds.keepaway.server.layout import Setup

_Vectors: TypeAlias = ActionVariables | ActionObjects

_ON_VARIABLES: Final[Mapping[str, Approximator[Any]]] = {
    "linear-q": LinearQ(),
    "lspi": LSPI(),
    "trees-q": TreesQ("trees"),
    "boosting-q": TreesQ("boosting"),
}


def vector_learner(
    method: MethodName, env: gymnasium.Env[Any, Any], seed: np.random.SeedSequence, episodes: tuple[int, int]
) -> VectorLearner:
    """Return a learner of keepaway; `episodes` are training and test episodes per iteration.

    Raises
    ------
    InputError
        If the world is not keepaway.
    """
    return VectorLearner(env, *_parts(method, _setup(env)), seed, *episodes)


def vector_value(folder: Path, env: gymnasium.Env[Any, Any]) -> tuple[str, VectorValue]:
    """Return the name of the method that learned in the folder of a run, and its value function.

    Raises
    ------
    InputError
        If it has not learned anything yet, or the world is not keepaway with as many players.
    ModelFormatError
        If a file is missing or damaged.
    """
    checkpoint, setup = read_checkpoint(folder), _setup(env)
    with well_formed(f"the checkpoint in {folder} is damaged"):
        method = checkpoint.configuration["settings"]["name"]
        vector_map, approximator = _parts(method, setup)
        options = checkpoint.configuration["world"]["options"]
        keepers, takers = options["keepers"], options["takers"]
    if (keepers, takers) != (setup.keepers, setup.takers):
        raise InputError(
            f"{folder} was learned by {keepers} keepers against {takers} takers, not by {setup.keepers} "
            f"against {setup.takers}: choose --keepers and --takers"
        )
    if checkpoint.iteration == 0:
        raise InputError(f"{folder} has not learned anything yet: wait for its first iteration")
    model = approximator.model
    return method, read_value(checkpoint.document, checkpoint.iteration, folder, model, vector_map)


def _parts(method: str, setup: Setup) -> tuple[_Vectors, Approximator[Any]]:
    if method in _ON_VARIABLES:
        return ActionVariables(setup.keepers, setup.takers), _ON_VARIABLES[method]
    objects = ActionObjects(setup.keepers, setup.takers)
    return objects, NetworkQ(method, {"dqn": 1, "deep-sets-q": objects.n_rows}[method])


def _setup(env: gymnasium.Env[Any, Any]) -> Setup:
    world = env.unwrapped
    if not isinstance(world, KeepawayEnv):
        raise InputError(f"these vectors are those of keepaway, not of {type(world).__name__}: play keepaway")
    return world.setup
