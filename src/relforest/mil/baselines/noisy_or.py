"""Diverse density: how well a point, with a scale per feature, explains labelled bags.

A hypothesis is a centre c and scales s. An instance x is positive with probability

    p = (1 - 1e-6) exp(-D^2),   D^2 = sum_k s_k^2 (x_k - c_k)^2,

and a bag is positive with probability 1 - prod (1 - p), the noisy-or of its instances. The diverse density is
the probability of all labels, each to the power of the weight of its bag. The factor before the exponential
keeps it above zero if an instance of a negative bag is at the centre, and has no other noticeable effect.

Dimensions: n points in n_bags bags, d features. A hypothesis is a (2, d) array: the centre, then the scales.

References
----------
Maron and Lozano-Perez (1997), "A framework for multiple-instance learning", NIPS 10.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

CERTAINTY: Final = 1.0 - 1e-6
_NEAR: Final = 3.0
_FAR: Final = 30.0
_NEGLIGIBLE: Final = 1e-18


class Sample(NamedTuple):
    """Labelled bags in the layout of the kernels."""

    points: NDArray[np.float64]  # (n, d), bag after bag
    columns: NDArray[np.float64]  # (d, n), the same transposed
    starts: NDArray[np.int64]  # (n_bags + 1,) first point of each bag
    positive: NDArray[np.bool_]  # (n_bags,)
    weights: NDArray[np.float64]  # (n_bags,) how often each bag counts


def as_sample(
    points: NDArray[np.float64],
    starts: NDArray[np.int64],
    positive: NDArray[np.bool_],
    weights: NDArray[np.float64] | None = None,
) -> Sample:
    """Return points (n, d) of labelled bags, all of weight 1 by default, in the layout of the kernels."""
    weights = np.ones(len(positive)) if weights is None else weights
    return Sample(np.ascontiguousarray(points), np.ascontiguousarray(points.T), starts, positive, weights)


@kernel
def fill_squared_distances(
    columns: NDArray[np.float64], hypothesis: NDArray[np.float64], out: NDArray[np.float64]
) -> None:
    """Write D^2 of the points in `columns` (d, n) into `out` (n,)."""
    n = len(out)
    out[:] = 0.0
    # Feature by feature, since the compiler vectorises over points, but never reorders a sum.
    for k in range(len(columns)):
        centre, weight = hypothesis[0, k], hypothesis[1, k] * hypothesis[1, k]
        column = columns[k]
        for j in range(n):
            out[j] += weight * (column[j] - centre) * (column[j] - centre)


@kernel
def negative_log_density(
    sample: Sample,
    hypothesis: NDArray[np.float64],
    gradient: NDArray[np.float64],
    slopes: NDArray[np.float64],
) -> float:
    """Negative logarithm of the diverse density, with its gradient.

    Parameters
    ----------
    sample : Sample
    hypothesis : (2, d) float64
    gradient : (2, d) float64
        Overwritten with the derivatives with respect to the hypothesis.
    slopes : (n,) float64
        Overwritten with the derivatives with respect to the squared distances.

    Returns
    -------
    float
        At least 0; finite if the squared distances are.
    """
    fill_squared_distances(sample.columns, hypothesis, slopes)
    total = 0.0
    for bag in range(len(sample.positive)):
        members = slopes[sample.starts[bag] : sample.starts[bag + 1]]
        surprise = surprise_of_positive(members) if sample.positive[bag] else surprise_of_negative(members)
        total += sample.weights[bag] * surprise
        members *= sample.weights[bag]
    gradient[:] = 0.0
    n_features = hypothesis.shape[1]
    for j in range(len(slopes)):
        slope = slopes[j]
        if abs(slope) > _NEGLIGIBLE:
            point = sample.points[j]
            for k in range(n_features):
                offset = point[k] - hypothesis[0, k]
                gradient[0, k] += slope * offset
                gradient[1, k] += slope * offset * offset
    for k in range(n_features):
        scale = hypothesis[1, k]
        gradient[0, k] *= -2.0 * scale * scale
        gradient[1, k] *= 2.0 * scale
    return total


@kernel
def surprise_of_negative(members: NDArray[np.float64]) -> float:
    """Return -log prod (1 - p) of a bag, and replace squared distances by derivatives."""
    total, product = 0.0, 1.0
    for j in range(len(members)):
        p = CERTAINTY * math.exp(-members[j])
        product *= 1.0 - p
        if product < 1e-250:
            total -= math.log(product)
            product = 1.0
        members[j] = -p / (1.0 - p)
    return total - math.log(product)


@kernel
def surprise_of_positive(members: NDArray[np.float64]) -> float:
    """Return -log(1 - prod (1 - p)) of a bag, and replace squared distances by derivatives."""
    nearest = np.inf
    for j in range(len(members)):
        nearest = min(nearest, members[j])
    if nearest > _FAR:
        return _surprise_of_far_positive(members, nearest)
    log_none, none = 0.0, 1.0
    for j in range(len(members)):
        p = CERTAINTY * math.exp(-members[j])
        none *= 1.0 - p
        if nearest > _NEAR:
            log_none += math.log1p(-p)
        members[j] = p / (1.0 - p)
    # If all p are small, the logarithms retain digits that 1 - none has lost.
    some = -math.expm1(log_none) if nearest > _NEAR else 1.0 - none
    for j in range(len(members)):
        members[j] *= none / some
    return -math.log(some)


@kernel
def _surprise_of_far_positive(members: NDArray[np.float64], nearest: float) -> float:
    """Return the same for a bag without near instances, where the noisy-or is a sum too small for a float."""
    if nearest == np.inf:
        members[:] = 0.0
        return np.inf
    total = 0.0
    for j in range(len(members)):
        members[j] = math.exp(nearest - members[j])
        total += members[j]
    members /= total
    return nearest - math.log(CERTAINTY * total)


@kernel
def bag_log_odds(squared: NDArray[np.float64], starts: NDArray[np.int64]) -> NDArray[np.float64]:
    """Log odds of each bag being positive by the noisy-or, (n_bags,).

    `squared` (n,), the squared distances of the bags' points, is overwritten.
    """
    odds = np.empty(len(starts) - 1)
    for bag in range(len(odds)):
        members = squared[starts[bag] : starts[bag + 1]]
        kept = members.copy()
        odds[bag] = surprise_of_negative(kept) - surprise_of_positive(members)
    return odds


def instance_log_odds(squared: NDArray[np.float64]) -> NDArray[np.float64]:
    """Log odds of each instance being positive, from squared distances (n,)."""
    log_p = math.log(CERTAINTY) - squared
    odds: NDArray[np.float64] = log_p - np.log1p(-np.exp(log_p))
    return odds
