"""Logistic regression with an L2 penalty and equal weight for both classes.

The result is that of scikit-learn's `LogisticRegression` with the solver "lbfgs", which, however, changes
warning filters for all threads of the process.

Letters: b examples, k features.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.optimize import minimize
from sklearn._loss import HalfBinomialLoss

if TYPE_CHECKING:
    from numpy.typing import NDArray


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
    features : (b, k) float64
    positive : (b,) bool
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
    binomial = HalfBinomialLoss()

    def loss(parameters: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        weights, intercept = parameters[:-1], parameters[-1]
        losses, slopes = binomial.loss_gradient(target, features @ weights + intercept, importance)
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
