"""What each instance contributes to the largest or the mean value of its bag.

Letters: n points, grouped by bag; b bags; k values of a point.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def lead(near: NDArray[np.float64], starts: NDArray[np.int64]) -> NDArray[np.float64]:
    """Lead of each point's nearness (n, k) over the second best in its bag; 0 for all but the best."""
    counts = np.diff(starts)
    best = np.repeat(np.maximum.reduceat(near, starts[:-1], axis=0), counts, axis=0)
    is_best = near == best
    # If two are equally near, the bag loses nothing without either.
    tied = np.repeat(np.add.reduceat(is_best, starts[:-1], axis=0, dtype=np.int64), counts, axis=0) > 1
    others = np.where(is_best, 0.0, near)
    second = np.repeat(np.maximum.reduceat(others, starts[:-1], axis=0), counts, axis=0)
    return np.where(is_best & ~tied, near - second, 0.0)


def excess(values: NDArray[np.float64], starts: NDArray[np.int64]) -> NDArray[np.float64]:
    """What the mean of a bag's values (n,) loses without each point; the value itself for a lone point."""
    counts = np.repeat(np.diff(starts), np.diff(starts))
    sums = np.repeat(np.add.reduceat(values, starts[:-1]), np.diff(starts))
    without = (sums - values) / np.maximum(counts - 1, 1)
    return np.where(counts > 1, sums / counts - without, values)
