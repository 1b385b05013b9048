"""Scores of bags that were left out of training, and probabilities from them.

Letters: b bags.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.random import RandomState as LegacyGenerator
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import expit

# Bounds of the factor of scores, in units of 1 / the largest score.
_FLATTEST: Final = 1e-3
_STEEPEST: Final = 1e6


def split_bags(
    positive: NDArray[np.bool_], n_splits: int, rng: np.random.Generator
) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Return training and left-out bags of each split; if splitting is impossible, all bags are both."""
    n_splits = min(n_splits, int(positive.sum()), int((~positive).sum()))
    if n_splits < 2:
        return [(np.arange(len(positive)),) * 2]
    # The folds of scikit-learn's `StratifiedKFold`, which would change warning filters for all threads.
    shuffler = LegacyGenerator(int(rng.integers(2**31)))
    fold = np.empty(len(positive), dtype=np.int64)
    n_dealt = 0
    for is_member in (positive == positive[0], positive != positive[0]):
        n_members = int(np.count_nonzero(is_member))
        dealt = np.sort(np.arange(n_dealt, n_dealt + n_members) % n_splits)
        shuffler.shuffle(dealt)
        fold[is_member] = dealt
        n_dealt += n_members
    return [(np.flatnonzero(fold != number), np.flatnonzero(fold == number)) for number in range(n_splits)]


def log_odds_factor(
    scores: NDArray[np.float64], positive: NDArray[np.bool_], weights: NDArray[np.float64]
) -> float:
    """Return the factor a > 0 for which a times the score fits best as the log odds of a positive bag.

    Parameters
    ----------
    scores : (b,) float64
        Scores of bags that were left out of training; a score of 0 stands for even odds.
    positive : (b,) bool
    weights : (b,) float64
        Weights of the bags, above 0.

    Notes
    -----
    The logistic loss is minimised, as by Platt (1999), who has an intercept too; without it, probabilities
    agree with predicted labels. His targets, (n + 1) / (n + 2) for a class of n bags and 1 minus that for the
    other one, keep the factor finite if the scores part the classes.
    """
    largest = float(np.abs(scores).max())
    if largest == 0.0:
        return 1.0
    scaled = scores / largest
    n_positive, n_negative = weights[positive].sum(), weights[~positive].sum()
    target = np.where(positive, (n_positive + 1.0) / (n_positive + 2.0), 1.0 / (n_negative + 2.0))

    def slope(factor: float) -> float:
        return float((weights * scaled) @ (expit(factor * scaled) - target))

    if slope(_FLATTEST) >= 0.0:
        return _FLATTEST / largest
    if slope(_STEEPEST) <= 0.0:
        return _STEEPEST / largest
    return float(brentq(slope, _FLATTEST, _STEEPEST)) / largest
