"""The reward for ending a step close to either edge."""

from __future__ import annotations

from typing import Final, overload

import numpy as np
from numpy.typing import NDArray

WINDOW: Final = 0.1
"""Width of the rewarded zone at each edge, in corridor lengths (Palmer (2015), section 7.3.1)."""


@overload
def reward(x: float, *, window: float = ...) -> float: ...
@overload
def reward(x: NDArray[np.float64], *, window: float = ...) -> NDArray[np.float64]: ...
def reward(x: float | NDArray[np.float64], *, window: float = WINDOW) -> float | NDArray[np.float64]:
    """Return 1 where a step ended in the window at an edge (boundary included), else 0.

    Parameters
    ----------
    x : float or (n,) float64
        Location after the step, 0 to 1.
    window : float
        Width of each rewarded zone, in corridor lengths.

    References
    ----------
    Palmer (2015), section 7.3.1.
    """
    inside = (x <= window) | (x >= 1.0 - window)
    return inside.astype(np.float64) if isinstance(inside, np.ndarray) else float(inside)
