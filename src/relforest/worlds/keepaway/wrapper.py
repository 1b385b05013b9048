"""Keepaway for learners that need vectors: the benchmark's state variables as the observation."""

from __future__ import annotations

from typing import Any, final

import gymnasium
import numpy as np
from gymnasium.utils import RecordConstructorArgs
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.worlds.keepaway.env import KeepawayEnv
from relforest.worlds.keepaway.spaces import variables_space


@final
class StateVariables(
    gymnasium.ObservationWrapper[NDArray[np.float64], np.int64, dict[str, Any]], RecordConstructorArgs
):
    """Replaces the scene by the state variables of the benchmark: 13 numbers for 3 against 2.

    Parameters
    ----------
    env : gymnasium.Env
        Keepaway, possibly wrapped, with the observations of `KeepawayEnv`.

    Raises
    ------
    InputError
        If ``env`` is another world.

    See Also
    --------
    relforest.worlds.keepaway.decisions.variables : Their meaning and order.

    Examples
    --------
    >>> env = StateVariables(gymnasium.make("relforest/Keepaway-v0"))
    >>> observation, info = env.reset(seed=0)
    """

    def __init__(self, env: gymnasium.Env[dict[str, Any], np.int64]) -> None:
        RecordConstructorArgs.__init__(self)
        gymnasium.ObservationWrapper.__init__(self, env)
        world = env.unwrapped
        if not isinstance(world, KeepawayEnv):
            raise InputError(f"env must be keepaway, got {type(world).__name__}")
        self._world = world
        self.observation_space = variables_space(world.setup)

    def observation(self, observation: dict[str, Any]) -> NDArray[np.float64]:  # noqa: ARG002 - Gymnasium's
        """Return the state variables of the present state, (n_variables,)."""
        variables: NDArray[np.float64] = self._world.batch.seen.variables[0]
        return variables.copy()
