"""The best radius for a centre and covariance (section 3.2.2), without sorting the witnesses."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.support.jit import kernel
from relforest.volumes.objectives import score_counts, score_sums

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Buckets(NamedTuple):
    """Work space of `best_cut`: witnesses counted and chained by ranges of distances."""

    counts: NDArray[np.int64]  # (n_buckets,) negative bags + 2**32 * positive bags
    heads: NDArray[np.int32]  # (n_buckets,) first bag of each bucket, -1 = none
    bags: NDArray[np.int32]  # (3, n_bags) bucket of each bag, next bag in it, sorted bags of one bucket
    scores: NDArray[np.float64]  # (2, n_buckets) of a cut behind a bucket, and the best hoped for inside


_BUCKET: Final = 0
_NEXT: Final = 1
_SORTED: Final = 2
_BEHIND: Final = 0
_HOPED: Final = 1
_NEGATIVES: Final = 2**32 - 1
_MANY: Final = 64


@kernel
def new_buckets(n_bags: int) -> Buckets:
    """Work space for `n_bags` bags."""
    n_buckets = 32
    while 10 * n_buckets < n_bags:
        n_buckets *= 2
    return Buckets(
        np.empty(n_buckets, dtype=np.int64),
        np.empty(n_buckets, dtype=np.int32),
        np.empty((3, n_bags), dtype=np.int32),
        np.empty((2, n_buckets)),
    )


@kernel
def best_cut(
    squared: NDArray[np.float64],
    weights: NDArray[np.int64],
    objective: tuple[int, NDArray[np.float64]],
    scale: float,
    floor: float,
    buckets: Buckets,
) -> tuple[float, float]:
    """Best score over all cuts of the witness distances, and the largest squared distance inside.

    A cut lies behind a distinct distance; the smallest of equally good cuts is taken; "nothing
    inside" is no cut. Witnesses are counted into buckets of increasing distance instead of being
    sorted. Both objectives can only rise with a positive bag and fall with a negative one, so no cut
    inside a bucket beats the score that it would have with all the bucket's positives and none of its
    negatives; only buckets where that is better than the best score so far are sorted.

    Parameters
    ----------
    squared : (n_bags,) float64
        Squared witness distances.
    weights : (n_bags,) int64
        1 for negative, 2**32 for positive bags.
    objective : (int, (n_bags + 1,) float64)
        `ACCURACY` or `LOG_LIKELIHOOD`, and `entropy_table(n_bags)`.
    scale : float
        A squared distance near the expected cut, > 0; it affects only the speed.
    floor : float
        Scores that do not exceed it are of no interest.
    buckets : Buckets
        Work space.

    Returns
    -------
    (float, float)
        Score and edge; (-inf, -inf) if no admissible cut exceeds the floor.
    """
    n_positive = _fill(squared, weights, scale, buckets)
    totals = (n_positive, len(squared) - n_positive)
    best, best_bucket = _score_buckets(objective, totals, buckets)
    edge, inner = -np.inf, False
    if best <= floor:
        best, best_bucket = floor, -1
    for k in range(len(buckets.counts)):
        hoped = buckets.scores[_HOPED, k]
        # An equal score counts only for a smaller cut.
        if hoped > best or (hoped == best and k <= best_bucket and not inner):
            score, inside = _best_inside(k, squared, weights, objective, totals, buckets)
            if score > best or (score == best and k <= best_bucket and not inner):
                best, edge, best_bucket, inner = score, inside, k, True
    if best_bucket < 0:
        return -np.inf, -np.inf
    if not inner:
        count = _sort_bucket(best_bucket, squared, buckets)
        edge = squared[buckets.bags[_SORTED, count - 1]]
    return best, edge


@kernel
def _fill(squared: NDArray[np.float64], weights: NDArray[np.int64], scale: float, buckets: Buckets) -> int:
    """Put every bag into a bucket; number of positive bags."""
    n_buckets = len(buckets.counts)
    whole = float(n_buckets)
    for i in range(len(squared)):
        # t / (t + scale) in a form that rounding keeps monotonic.
        buckets.bags[_BUCKET, i] = np.int32(whole - whole * scale / (squared[i] + scale))
    for k in range(n_buckets):
        buckets.counts[k] = 0
        buckets.heads[k] = -1
    total = 0
    for i in range(len(squared)):
        k = min(buckets.bags[_BUCKET, i], n_buckets - 1)
        buckets.bags[_NEXT, i] = buckets.heads[k]
        buckets.heads[k] = i
        buckets.counts[k] += weights[i]
        total += weights[i]
    return total >> 32


@kernel
def _score_buckets(
    objective: tuple[int, NDArray[np.float64]], totals: tuple[int, int], buckets: Buckets
) -> tuple[float, int]:
    """Score the cuts behind all buckets and what is hoped for inside; the best cut's score and bucket.

    Nothing here branches on the data: a mispredicted branch per bucket would cost more than all else.
    """
    code, table = objective
    n_buckets = len(buckets.counts)
    positive, negative = 0, 0
    for k in range(n_buckets):
        before = negative
        positive += buckets.counts[k] >> 32
        negative += buckets.counts[k] & _NEGATIVES
        buckets.scores[_BEHIND, k] = score_counts(code, positive, negative, totals, table)
        hoped = score_counts(code, positive, before, totals, table)
        # Where negatives come first, a cut behind one of them is the least that can be had.
        only_negatives = positive + before == 0 and negative > 0
        buckets.scores[_HOPED, k] = np.inf if only_negatives else hoped
    best = -np.inf
    for k in range(n_buckets):
        best = max(best, buckets.scores[_BEHIND, k])
    for k in range(n_buckets):
        if buckets.heads[k] >= 0 and buckets.scores[_BEHIND, k] == best and best > -np.inf:
            return best, k
    return -np.inf, -1


@kernel
def _best_inside(
    k: int,
    squared: NDArray[np.float64],
    weights: NDArray[np.int64],
    objective: tuple[int, NDArray[np.float64]],
    totals: tuple[int, int],
    buckets: Buckets,
) -> tuple[float, float]:
    """Score and edge of the best cut behind a bag of bucket k, the smallest one of equals."""
    code, table = objective
    total = 0
    for earlier in range(k):
        total += buckets.counts[earlier]
    count = _sort_bucket(k, squared, buckets)
    best, edge = -np.inf, -np.inf
    for j in range(count):
        bag = buckets.bags[_SORTED, j]
        total += weights[bag]
        if j + 1 < count and squared[buckets.bags[_SORTED, j + 1]] == squared[bag]:
            continue
        score = score_counts(code, total >> 32, total & _NEGATIVES, totals, table)
        if score > best:
            best, edge = score, squared[bag]
    return best, edge


@kernel
def _sort_bucket(k: int, squared: NDArray[np.float64], buckets: Buckets) -> int:
    """Bags of bucket k by distance into ``buckets.bags[_SORTED]``; how many there are."""
    count = 0
    bag = buckets.heads[k]
    if (buckets.counts[k] >> 32) + (buckets.counts[k] & _NEGATIVES) > _MANY:
        # An outlier far beyond all others can leave everything in one bucket.
        while bag >= 0:
            buckets.bags[_SORTED, count] = bag
            count += 1
            bag = buckets.bags[_NEXT, bag]
        members = buckets.bags[_SORTED, :count]
        members[:] = members[np.argsort(squared[members])]
        return count
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
def best_weighted_cut(
    squared: NDArray[np.float64], evidence: NDArray[np.float64], objective: int, floor: float
) -> tuple[float, float]:
    """Best score and edge as `best_cut` returns them, of bags that weigh `evidence` (2, n_bags)."""
    order = np.argsort(squared)
    totals = (evidence[0].sum(), evidence[1].sum())
    first, second = 0.0, 0.0
    best, edge = floor, -np.inf
    for i in range(len(order) - 1):
        first += evidence[0, order[i]]
        second += evidence[1, order[i]]
        if squared[order[i + 1]] == squared[order[i]]:
            continue
        score = score_sums(objective, (first, second), totals)
        if score > best:
            best, edge = score, squared[order[i]]
    return (best, edge) if best > floor else (-np.inf, -np.inf)


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
