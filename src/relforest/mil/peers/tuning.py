"""Peers whose C and kernel width are chosen by cross-validation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Literal

from sklearn.metrics import make_scorer
from sklearn.model_selection import GridSearchCV, StratifiedKFold

from relforest.metrics import peirce_skill_score
from relforest.support.errors import InputError
from relforest.support.options import at_least, one_of

if TYPE_CHECKING:
    from sklearn.base import BaseEstimator

# Nearest to the heuristic values first: the first of equally good settings wins.
_EXPONENTS: Final = {
    "full": (
        sorted(range(-4, 10), key=lambda power: (abs(power - 4), power)),
        sorted(range(-7, 8), key=lambda power: (abs(power), power)),
    ),
    "coarse": ([4, 2, 6, 0], [0, -2, 2, -4, 4]),
}


def svm_grid(size: Literal["full", "coarse"] = "full") -> dict[str, list[float]]:
    """Return values of C and of the factor of gamma to try, those nearest to the heuristic ones first.

    Parameters
    ----------
    size : {"full", "coarse"}
        "full": C from 1e-4 to 1e9 by powers of 10 and factors from 1/128 to 128 by powers of 2, 210 pairs.
        "coarse": 4 and 5 values of them, 20 pairs: C of 1, 100, 1e4 and 1e6, factors from 1/16 to 16.

    Raises
    ------
    InputError
        If the size is neither of the two.

    References
    ----------
    Palmer (2015), section 3.3, Table 3.3.
    """
    costs, factors = _EXPONENTS[one_of("size", size, tuple(_EXPONENTS))]
    return {"C": [10.0**power for power in costs], "gamma_factor": [2.0**power for power in factors]}


def tuned(
    estimator: BaseEstimator,
    *,
    grid: Literal["full", "coarse"] = "full",
    n_splits: int = 5,
    random_state: int = 0,
    n_jobs: int | None = None,
) -> GridSearchCV:
    """Wrap a classifier of bags in a search for C and the factor of gamma.

    Parameters
    ----------
    estimator : estimator with the parameters ``C`` and ``gamma_factor``
        Any machine of this package; its other parameters stay as they are. A `max_solver_iter` of, say,
        100_000 keeps settings far from sensible from taking hours.
    grid : {"full", "coarse"}
        See `svm_grid`.
    n_splits : int
        Number of stratified folds; each class needs as many bags.
    random_state : int
        Seed of the division into folds.
    n_jobs : int, optional
        Passed to scikit-learn: how many fits run at the same time.

    Returns
    -------
    GridSearchCV
        Unfitted. It takes a list of bags or an array, but no ``(X, bag_ids)``, and chooses the highest mean
        Peirce skill score over the folds; of equal ones, the setting nearest to the heuristic values.

    Raises
    ------
    InputError
        If the estimator has no such parameters, or an option is out of range. Fitting raises what the
        estimator raises, and scikit-learn's error or warning if a class has fewer bags than there are folds.

    References
    ----------
    Palmer (2015), section 3.3, Table 3.3.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest.mil.peers import MILESClassifier, tuned
    >>> rng = np.random.default_rng(0)
    >>> bags = rng.normal(size=(40, 3, 2))
    >>> bags[:20, 0] = rng.normal([3, 3], 0.3, size=(20, 2))
    >>> search = tuned(MILESClassifier(random_state=0), grid="coarse")
    >>> search.fit(bags, [1] * 20 + [0] * 20).predict(bags[[0, 30]])
    array([1, 0])
    """
    values: dict[str, Any] = svm_grid(grid)
    lacking = sorted(set(values) - set(estimator.get_params()))
    if lacking:
        raise InputError(
            f"{type(estimator).__name__} has no parameter {lacking[0]!r}: only machines with a radial kernel "
            "can be tuned like this"
        )
    folds = StratifiedKFold(at_least("n_splits", n_splits, 2), shuffle=True, random_state=random_state)
    return GridSearchCV(
        estimator,
        values,
        scoring=make_scorer(peirce_skill_score),
        cv=folds,
        n_jobs=n_jobs,
        error_score="raise",
    )
