"""Which blocks belong together, seen from above."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def stacks(x: NDArray[np.float64], bounds: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the stack that each block belongs to, as the colour score counts stacks.

    Two blocks are linked if the midpoint of one lies between the horizontal extrema of the other, whichever
    it is, whether or not they touch; stacks are what links connect. That links work both ways and heights do
    not matter is a reading.

    Parameters
    ----------
    x : (n,) float64
        Midpoints.
    bounds : (n, 4) float64
        Bounding boxes: min x, max x, min y, max y.

    Returns
    -------
    (n,) int64
        The first member of each block's stack.

    References
    ----------
    Palmer (2015), section 7.4.2.
    """
    within = (bounds[np.newaxis, :, 0] <= x[:, np.newaxis]) & (x[:, np.newaxis] <= bounds[np.newaxis, :, 1])
    return _components(within | within.T)


def connected(bounds: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the group that each block belongs to, where blocks are linked by any horizontal overlap.

    Parameters
    ----------
    bounds : (n, 4) float64
        Bounding boxes: min x, max x, min y, max y.

    Returns
    -------
    (n,) int64
        The first member of each block's group.
    """
    low, high = bounds[:, 0], bounds[:, 1]
    starts_before = low[:, np.newaxis] <= high[np.newaxis, :]
    return _components(starts_before & starts_before.T)


def _components(linked: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the first member of the connected component of each node of a symmetric graph (n, n)."""
    n = len(linked)
    reach = linked | np.eye(n, dtype=np.bool_)
    labels = np.arange(n)
    # A label travels at least one link per round.
    for _ in range(n):
        labels = np.where(reach, labels[np.newaxis, :], n).min(axis=1, initial=n)
    return labels
