"""The best radius for a centre and covariance (section 3.2.2), without sorting the witnesses."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.support.jit import kernel
from relforest.volumes.objectives import score_counts

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Buckets(NamedTuple):
    """Work space of `best_cut`: witnesses in linked lists, one list per range of distances."""

    table: NDArray[np.int32]  # (n_buckets, 3) negative bags, positive bags, first bag (-1 = none)
    bags: NDArray[np.int32]  # (3, n_bags) bucket of each bag, next bag of it, sorted bags of one bucket


_HEAD: Final = 2
_BUCKET: Final = 0
_NEXT: Final = 1
_SORTED: Final = 2


@kernel
def new_buckets(n_bags: int) -> Buckets:
    """Work space for `n_bags` bags: about one bucket per bag."""
    n_buckets = 64
    while n_buckets < n_bags and n_buckets < 4096:
        n_buckets *= 2
    return Buckets(np.empty((n_buckets, 3), dtype=np.int32), np.empty((3, n_bags), dtype=np.int32))


@kernel
def best_cut(
    squared: NDArray[np.float64],
    positive: NDArray[np.int64],
    objective: int,
    table: NDArray[np.float64],
    scale: float,
    buckets: Buckets,
) -> tuple[float, float]:
    """Best score over all cuts of the witness distances, and the largest squared distance inside.

    A cut lies behind a distinct distance; the smallest of equally good cuts is taken; "nothing
    inside" is no cut. Witnesses are counted into buckets of increasing distance instead of being
    sorted. Both objectives can only rise with a positive bag and fall with a negative one, so the
    best cut ends a bucket unless a bucket holds both kinds and could, with its positives alone,
    reach the best score so far; only such buckets are looked into.

    Parameters
    ----------
    squared : ndarray (n_bags,)
        Squared witness distances.
    positive : int64 ndarray (n_bags,)
        1 for positive bags.
    objective : int
        `ACCURACY` or `LOG_LIKELIHOOD`.
    table : ndarray (n_bags + 1,)
        `entropy_table(n_bags)`.
    scale : float
        A squared distance near the expected cut, > 0; it affects only the speed.
    buckets : Buckets
        Work space.

    Returns
    -------
    (float, float)
        Score and edge; (-inf, -inf) if no cut is admissible.
    """
    n_positive = _fill(squared, positive, scale, buckets)
    totals = (n_positive, len(squared) - n_positive)
    best, best_bucket = _best_bucket(objective, totals, table, buckets)
    inside_positive, inside_negative = 0, 0
    edge, inner = -np.inf, False
    for k in range(len(buckets.table)):
        negatives, positives = buckets.table[k, 0], buckets.table[k, 1]
        mixed = negatives > 0 and (positives > 0 or inside_positive + inside_negative == 0)
        if mixed and negatives + positives > 1:
            hoped = score_counts(objective, inside_positive + positives, inside_negative, totals, table)
            if hoped > best or (hoped == best and k <= best_bucket and not inner):
                count = _sort_bucket(k, squared, buckets)
                for j in range(count):
                    bag = buckets.bags[_SORTED, j]
                    inside_positive += positive[bag]
                    inside_negative += 1 - positive[bag]
                    if j + 1 < count and squared[buckets.bags[_SORTED, j + 1]] == squared[bag]:
                        continue
                    score = score_counts(objective, inside_positive, inside_negative, totals, table)
                    if score > best or (score == best and k <= best_bucket and not inner):
                        best, edge, best_bucket, inner = score, squared[bag], k, True
                continue
        inside_positive += positives
        inside_negative += negatives
    if best > -np.inf and not inner:
        count = _sort_bucket(best_bucket, squared, buckets)
        edge = squared[buckets.bags[_SORTED, count - 1]]
    return best, edge


@kernel
def _fill(
    squared: NDArray[np.float64], positive: NDArray[np.int64], scale: float, buckets: Buckets
) -> int:
    """Sort the bags into buckets of t / (t + scale); number of positive bags."""
    n_buckets = len(buckets.table)
    for i in range(len(squared)):
        buckets.bags[_BUCKET, i] = np.int32(n_buckets * (squared[i] / (squared[i] + scale)))
    for k in range(n_buckets):
        buckets.table[k, 0] = buckets.table[k, 1] = 0
        buckets.table[k, _HEAD] = -1
    n_positive = 0
    for i in range(len(squared)):
        k = min(buckets.bags[_BUCKET, i], n_buckets - 1)
        buckets.bags[_NEXT, i] = buckets.table[k, _HEAD]
        buckets.table[k, _HEAD] = i
        buckets.table[k, positive[i]] += 1
        n_positive += positive[i]
    return n_positive


@kernel
def _best_bucket(
    objective: int, totals: tuple[int, int], table: NDArray[np.float64], buckets: Buckets
) -> tuple[float, int]:
    """Best score of the cuts at the ends of buckets, and the first bucket that reaches it."""
    best, best_bucket = -np.inf, -1
    inside_positive, inside_negative = 0, 0
    for k in range(len(buckets.table)):
        negatives, positives = buckets.table[k, 0], buckets.table[k, 1]
        first = inside_positive + inside_negative == 0
        inside_positive += positives
        inside_negative += negatives
        # Behind negatives alone a cut is never better than before them, unless it is the first.
        if positives == 0 and (negatives == 0 or not first):
            continue
        score = score_counts(objective, inside_positive, inside_negative, totals, table)
        if score > best:
            best, best_bucket = score, k
    return best, best_bucket


@kernel
def _sort_bucket(k: int, squared: NDArray[np.float64], buckets: Buckets) -> int:
    """Bags of bucket k by distance into `buckets.members`; how many there are."""
    count = 0
    bag = buckets.table[k, _HEAD]
    while bag >= 0:
        place = count
        while place > 0 and squared[buckets.bags[_SORTED, place - 1]] > squared[bag]:
            buckets.bags[_SORTED, place] = buckets.bags[_SORTED, place - 1]
            place -= 1
        buckets.bags[_SORTED, place] = bag
        count += 1
        bag = buckets.bags[_NEXT, bag]
    return count


@kernel
def radius_at(edge: float, squared: NDArray[np.float64]) -> float:
    """Radius of a cut: midway to the next distance outside, or just beyond the last distance."""
    outside = np.inf
    for i in range(len(squared)):
        if edge < squared[i] < outside:
            outside = squared[i]
    if outside == np.inf:
        # A hair of slack, since callers recompute distances with other roundings.
        return math.sqrt(edge) * (1.0 + 1e-9)
    return 0.5 * (math.sqrt(edge) + math.sqrt(outside))
