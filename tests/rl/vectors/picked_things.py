"""The actions of the small world `Picking` as vectors, and what was learned of them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from relforest.rl.policy import GreedyPolicy
from relforest.rl.rollout import rollout
from relforest.rl.vectors.approximator import Approximator
from relforest.rl.vectors.learner import VectorKnowledge, VectorLearner
from relforest.smdp import Decisions
from rl.small_worlds import Picking


class Things:
    """The type of an action, where the thing is that it picks, and how many things there are."""

    width = 3

    def vectors(self, decisions: Decisions) -> NDArray[np.float64]:
        owners, position = decisions.owners, decisions.arguments[:, 0]
        places = np.append(decisions.matrix[:, 0], 0.0)
        rows = np.where(position < 0, len(places) - 1, decisions.objects[owners] + position)
        return np.column_stack([decisions.types, places[rows], np.diff(decisions.objects)[owners]])


def learner(approximator: Approximator[Any], seed: int = 0) -> VectorLearner:
    return VectorLearner(Picking(6), Things(), approximator, np.random.SeedSequence(seed), 40, 10)


def learned(approximator: Approximator[Any], iterations: int = 2) -> VectorKnowledge:
    found = learner(approximator)
    state = found.start()
    for number in range(1, iterations + 1):
        state = found.iterate(state, number)
    return state


def reward(state: VectorKnowledge) -> float:
    """Return the mean reward of an episode: at random it is about 1.3, and hardly above 2.7 at best."""
    assert state.value is not None
    played = rollout(Picking(6), GreedyPolicy(state.value), 60, np.random.SeedSequence(9))
    return float(played.episode_rewards.mean())
