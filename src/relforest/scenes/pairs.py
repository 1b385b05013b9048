"""Which object rows stand in which relation: one sorted array, in which a pair is found by bisection."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.support.jit import kernel

NO_PAIRS: Final[NDArray[np.int64]] = np.empty((0, 3), dtype=np.int64)
NO_PAIRS.flags.writeable = False


@kernel
def _first_place(pairs: NDArray[np.int64], relation: int, first: int, second: int) -> int:
    """Return how many of the sorted pairs (n, 3) come before this one."""
    low, high = 0, len(pairs)
    while low < high:
        middle = (low + high) // 2
        a, b, c = pairs[middle, 0], pairs[middle, 1], pairs[middle, 2]
        if a < relation or (a == relation and (b < first or (b == first and c < second))):
            low = middle + 1
        else:
            high = middle
    return low


@kernel
def is_related(pairs: NDArray[np.int64], relation: int, first: int, second: int) -> bool:
    """Return whether the sorted pairs (n, 3) contain this one."""
    place = _first_place(pairs, relation, first, second)
    return bool(
        place < len(pairs)
        and pairs[place, 0] == relation
        and pairs[place, 1] == first
        and pairs[place, 2] == second
    )


@kernel
def is_related_to_any(
    pairs: NDArray[np.int64], relation: int, first: int, objects: NDArray[np.int64]
) -> bool:
    """Return whether the sorted pairs (n, 3) contain one of an object with another one of these."""
    place = _first_place(pairs, relation, first, -1)
    while place < len(pairs) and pairs[place, 0] == relation and pairs[place, 1] == first:
        for other in objects:
            if pairs[place, 2] == other:
                return True
        place += 1
    return False


@kernel
def are_related(
    pairs: NDArray[np.int64], relation: int, rows: NDArray[np.int64], out: NDArray[np.float64]
) -> None:
    """Write for each two object rows (n, 2) whether they are related, NaN where one is no object (-1)."""
    for i in range(len(rows)):
        out[i] = np.nan
        if rows[i, 0] >= 0 and rows[i, 1] >= 0:
            out[i] = 1.0 if is_related(pairs, relation, rows[i, 0], rows[i, 1]) else 0.0
