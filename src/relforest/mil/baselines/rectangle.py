"""The three steps of iterated discrimination: grow a box, select its features, expand its bounds.

A box must contain at least one instance of each positive bag, and should exclude the instances of negative
bags.

Dimensions: n points in n_bags positive bags, m points of negative bags, d features.

References
----------
Dietterich, Lathrop and Lozano-Perez (1997), "Solving the multiple instance problem with axis-parallel
rectangles", Artificial Intelligence 89.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.special import ndtr, ndtri

from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

_REAL_GAIN: Final = 1.0 - 1e-12
_BISECTIONS: Final = 50


@kernel
def grow(points: NDArray[np.float64], starts: NDArray[np.int64]) -> NDArray[np.int64]:
    """Choose one point of each bag so that the box around the chosen ones is small.

    The size of a box is the sum of its widths. Starting from a seed, the point that enlarges the box least is
    added from a bag not yet represented; after each addition, all choices are reconsidered in turn, with the
    others fixed, until none changes (backfitting).

    Parameters
    ----------
    points : (n, d) float64
    starts : (n_bags + 1,) int64
        First point of each bag; no bag is empty.

    Returns
    -------
    (n_bags,) int64
        Row of the chosen point of each bag.
    """
    n_bags = len(starts) - 1
    chosen = np.full(n_bags, -1)
    seed = _seed(points, starts)
    chosen[np.searchsorted(starts, seed, side="right") - 1] = seed
    for _ in range(n_bags - 1):
        box = _box_around(points, chosen, -1)
        least, added, to_bag = np.inf, -1, -1
        for bag in range(n_bags):
            if chosen[bag] < 0:
                row, growth = _least_growth(points, starts[bag], starts[bag + 1], box)
                if growth < least:
                    least, added, to_bag = growth, row, bag
        chosen[to_bag] = added
        _backfit(points, starts, chosen)
    return chosen


@kernel
def _seed(points: NDArray[np.float64], starts: NDArray[np.int64]) -> int:
    """Row of the point nearest to the centre of the minimax box.

    Along each feature, this box extends from the least maximum of a bag to the greatest minimum, which is the
    smallest interval that contains, or touches, a value of each bag.
    """
    centre = np.empty(points.shape[1])
    for k in range(len(centre)):
        least_maximum, greatest_minimum = np.inf, -np.inf
        for bag in range(len(starts) - 1):
            values = points[starts[bag] : starts[bag + 1], k]
            least_maximum = min(least_maximum, values.max())
            greatest_minimum = max(greatest_minimum, values.min())
        centre[k] = 0.5 * (least_maximum + greatest_minimum)
    nearest, row = np.inf, 0
    for i in range(len(points)):
        distance = np.sum((points[i] - centre) ** 2)
        if distance < nearest:
            nearest, row = distance, i
    return row


@kernel
def _box_around(points: NDArray[np.float64], chosen: NDArray[np.int64], but: int) -> NDArray[np.float64]:
    """Lower and upper bounds (2, d) of the chosen points, without that of the bag `but`."""
    box = np.empty((2, points.shape[1]))
    box[0], box[1] = np.inf, -np.inf
    for bag in range(len(chosen)):
        if chosen[bag] >= 0 and bag != but:
            box[0] = np.minimum(box[0], points[chosen[bag]])
            box[1] = np.maximum(box[1], points[chosen[bag]])
    return box


@kernel
def _growth(point: NDArray[np.float64], box: NDArray[np.float64]) -> float:
    """How much the box must grow to contain a point (d,)."""
    growth = 0.0
    for k in range(len(point)):
        growth += max(box[0, k] - point[k], point[k] - box[1, k], 0.0)
    return growth


@kernel
def _least_growth(
    points: NDArray[np.float64], first: int, behind: int, box: NDArray[np.float64]
) -> tuple[int, float]:
    """Return which of the points first, ..., behind - 1 enlarges the box least, and by how much."""
    best, least = first, np.inf
    for row in range(first, behind):
        growth = _growth(points[row], box)
        if growth < least:
            best, least = row, growth
    return best, least


@kernel
def _backfit(points: NDArray[np.float64], starts: NDArray[np.int64], chosen: NDArray[np.int64]) -> None:
    """Exchange chosen points for others of their bags, in place, while this makes the box smaller."""
    if np.sum(chosen >= 0) < 2:
        return
    changed = True
    while changed:
        changed = False
        for bag in range(len(chosen)):
            if chosen[bag] < 0 or starts[bag + 1] - starts[bag] == 1:
                continue
            box = _box_around(points, chosen, bag)
            row, growth = _least_growth(points, starts[bag], starts[bag + 1], box)
            # Rounding must not make two equal boxes alternate forever.
            if growth < _growth(points[chosen[bag]], box) * _REAL_GAIN:
                chosen[bag], changed = row, True


def discriminating(
    negatives: NDArray[np.float64], box: NDArray[np.float64], margin: float
) -> NDArray[np.bool_]:
    """Select features that together exclude the points of negative bags from the box.

    A feature excludes the points outside the box by more than the margin along it; a point that no feature
    excludes in this way is excluded by the feature along which it is farthest outside. The feature that
    excludes most points is selected, these points are removed, and so on. Points inside the box are ignored.

    Parameters
    ----------
    negatives : (m, d) float64
    box : (2, d) float64
        Lower and upper bounds.
    margin : float

    Returns
    -------
    (d,) bool
        All False if all points are inside.
    """
    excluded = _exclusions(negatives, box, margin)
    excluded = excluded[excluded.any(axis=1)]
    selected = np.zeros(negatives.shape[1], dtype=np.bool_)
    counts = excluded.sum(axis=0)
    while len(excluded):
        feature = int(counts.argmax())
        selected[feature] = True
        struck = excluded[:, feature]
        counts = counts - excluded[struck].sum(axis=0)
        excluded = excluded[~struck]
    return selected


def _exclusions(negatives: NDArray[np.float64], box: NDArray[np.float64], margin: float) -> NDArray[np.bool_]:
    """Whether each feature excludes each point, (m, d)."""
    outside = np.maximum(box[0] - negatives, negatives - box[1])
    excluded: NDArray[np.bool_] = outside > margin
    farthest = outside.max(axis=1, initial=0.0)
    rows = np.flatnonzero((farthest > 0.0) & (farthest <= margin))
    if len(rows):
        excluded[rows, outside[rows].argmax(axis=1)] = True
    return excluded


def expansion(values: NDArray[np.float64], tau: float, epsilon: float) -> NDArray[np.float64]:
    """How far the bounds of a box must move outwards to make new positive instances probably lie inside.

    Features are treated independently. The density of a feature is estimated from the chosen points with
    Gaussian kernels; their width is such that a kernel in the middle of the range of values has the share
    `tau` of its mass inside. A bound moves to where the estimated mass beyond it is ``epsilon / 2``, or stays
    if less mass is beyond it already.

    Parameters
    ----------
    values : (n_bags, d) float64
        The chosen points.
    tau, epsilon : float
        Between 0 and 1; not so small that 1 + tau rounds to 1 or epsilon / 2 to 0.

    Returns
    -------
    (2, d) float64
        For the lower and the upper bounds, at least 0.
    """
    low, high = values.min(axis=0), values.max(axis=0)
    widths = 0.5 * (high - low) / ndtri(0.5 * (1.0 + tau))
    below = _quantile_beyond(low - values, widths, 0.5 * epsilon)
    above = _quantile_beyond(values - high, widths, 0.5 * epsilon)
    return np.stack([below, above])


def _quantile_beyond(
    offsets: NDArray[np.float64], widths: NDArray[np.float64], mass: float
) -> NDArray[np.float64]:
    """Return the distance beyond which at most `mass` of the density is left, (d,), by bisection.

    `offsets` (n_bags, d) are the values minus the bound, outwards, and at most 0.
    """
    units = np.divide(offsets, widths, out=np.zeros_like(offsets), where=widths > 0.0)
    low = np.zeros(len(widths))
    # The estimated mass beyond a distance is at most that of a kernel at the bound.
    high = np.full(len(widths), -float(ndtri(mass)))
    inside = ndtr(units).mean(axis=0) <= mass
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        enough = ndtr(units - middle).mean(axis=0) <= mass
        low, high = np.where(enough, low, middle), np.where(enough, middle, high)
    return np.where(inside, 0.0, high * widths)
