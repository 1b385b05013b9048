"""The values of leaves (Algorithm 4.2), by which they are also ordered."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, final

import numpy as np

from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

BINARY: Final = 0
CLASSES: Final = 1
REAL: Final = 2

_STEP: Final = 1e-6
_BELOW_PREVIOUS: Final = 1.0 - _STEP


@final
@dataclass(frozen=True, slots=True, eq=False)
class Assignment:
    """The values of a tree's leaves.

    Notes
    -----
    Two points are left open by the source. A leaf assigned later is kept strictly below those assigned
    before, so that the highest leaf of a scene is the leaf that decided it in training. A leaf without
    scenes gets the value of all scenes together, after all others and under the same bound: nothing was
    learned there, so a scene that arrives later should be treated as average rather than as certain.

    References
    ----------
    Palmer (2015), Algorithm 4.2, eq. 4.1.
    """

    value: NDArray[np.float64]
    """(n_leaves,): the probability of the positive class; for several classes the largest share of any but
    the common one; or the mean of the standardised target."""
    sums: NDArray[np.float64]  # (n_leaves, k) what the scenes that each leaf won add up to, see `Target.sums`
    winner: NDArray[np.int64]  # (n_scenes,) the leaf that decides each scene
    log_likelihood: float  # logarithm of eq. 4.1 over all scenes, or of its counterpart for other targets


@kernel
def assigned(
    presence: NDArray[np.bool_], sums: NDArray[np.float64], target: int, common: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    """Return the value, the sums and the winner of an `Assignment`."""
    n_leaves, n_scenes = presence.shape
    value = np.full(n_leaves, -np.inf)
    won = np.zeros((n_leaves, sums.shape[1]))
    winner = np.full(n_scenes, -1, dtype=np.int64)
    is_assigned = np.zeros(n_leaves, dtype=np.bool_)
    bound = np.inf
    while True:
        best, highest = _highest(presence, sums, (target, common), winner, is_assigned, won)
        if best < 0:
            break
        is_assigned[best] = True
        value[best] = min(highest, bound)
        bound = _below(value[best], target)
        for scene in range(n_scenes):
            if presence[best, scene] and winner[scene] < 0:
                winner[scene] = best
    rest = won.sum(axis=0)
    for leaf in range(n_leaves):
        if not is_assigned[leaf]:
            value[leaf] = min(value_of(rest, target, common), bound)
            bound = _below(value[leaf], target)
    return value, won, winner


@kernel
def _highest(
    presence: NDArray[np.bool_],
    sums: NDArray[np.float64],
    criterion: tuple[int, int],
    winner: NDArray[np.int64],
    is_assigned: NDArray[np.bool_],
    won: NDArray[np.float64],
) -> tuple[int, float]:
    """Return the unassigned leaf with the highest value by its undecided scenes, and that value; -1 if none.

    Their sums go to the leaf's row of `won`. They are added up anew every time: if they are not whole
    numbers, differences would leave traces of what was taken away.
    """
    best, highest = -1, -np.inf
    for leaf in range(len(presence)):
        if is_assigned[leaf]:
            continue
        won[leaf] = 0.0
        if _add_up(presence[leaf], winner, sums, won[leaf]) > 0:
            here = value_of(won[leaf], criterion[0], criterion[1])
            if here > highest:
                best, highest = leaf, here
    return best, highest


@kernel
def _add_up(
    present: NDArray[np.bool_],
    winner: NDArray[np.int64],
    sums: NDArray[np.float64],
    total: NDArray[np.float64],
) -> int:
    """Add up the undecided scenes that are present; how many there are."""
    n = 0
    for scene in range(len(present)):
        if present[scene] and winner[scene] < 0:
            n += 1
            for k in range(len(total)):
                total[k] += sums[scene, k]
    return n


@kernel
def value_of(sums: NDArray[np.float64], target: int, common: int) -> float:
    """Return the value that orders a leaf with these sums."""
    if target == REAL:
        return float(sums[1] / sums[0])
    total, largest = 0.0, 0.0
    for k in range(len(sums)):
        total += sums[k]
        if k != common:
            largest = max(largest, sums[k])
    return float(largest / total)


@kernel
def _below(value: float, target: int) -> float:
    """Return the largest value that a leaf assigned later may have."""
    return float(value - _STEP if target == REAL else value * _BELOW_PREVIOUS)
