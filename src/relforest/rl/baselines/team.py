"""Several Sarsa agents for one world, learning alone or together."""

from __future__ import annotations

import numpy as np

from relforest.rl.baselines.feature_map import FeatureMap, Observation
from relforest.rl.baselines.sarsa import SarsaLambda
from relforest.rl.baselines.settings import SarsaSettings
from relforest.support.errors import InputError
from relforest.support.options import at_least
from relforest.support.rng import RandomState, seed_sequence, stream


def make_team(
    features: FeatureMap[Observation],
    n_agents: int,
    settings: SarsaSettings | None = None,
    *,
    shared: bool = False,
    random_state: RandomState = None,
) -> tuple[SarsaLambda[Observation], ...]:
    """Return agents that act in one world, each with its own episodes, traces and random stream.

    Parameters
    ----------
    features : FeatureMap
        The view of all of them.
    n_agents : int
        How many, at least 1.
    settings : SarsaSettings, optional
        The options of all of them.
    shared : bool
        Whether they share one weight vector, so that each learns from everyone's experience as it happens.
    random_state : int, SeedSequence, Generator or None
        Seed of the team.

    Raises
    ------
    InputError
        If an option is wrong.

    References
    ----------
    Palmer (2015), section 7.5.2: agents of the benchmark learn alone, the fair comparison shares experience.
    """
    at_least("n_agents", n_agents, 1)
    if not isinstance(shared, bool):
        raise InputError(f"shared must be True or False, got {shared!r}")
    seed = seed_sequence(random_state)
    weights = np.zeros(features.n_features) if shared else None
    return tuple(
        SarsaLambda(features, settings, weights=weights, random_state=stream(seed, i))
        for i in range(n_agents)
    )
