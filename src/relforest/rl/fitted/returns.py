"""What the action of each transition turned out to be worth: returns that trust greedy actions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray


@kernel
def returns(
    rewards: NDArray[np.float64],
    discounts: NDArray[np.float64],
    values: NDArray[np.float64],
    goes_on: NDArray[np.bool_],
    trace: float,
    out: NDArray[np.float64],
) -> None:
    """Write Watkins's lambda-returns of n transitions in the order in which they happened, (n,).

    Parameters
    ----------
    rewards : (n,) float64
        Discounted reward inside the action.
    discounts : (n,) float64
        Discount of what follows, 0 where nothing does.
    values : (n,) float64
        Value of the next state.
    goes_on : (n,) bool
        Whether the next transition continues the episode with an action that is now thought to be best; the
        last entry is False.
    trace : float
        Lambda.
    out : (n,) float64

    References
    ----------
    Watkins, Learning from delayed rewards (1989), chapter 7.
    """
    following = 0.0
    for i in range(len(rewards) - 1, -1, -1):
        expected = values[i]
        if goes_on[i]:
            expected = (1.0 - trace) * expected + trace * following
        following = rewards[i] + discounts[i] * expected
        out[i] = following
