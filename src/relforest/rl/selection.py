"""The wrapper that decides which candidate tree joins the representation (Palmer (2015), section 6.3).

A candidate is worth its features if the policy learned with them has Bellman errors so much smaller that
chance does not explain it. Errors are measured in standard deviations of the policy's own values, because a
richer representation usually spreads the values, and would be punished for that otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

from scipy import stats

from relforest.rl.bellman import Lookahead


@final
@dataclass(frozen=True, slots=True)
class Fit:
    """How well a representation lets LSPI fit the samples."""

    squared_error: float
    """Sum of squared Bellman errors in units of the variance of the values; infinite where the values are
    constant."""
    n_features: int  # features in use
    n_samples: int  # transitions


def fit_of(lookahead: Lookahead, n_features: int) -> Fit:
    """Summarise the outcome of LSPI for the test.

    Notes
    -----
    A constant action-value function (nothing learned yet) has standard deviation 0 and so an
    infinite scaled error: the first tree with any fit passes.
    """
    spread = float(lookahead.values.std())
    # Sums of equal numbers differ by rounding only.
    constant = spread <= 1e-12 * float(abs(lookahead.values).max(initial=0.0))
    scaled = math.inf if constant else lookahead.squared_error / spread**2
    return Fit(scaled, n_features, len(lookahead.values))


def f_test(old: Fit, new: Fit) -> tuple[float, float]:
    """Return statistic (perhaps infinite) and p-value of the features that `new` has more than `old`.

    F = ((SS0 - SS1) / (k1 - k0)) / (SS1 / (n - k1)), with k1 - k0 and n - k1 degrees of freedom, where k
    counts the features in use. Without added features, improvement or degrees of freedom the p-value is 1.

    Examples
    --------
    >>> f_test(Fit(120.0, 2, 104), Fit(100.0, 4, 104))[0]
    10.0
    """
    added, free = new.n_features - old.n_features, new.n_samples - new.n_features
    if added <= 0 or free <= 0 or not new.squared_error < old.squared_error:
        return 0.0, 1.0
    if math.isinf(old.squared_error) or new.squared_error == 0.0:
        return math.inf, 0.0
    statistic = ((old.squared_error - new.squared_error) / added) / (new.squared_error / free)
    return statistic, float(stats.f.sf(statistic, added, free))


def select(old: Fit, candidates: Sequence[Fit], threshold: float) -> int | None:
    """Return which candidate to accept: the one with the lowest p-value, if that lies below `threshold`.

    Among equal p-values (0 by underflow, most often) the larger statistic wins, then the smaller error, then
    the earlier candidate.
    """
    keys = []
    for position, candidate in enumerate(candidates):
        statistic, p_value = f_test(old, candidate)
        keys.append((p_value, -statistic, candidate.squared_error, position))
    best = min(keys, default=None)
    return best[-1] if best is not None and best[0] < threshold else None
