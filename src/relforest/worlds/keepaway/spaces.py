"""The Gymnasium spaces of keepaway, shared by its single, batched and multi-agent environments."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from gymnasium import spaces

from relforest.worlds.keepaway.decisions.variables import n_variables
from relforest.worlds.keepaway.server.layout import Setup

BEYOND: Final = 100.0
"""Metres. Players run where the ball will be within a few seconds, and it rolls 50 m at most."""


def observation_space(setup: Setup) -> spaces.Dict:
    """Return the space of padded scenes; nothing is padded, because the number of players is constant."""
    n, reach = setup.keepers + setup.takers, _reach(setup)
    return spaces.Dict(
        {
            "location": spaces.Box(-reach, reach, (n, 2), np.float64),
            "orientation": spaces.Box(-math.pi, math.pi, (n, 1), np.float64),
            "color": spaces.Box(0.0, 1.0, (n, 3), np.float64),
            "mask": spaces.MultiBinary(n),
        }
    )


def action_space(setup: Setup) -> spaces.Discrete:
    """Return the space of actions: hold, and a pass to each teammate."""
    return spaces.Discrete(setup.keepers)


def variables_space(setup: Setup) -> spaces.Box[np.float64]:
    """Return the space of the state variables: metres, then one angle per teammate in degrees."""
    high = np.full(n_variables(setup.keepers, setup.takers), 3.0 * _reach(setup))
    high[1 - setup.keepers :] = 180.0
    return spaces.Box(0.0, high, dtype=np.float64)


def _reach(setup: Setup) -> float:
    return max(setup.length, setup.width) + BEYOND
