"""The two actions, the motion and the reward of the corridor (Palmer (2015), section 7.3.1).

A step has a fixed mean length and Gaussian noise, and there are walls at both ends. Numbers and (n,) arrays
are accepted, for n agents that move at the same time.
"""

from __future__ import annotations

from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from relforest.smdp import ActionType

Numbers = TypeVar("Numbers", float, NDArray[np.float64])

LEFT: Final = 0
RIGHT: Final = 1

ACTION_TYPES: Final = (ActionType("left"), ActionType("right"))
"""Neither has a parameter."""

DIRECTIONS: Final = (-1.0, 1.0)
"""Sign of the mean displacement of each action type."""

STEP_LENGTH: Final = 0.1
"""Mean length of a step, in corridor lengths."""

NOISE: Final = 0.05
"""Standard deviation of the displacement, in corridor lengths."""

WINDOW: Final = 0.1
"""Width of the rewarded zone at each edge, in corridor lengths."""


def next_location(
    x: Numbers, direction: Numbers, disturbance: Numbers, *, step_length: float = STEP_LENGTH
) -> Numbers:
    """Move the agent one step, and return its location after it, 0 to 1.

    Parameters
    ----------
    x : float or (n,) float64
        Location before the step, 0 to 1.
    direction : float or (n,) float64
        One of `DIRECTIONS`.
    disturbance : float or (n,) float64
        Displacement by noise, in corridor lengths; the caller draws it from N(0, `NOISE`).
    step_length : float
        Mean length of a step, in corridor lengths.

    Notes
    -----
    The source does not specify what happens at the ends. Here the agent stops at the wall; the best policy
    then earns 8.69 per episode, and the source reports about 8.68.
    """
    free = x + direction * step_length + disturbance
    stopped: Numbers = np.minimum(np.maximum(free, 0.0), 1.0)
    return stopped


def reward(x: Numbers, *, window: float = WINDOW) -> Numbers:
    """Return 1 where a step ended (0 to 1) in the window at an edge, boundary included, else 0."""
    inside = (x <= window) | (x >= 1.0 - window)
    return inside.astype(np.float64) if isinstance(inside, np.ndarray) else float(inside)
