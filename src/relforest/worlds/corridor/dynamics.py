"""How the agent moves: a step of fixed mean length, Gaussian noise, and walls at both ends.

Letters: n agents that move at the same time. Both numbers and (n,) arrays are accepted, so that batches of
episodes can be simulated at once.
"""

from __future__ import annotations

from typing import Final, overload

import numpy as np
from numpy.typing import NDArray

STEP_LENGTH: Final = 0.1
"""Mean length of a step, in corridor lengths (Palmer (2015), section 7.3.1)."""

NOISE: Final = 0.05
"""Standard deviation of the displacement, in corridor lengths (Palmer (2015), section 7.3.1)."""


@overload
def next_location(x: float, direction: float, disturbance: float, *, step_length: float = ...) -> float: ...
@overload
def next_location(
    x: NDArray[np.float64],
    direction: NDArray[np.float64],
    disturbance: NDArray[np.float64],
    *,
    step_length: float = ...,
) -> NDArray[np.float64]: ...
def next_location(
    x: float | NDArray[np.float64],
    direction: float | NDArray[np.float64],
    disturbance: float | NDArray[np.float64],
    *,
    step_length: float = STEP_LENGTH,
) -> float | NDArray[np.float64]:
    """Move the agent one step.

    Parameters
    ----------
    x : float or (n,) float64
        Location before the step, 0 to 1.
    direction : float or (n,) float64
        -1 = left, +1 = right (`DIRECTIONS` of the actions).
    disturbance : float or (n,) float64
        Displacement by noise, in corridor lengths; the caller draws it from N(0, `NOISE`).
    step_length : float
        Mean length of a step, in corridor lengths.

    Returns
    -------
    float or (n,) float64
        Location after the step, 0 to 1.

    Notes
    -----
    Palmer (2015), section 7.3.1 does not specify what happens at the ends. Here the agent stops at the wall;
    the best policy then earns 8.69 per episode, and the source reports about 8.68.
    """
    free = x + direction * step_length + disturbance
    return np.minimum(np.maximum(free, 0.0), 1.0)
