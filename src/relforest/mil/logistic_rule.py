"""Logistic regression with an L2 penalty and equal weight for both classes.

The result is that of scikit-learn's `LogisticRegression` with the solver "lbfgs", which, however, changes
warning filters for all threads of the process.

Letters: b examples, k features.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.optimize import minimize

from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["balance", "fit_logistic"]

_MOST_STEPS: Final = 2000
_MOST_TRIALS: Final = 50
_SLOPE: Final = 1e-4
_GAIN: Final = 64 * float(np.finfo(np.float64).eps)


def balance(positive: NDArray[np.bool_]) -> tuple[float, float]:
    """Return weights for negative and positive examples that give both classes equal total weight."""
    n_positive = np.count_nonzero(positive)
    return len(positive) / (2 * (len(positive) - n_positive)), len(positive) / (2 * n_positive)


def fit_logistic(
    features: NDArray[np.float64], positive: NDArray[np.bool_], *, C: float
) -> tuple[NDArray[np.float64], float]:
    """Return weights (k,) and an intercept for the log odds of the positive class.

    Parameters
    ----------
    features : (b, k) array
    positive : (b,) bool array
        Labels; both values occur.
    C : float
        Weight of the loss relative to the penalty, half the squared norm of the weights.

    Notes
    -----
    Stops at a tolerance or after 2000 steps; stopping early acts as regularisation.
    """
    target = positive.astype(np.float64)
    importance = np.where(positive, *reversed(balance(positive)))
    total = float(importance.sum())
    pull = 1.0 / (C * total)

    def loss(parameters: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        weights, intercept = parameters[:-1], parameters[-1]
        losses, slopes = _pointwise(target, features @ weights + intercept, importance)
        slopes /= total
        value = float(losses.sum() / total) + float(0.5 * pull * (weights @ weights))
        return value, np.append(features.T @ slopes + pull * weights, slopes.sum())

    start = np.zeros(features.shape[1] + 1)
    best: NDArray[np.float64] = minimize(
        loss,
        start,
        jac=True,
        method="L-BFGS-B",
        options={"maxiter": _MOST_STEPS, "maxls": _MOST_TRIALS, "gtol": _SLOPE, "ftol": _GAIN},
    ).x
    return best[:-1], float(best[-1])


@kernel
def _pointwise(
    target: NDArray[np.float64], odds: NDArray[np.float64], importance: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the loss of each example and its derivative with respect to the log odds.

    Each range has a form in which exponentials do not overflow and no digits are lost.
    """
    losses, slopes = np.empty(len(odds)), np.empty(len(odds))
    for i in range(len(odds)):
        y, x = target[i], odds[i]
        if x <= -37.0:
            small = math.exp(x)
            losses[i] = small - y * x
            slopes[i] = small - y
        elif x <= -2.0:
            small = math.exp(x)
            losses[i] = math.log1p(small) - y * x
            slopes[i] = ((1.0 - y) * small - y) / (1.0 + small)
        else:
            small = math.exp(-x)
            losses[i] = (math.log1p(small) if x <= 18.0 else small) + (1.0 - y) * x
            slopes[i] = ((1.0 - y) - y * small) / (1.0 + small)
        losses[i] *= importance[i]
        slopes[i] *= importance[i]
    return losses, slopes
