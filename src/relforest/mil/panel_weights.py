"""The weight of each panel of a committee, judged on bags that it was not trained on.

Letters: b bags, p panels.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from relforest.mil.logistic_rule import balance

# Pull towards equal weights, so that a few bags do not decide between panels.
_PULL: Final = 1.0
# Deviation that rounding alone gives to equal scores, relative to their size.
_EQUAL: Final = 1e-12


def score_spread(scores: NDArray[np.float64]) -> NDArray[np.float64]:
    """Standard deviation (p,) of each panel's scores (b, p); 1 if all are equal."""
    spread: NDArray[np.float64] = scores.std(axis=0)
    return np.where(spread > _EQUAL * np.abs(scores).max(axis=0), spread, 1.0)


def panel_weights(
    scores: NDArray[np.float64], positive: NDArray[np.bool_], bag_weights: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """Return non-negative weights of the panels and an intercept, for log odds with balanced classes.

    Parameters
    ----------
    scores : (b, p) float64
        Score of each bag by each panel; no panel was trained on the bags it scores.
    positive : (b,) bool
        Labels; both values occur.
    bag_weights : (b,) float64
        Weights of the bags; those of both classes are scaled to equal totals.

    Returns
    -------
    ((p,) float64, float)
        The minimum of the logistic loss, with equal weight for both classes, plus half the squared distance
        of the weights from 1 / p, both for scores divided by `score_spread`.
    """
    n_panels = scores.shape[1]
    mean, spread = scores.mean(axis=0), score_spread(scores)
    # The optimiser stops early if scores are far from 0.
    scaled = (scores - mean) / spread
    sign = np.where(positive, 1.0, -1.0)
    importance = balance(positive, bag_weights)
    equal = 1.0 / n_panels

    def loss(parameters: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        weights, intercept = parameters[:-1], parameters[-1]
        margin = sign * (scaled @ weights + intercept)
        # d/dm log(1 + exp(-m)), in a form that does not overflow.
        slope = -importance * sign * 0.5 * (1.0 - np.tanh(0.5 * margin))
        pull = weights - equal
        value = float(importance @ np.logaddexp(0.0, -margin) + 0.5 * _PULL * pull @ pull)
        return value, np.append(scaled.T @ slope + _PULL * pull, slope.sum())

    start = np.append(np.full(n_panels, equal), 0.0)
    bounds = [(0.0, None)] * n_panels + [(None, None)]
    best: NDArray[np.float64] = minimize(loss, start, jac=True, method="L-BFGS-B", bounds=bounds).x
    weights = best[:-1] / spread
    return weights, float(best[-1] - weights @ mean)
