"""Sparse linear machines: L1 penalty and squared hinge loss, by coordinate descent.

The algorithm and its results are those of LIBLINEAR, to the last bit. LIBLINEAR, however, shares one random
generator within a process, so its result depends on what other threads train at the same time; here every
machine has its own generator, NumPy's Mersenne twister, which draws the same numbers.

Dimensions: n examples; k features, including the intercept.

References
----------
Fan et al. (2008), "LIBLINEAR: a library for large linear classification", JMLR 9, appendix; Yuan et al.
(2010), "A comparison of optimization methods and software for large-scale L1-regularized linear
classification", JMLR 11.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple, final

import numpy as np
from numpy.random import MT19937
from numpy.random import RandomState as LegacyGenerator

from relforest.support.jit import kernel
from relforest.support.progress import report

if TYPE_CHECKING:
    from numpy.typing import NDArray


_PASSES_PER_REPORT: Final = 50
_MOST_HALVINGS: Final = 20
_DECREASE: Final = 0.01
_LEAST_CURVATURE: Final = 1e-12
_LEAST_STEP: Final = 1e-12


@final
@dataclass(frozen=True, slots=True, eq=False)
class SparseMachine:
    """A linear function of features.

    Attributes
    ----------
    coefficients : (k,) float64
        Weights without the intercept; many are 0.
    intercept : float
    n_passes : int
        Passes over the features.
    converged : bool
        Whether the tolerance was reached in fewer passes than allowed.
    """

    coefficients: NDArray[np.float64]
    intercept: float
    n_passes: int
    converged: bool


class Descent(NamedTuple):
    """A machine in training."""

    columns: NDArray[np.float64]  # (k, n) features times the sign of the class
    prices: NDArray[np.float64]  # (n,) price of slack
    curvatures: NDArray[np.float64]  # (k,) upper bounds of half the second derivatives
    weights: NDArray[np.float64]  # (k,)
    slack: NDArray[np.float64]  # (n,) 1 minus the margin
    order: NDArray[np.int64]  # (k,) the active features first


def train_sparse_machine(
    features: NDArray[np.float64],
    positive: NDArray[np.bool_],
    prices: NDArray[np.float64],
    *,
    fit_intercept: bool,
    tol: float,
    max_passes: int,
    seed: int,
) -> SparseMachine:
    """Minimise ``sum_k |w_k| + sum_i price_i max(0, 1 - margin_i)^2``.

    Parameters
    ----------
    features : (n, k) float64
    positive : (n,) bool
        Labels; both values occur.
    prices : (n,) float64
        Price of slack of each example.
    fit_intercept : bool
        Whether to add an intercept, which is penalised like a weight.
    tol : float
        Training stops when the violations of the optimality conditions add up to less than `tol` times their
        sum in the first pass, times the share of the smaller class.
    max_passes : int
        Largest number of passes over the features.
    seed : int
        Seed of the order of the features.
    """
    if features.shape[1] + fit_intercept == 0:
        return SparseMachine(np.empty(0), 0.0, 0, converged=True)
    # Negative examples first, so that sums are rounded as in LIBLINEAR.
    grouped = np.argsort(positive, kind="stable")
    sign = np.where(positive[grouped], 1.0, -1.0)
    columns = np.empty((features.shape[1] + fit_intercept, len(features)))
    columns[: features.shape[1]] = features[grouped].T
    columns[features.shape[1] :] = 1.0
    columns *= sign
    example_prices = prices[grouped]
    # Summed one after the other, as in LIBLINEAR.
    curvatures = np.cumsum(example_prices * columns * columns, axis=1)[:, -1].copy()
    n_weights, n_examples = columns.shape
    descent = Descent(
        columns, example_prices, curvatures, np.zeros(n_weights), np.ones(n_examples), np.arange(n_weights)
    )
    n_positive = int(np.count_nonzero(positive))
    tol *= max(1, min(n_positive, n_examples - n_positive))
    tol /= n_examples
    n_passes = _descend(descent, tol, max_passes, _generator(seed))
    weights = descent.weights[: features.shape[1]]
    intercept = float(descent.weights[-1]) if fit_intercept else 0.0
    return SparseMachine(weights.copy(), intercept, n_passes, n_passes < max_passes)


def _generator(seed: int) -> np.random.Generator:
    """Return LIBLINEAR's generator for a seed, from which scikit-learn derives that of LIBLINEAR."""
    bits = MT19937()
    LegacyGenerator(bits).seed(LegacyGenerator(seed).randint(2**31 - 1))
    return np.random.Generator(bits)


