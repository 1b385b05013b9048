"""Which blocks belong together, seen from above.

Plain loops: the blocks are few, and scores and policies call these at every action.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray


def stacks(x: NDArray[np.float64], bounds: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the stack of each block, (n,), by its first member, as the color score counts stacks.

    Two blocks are linked if the midpoint of one lies between the horizontal extrema of the other, whichever
    it is, whether or not they touch; stacks are what links connect. That links work both ways and heights do
    not matter is a reading of Palmer (2015), section 7.4.2.

    Blocks have midpoints (n,) and bounding boxes (n, 4): min x, max x, min y, max y.
    """
    middles, intervals = x.tolist(), bounds[:, :2].tolist()

    def is_within(one: int, other: int) -> bool:
        low, high = intervals[other]
        return bool(low <= middles[one] <= high)

    return _components(len(middles), lambda one, other: is_within(one, other) or is_within(other, one))


def connected(bounds: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the first member of each block's group, (n,); blocks are linked by any horizontal overlap.

    ``bounds`` are those of `stacks`.
    """
    intervals = bounds[:, :2].tolist()

    def overlap(one: int, other: int) -> bool:
        return bool(intervals[one][0] <= intervals[other][1] and intervals[other][0] <= intervals[one][1])

    return _components(len(intervals), overlap)


def _components(n: int, are_linked: Callable[[int, int], bool]) -> NDArray[np.int64]:
    """Return the first member of the connected component of each of n nodes; links work both ways."""
    labels = list(range(n))
    for one in range(n):
        for other in range(one):
            if labels[one] != labels[other] and are_linked(one, other):
                kept, dropped = sorted((labels[one], labels[other]))
                labels = [kept if label == dropped else label for label in labels]
    return np.array(labels, dtype=np.int64)
