"""The roads of highway-env as worlds."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from typing import Any, Final

import gymnasium
import numpy as np
from numpy.typing import NDArray

from relforest.adapters.object_env import ObjectEnv
from relforest.scenes import Attribute, Schema
from relforest.support.errors import InputError

ACTIONS: Final = ("lane_left", "idle", "lane_right", "faster", "slower")
"""The meta-actions of highway-env, in its order."""

SCHEMA: Final = Schema((Attribute("location", 2), Attribute("velocity", 2)))
"""Metres along the road from the agent's car, metres across it, and metres a second."""

_FEATURES: Final = ("presence", "x", "y", "vx", "vy")


def highway_world(
    name: str = "highway-fast-v0",
    config: Mapping[str, object] | None = None,
    *,
    vehicles: int = 15,
    discount: float = 0.95,
) -> ObjectEnv:
    """Return a world of highway-env, in which every action is about ``agent``, the car that is driven.

    Parameters
    ----------
    name : str
        An environment of highway-env with meta-actions, such as ``"highway-fast-v0"``.
    config : mapping, optional
        Options of the environment, such as ``{"vehicles_density": 2}``; see the documentation of highway-env.
    vehicles : int
        How many cars are seen: the agent's and those nearest to it. A policy that was learned with some may
        drive among others.
    discount : float
        From one action to the next.

    Raises
    ------
    InputError
        If highway-env is not installed, or the environment has other actions.

    References
    ----------
    Leurent (2018), "An Environment for Autonomous Driving Decision-Making".
    """
    if find_spec("highway_env") is None:
        raise InputError("highway-env is not installed: install the extra 'relforest[highway]'")
    import highway_env  # noqa: F401, PLC0415 - registers the environments

    seen = {
        "type": "Kinematics",
        "vehicles_count": vehicles,
        "features": list(_FEATURES),
        "absolute": True,
        "normalize": False,
        "see_behind": True,
    }
    env = gymnasium.make(name, disable_env_checker=True, config={**(config or {}), "observation": seen})
    return ObjectEnv(env, SCHEMA, _cars, ACTIONS, slots=vehicles, parameters=("agent",), discount=discount)


def _cars(seen: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """Return the cars that are present, the agent's first, which is where positions along the road begin."""
    rows = seen[seen[:, 0] > 0.0].astype(np.float64)[:, 1:]
    rows[:, 0] -= rows[0, 0]
    return rows
