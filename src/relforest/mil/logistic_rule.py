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


def balance(positive: NDArray[np.bool_], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return weights (b,) in proportion to others within a class, with the same total for both classes."""
    total = weights.sum()
    factors = total / (2.0 * weights[positive].sum()), total / (2.0 * weights[~positive].sum())
    balanced: NDArray[np.float64] = weights * np.where(positive, *factors)
    return balanced


def fit_logistic(
    features: NDArray[np.float64], positive: NDArray[np.bool_], weights: NDArray[np.float64], *, C: float
) -> tuple[NDArray[np.float64], float]:
    """Return factors (k,) of features and an intercept, for the log odds of the positive class.

    Parameters
    ----------
    features : (b, k) float64
    positive : (b,) bool
        Labels; both values occur.
    weights : (b,) float64
        Weights of the examples; those of both classes are scaled to equal totals.
    C : float
        Weight of the loss relative to the penalty, half the squared norm of the factors.

    Notes
    -----
    Stops at a tolerance or after 2000 steps; stopping early acts as regularisation.
    """
    target = positive.astype(np.float64)
    importance = balance(positive, weights)
    total = float(importance.sum())
    pull = 1.0 / (C * total)
    binomial = HalfBinomialLoss()

    def loss(parameters: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        factors, intercept = parameters[:-1], parameters[-1]
        losses, slopes = binomial.loss_gradient(target, features @ factors + intercept, importance)
        slopes /= total
        value = float(losses.sum() / total) + float(0.5 * pull * (factors @ factors))
        return value, np.append(features.T @ slopes + pull * factors, slopes.sum())

    start = np.zeros(features.shape[1] + 1)
    best: NDArray[np.float64] = minimize(
        loss,
        start,
        jac=True,
        method="L-BFGS-B",
        options={"maxiter": _MOST_STEPS, "maxls": _MOST_TRIALS, "gtol": _SLOPE, "ftol": _GAIN},
    ).x
    return best[:-1], float(best[-1])
