"""What trees say, weighed by a linear support vector machine that is driven by the Peirce skill score.

Letters: n scenes, k columns, each what some trees say about every scene.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple
from warnings import catch_warnings, simplefilter

import numpy as np
from scipy.special import log_expit, logit
from sklearn.exceptions import ConvergenceWarning
from sklearn.linear_model import LogisticRegression
from sklearn.model_selection import StratifiedKFold
from sklearn.svm import LinearSVC

from relforest.support.progress import part

if TYPE_CHECKING:
    from numpy.typing import NDArray

COSTS: Final = tuple(10.0**power for power in range(-4, 4))
"""The values of C that are tried."""

FOLDS: Final = 10
"""Parts of the scenes, each judged by what the others teach. Every class needs as many scenes."""

# Columns that deviate less are constant but for rounding.
_CONSTANT: Final = 1e-9

# Of the machine. Columns that say nearly the same would take ten times as many to change the last digits.
_MOST_STEPS: Final = 100

# Close to no penalty: calibration has two parameters.
_FREE: Final = 1e6


class Weighing(NamedTuple):
    """A weighted sum of columns as log-odds, and from where on it says yes."""

    weights: NDArray[np.float64]  # (k,)
    start: float
    cost: float  # C
    skill: float  # Peirce skill score in cross-validation, by weight
    boundary: float  # the log-odds on the separating plane of the machine
    losses: NDArray[np.float64]  # (n,) negative log likelihood of every scene in cross-validation


def weighed(
    columns: NDArray[np.float64],
    positive: NDArray[np.bool_],
    weights: NDArray[np.float64],
    rng: np.random.Generator,
) -> Weighing:
    """Weigh columns (n, k) such that their sum tells positive scenes from others.

    At least `FOLDS` scenes are of either kind, and their weights (n,) are positive.

    Notes
    -----
    The machine counts both classes alike, as the Peirce skill score does. C is the power of ten with the
    highest score in cross-validation, the least if there are several. Its margins there are calibrated by a
    logistic curve (Platt 1999, with his smoothed targets); one that falls is replaced by a constant.

    References
    ----------
    Palmer (2015), section 5.2.3 and 5.3.
    """
    scales = columns.std(axis=0)
    scales[scales < _CONSTANT] = 1.0
    scaled = columns / scales
    balanced = (
        weights / np.where(positive, weights[positive].sum(), weights[~positive].sum()) * len(weights) / 2
    )
    folds = StratifiedKFold(FOLDS, shuffle=True, random_state=int(rng.integers(2**31)))
    splits = list(folds.split(scaled, positive))

    def machine(cost: float, scenes: NDArray[np.int64]) -> LinearSVC:
        found = LinearSVC(C=cost, dual=False, max_iter=_MOST_STEPS)
        return found.fit(scaled[scenes], positive[scenes], sample_weight=balanced[scenes])

    best, skill_of_best = COSTS[0], -np.inf
    margins = np.empty(len(positive))
    with part("weighing trees"), catch_warnings():
        # Whether a machine that stopped early is good enough, cross-validation says.
        simplefilter("ignore", ConvergenceWarning)
        for cost in COSTS:
            found = np.empty(len(positive))
            for training, held in splits:
                found[held] = machine(cost, training).decision_function(scaled[held])
            skill = weighted_skill(positive, found > 0.0, weights)
            if skill > skill_of_best:
                best, skill_of_best, margins = cost, skill, found
        chosen = machine(best, np.arange(len(positive)))
    slope, start = _calibrated(margins, positive, weights)
    total = slope * chosen.coef_[0] / scales
    losses = -log_expit(np.where(positive, 1.0, -1.0) * (slope * margins + start))
    return Weighing(
        total, float(slope * chosen.intercept_[0] + start), best, skill_of_best, start, np.asarray(losses)
    )


def weighted_skill(
    positive: NDArray[np.bool_], said: NDArray[np.bool_], weights: NDArray[np.float64]
) -> float:
    """Return the Peirce skill score of scenes with weights: hit rate minus false alarm rate."""
    hits, alarms = (float(np.average(said[of], weights=weights[of])) for of in (positive, ~positive))
    return hits - alarms


def _calibrated(
    margins: NDArray[np.float64], positive: NDArray[np.bool_], weights: NDArray[np.float64]
) -> tuple[float, float]:
    """Return slope and start of the log-odds as a function of the margin (n,)."""
    counts = np.array([np.count_nonzero(~positive), np.count_nonzero(positive)])
    share = np.where(positive, (counts[1] + 1) / (counts[1] + 2), 1 / (counts[0] + 2))
    curve = LogisticRegression(C=_FREE, max_iter=1000)
    curve.fit(
        np.tile(margins, 2)[:, None],
        np.repeat([1, 0], len(margins)),
        sample_weight=np.concatenate([weights * share, weights * (1.0 - share)]),
    )
    slope = float(curve.coef_[0, 0])
    if slope <= 0.0:
        return 0.0, float(logit(np.average(positive, weights=weights)))
    return slope, float(curve.intercept_[0])