def _descend(descent: Descent, tol: float, max_passes: int, rng: np.random.Generator) -> int:
    """Make passes until the violations are small enough, at most `max_passes`; return their number."""
    n_weights, n_examples = descent.columns.shape
    left = np.arange(n_weights, 0, -1)
    n_active, largest, first_sum = n_weights, np.inf, 0.0
    for number in range(max_passes):
        if number % _PASSES_PER_REPORT == 0:
            report("training a linear machine: passes", number, max_passes)
        swaps = rng.integers(left[n_weights - n_active :])
        if n_active:
            # LIBLINEAR draws a number even where there is no choice.
            rng.bit_generator.random_raw()
        n_active, largest, total = _pass(descent, swaps, largest / n_examples)
        first_sum = first_sum if number else total
        if total <= tol * first_sum:
            if n_active == n_weights:
                return number + 1
            # Features that were set aside must be checked again.
            n_active, largest = n_weights, np.inf
    return max_passes


@kernel
def _pass(descent: Descent, swaps: NDArray[np.int64], margin: float) -> tuple[int, float, float]:
    """Improve every active weight once, in random order.

    Return the number of features still active, the largest violation, and the sum of violations.
    """
    order, weights = descent.order, descent.weights
    n_active = len(swaps)
    for place in range(n_active):
        other = place + swaps[place]
        order[place], order[other] = order[other], order[place]
    largest, total = 0.0, 0.0
    place = 0
    while place < n_active:
        k = order[place]
        slope, curvature = _derivatives(descent.columns[k], descent.prices, descent.slack)
        if weights[k] == 0.0 and slope + 1.0 > margin and slope - 1.0 < -margin:
            n_active -= 1
            order[place], order[n_active] = order[n_active], order[place]
            continue
        violation = _violation(weights[k], slope)
        largest = max(largest, violation)
        total += violation
        step = _newton_step(weights[k], slope, curvature)
        if abs(step) >= _LEAST_STEP:
            _move(descent, k, step, slope)
        place += 1
    return n_active, largest, total


@kernel
def _derivatives(
    column: NDArray[np.float64], prices: NDArray[np.float64], slack: NDArray[np.float64]
) -> tuple[float, float]:
    """Return the first and second derivative of the loss with respect to one weight."""
    slope, curvature = 0.0, 0.0
    for i in range(len(slack)):
        if slack[i] > 0.0:
            priced = prices[i] * column[i]
            slope -= priced * slack[i]
            curvature += priced * column[i]
    return 2.0 * slope, max(2.0 * curvature, _LEAST_CURVATURE)


@kernel
def _violation(weight: float, slope: float) -> float:
    """Return the violation of a weight's optimality condition."""
    if weight > 0.0:
        return abs(slope + 1.0)
    if weight < 0.0:
        return abs(slope - 1.0)
    return max(-(slope + 1.0), slope - 1.0, 0.0)


@kernel
def _newton_step(weight: float, slope: float, curvature: float) -> float:
    """Return the step to the minimum of the quadratic model plus |weight|."""
    if slope + 1.0 < curvature * weight:
        return -(slope + 1.0) / curvature
    if slope - 1.0 > curvature * weight:
        return -(slope - 1.0) / curvature
    return -weight


@kernel
def _move(descent: Descent, k: int, step: float, slope: float) -> None:
    """Change a weight by a step, halving the step until the objective decreases enough."""
    column, prices, slack, weights = descent.columns[k], descent.prices, descent.slack, descent.weights
    penalty = abs(weights[k] + step) - abs(weights[k])
    promised = penalty + slope * step
    made, before = 0.0, 0.0
    for halving in range(_MOST_HALVINGS):
        rest = abs(weights[k] + step) - abs(weights[k]) - _DECREASE * promised
        change = made - step
        # Often a bound on the loss is enough, and the loss need not be computed.
        if descent.curvatures[k] * step * step + slope * step + rest <= 0.0:
            for i in range(len(slack)):
                slack[i] += change * column[i]
            weights[k] += step
            return
        if halving == 0:
            before = _loss(column, prices, slack)
        for i in range(len(slack)):
            slack[i] += change * column[i]
        if rest + _loss(column, prices, slack) - before <= 0.0:
            weights[k] += step
            return
        made = step
        step *= 0.5
        promised *= 0.5
    weights[k] += step
    # Rounding errors may have accumulated in the slack.
    slack[:] = 1.0
    for j in range(len(weights)):
        if weights[j] != 0.0:
            for i in range(len(slack)):
                slack[i] -= weights[j] * descent.columns[j, i]


@kernel
def _loss(column: NDArray[np.float64], prices: NDArray[np.float64], slack: NDArray[np.float64]) -> float:
    """Loss of the examples in which the feature is not 0."""
    loss = 0.0
    for i in range(len(slack)):
        if column[i] != 0.0 and slack[i] > 0.0:
            loss += prices[i] * slack[i] * slack[i]
    return loss
