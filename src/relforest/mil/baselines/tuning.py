"""Choosing C and the kernel width of baselines by cross-validation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, Literal, final

from joblib import effective_n_jobs
from sklearn.base import BaseEstimator
from sklearn.metrics import make_scorer
from sklearn.model_selection import GridSearchCV, ParameterGrid, StratifiedKFold
from sklearn.pipeline import Pipeline

from relforest.metrics import peirce_skill_score
from relforest.support.errors import InputError
from relforest.support.options import at_least, one_of
from relforest.support.progress import report
from relforest.support.rng import RandomState, generator, seed_sequence

# Settings nearest to the heuristic values come first, since the first of equally good settings wins.
_EXPONENTS: Final = {
    "full": (
        sorted(range(-4, 10), key=lambda power: (abs(power - 4), power)),
        sorted(range(-7, 8), key=lambda power: (abs(power), power)),
    ),
    "coarse": ([4, 2, 6, 0], [0, -2, 2, -4, 4]),
}


def svm_grid(size: Literal["full", "coarse"] = "full") -> dict[str, list[float]]:
    """Return values of C and of gamma's factor to try, starting with those nearest to the heuristic values.

    Parameters
    ----------
    size : {"full", "coarse"}
        "full": C from 1e-4 to 1e9 by powers of 10 and factors from 1/128 to 128 by powers of 2, 210 pairs.
        "coarse": C of 1, 100, 1e4 and 1e6, and five factors from 1/16 to 16, 20 pairs.

    Raises
    ------
    InputError
        If the size is unknown.

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
    random_state: RandomState = 0,
    n_jobs: int | None = None,
) -> TunedSearch:
    """Wrap a classifier of bags in a search for C and gamma's factor.

    Parameters
    ----------
    estimator : estimator with the parameters ``C`` and ``gamma_factor``, or a pipeline that ends in one
        A machine from this package, or a scikit-learn pipeline ending in one, such as
        ``make_pipeline(BagScaler(), MILESClassifier())``; other parameters do not change.
    grid : {"full", "coarse"}
        See `svm_grid`.
    n_splits : int
        Number of stratified folds; each class needs at least this many bags.
    random_state : int, Generator, RandomState, SeedSequence or None, default 0
        Seed of the folds, which are the same for all settings and for every fit of the search.
    n_jobs : int, optional
        Number of fits in parallel, passed to scikit-learn.

    Returns
    -------
    TunedSearch
        A `sklearn.model_selection.GridSearchCV`, unfitted. It takes a list of bags or an array, but no tuple
        ``(X, bag_ids)``, and chooses the setting with the highest mean Peirce skill score over the folds; in
        case of ties, the one nearest to the heuristic values. Parameters of a pipeline are prefixed with the
        name of the step, as in ``best_params_["milesclassifier__C"]``.

    Raises
    ------
    InputError
        If the estimator lacks these parameters, or an option is out of range. Fitting raises the errors of
        the estimator, and scikit-learn's error or warning if a class has fewer bags than folds.

    Notes
    -----
    With 5 folds, "full" takes 1051 fits and "coarse" 101. On one core and 100 bags of 3 instances with 2
    features, "coarse" took 3 seconds (mi-SVM, MI-SVM) to 8 (MILES); for Musk 2, 6598 instances with 166
    features, expect several minutes. "full" took 1 minute with MILES, and 3 to 5 with the others if their
    `max_solver_iter` was 100_000. With the default of 10 million, LIBSVM takes long if C is above 1e6, and
    "full" takes over 20 minutes; for Musk 2, expect an hour or more.

    References
    ----------
    Palmer (2015), section 3.3, Table 3.3.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest.mil.baselines import MILESClassifier, tuned
    >>> rng = np.random.default_rng(0)
    >>> bags = rng.normal(size=(40, 3, 2))
    >>> bags[:20, 0] = rng.normal([3, 3], 0.3, size=(20, 2))
    >>> search = tuned(MILESClassifier(random_state=0), grid="coarse")
    >>> search.fit(bags, [1] * 20 + [0] * 20).predict(bags[[0, 30]])
    array([1, 0])
    """
    prefix = _prefix_of_machine(estimator)
    values = {prefix + name: tried for name, tried in svm_grid(grid).items()}
    fold_seed = int(generator(seed_sequence(random_state)).integers(2**31))
    folds = StratifiedKFold(at_least("n_splits", n_splits, 2), shuffle=True, random_state=fold_seed)
    return TunedSearch(
        estimator,
        values,
        scoring=make_scorer(peirce_skill_score),
        cv=folds,
        n_jobs=n_jobs,
        error_score="raise",
    )


@final
class TunedSearch(GridSearchCV):  # type: ignore[misc]  # scikit-learn is untyped
    """A grid search that reports its progress (`relforest.support.progress`)."""

    def _run_search(self, evaluate_candidates: Callable[[list[dict[str, Any]]], object]) -> None:
        candidates = list(ParameterGrid(self.param_grid))
        # Enough settings at a time to keep all workers busy.
        step = effective_n_jobs(self.n_jobs)
        for first in range(0, len(candidates), step):
            report("tuning: settings", first, len(candidates))
            evaluate_candidates(candidates[first : first + step])


def _prefix_of_machine(estimator: BaseEstimator) -> str:
    """Return the prefix of the machine's parameters: empty, or the name of a step in a pipeline.

    Raises
    ------
    InputError
        If the estimator is not a machine.
    """
    machine, prefix = estimator, ""
    while isinstance(machine, Pipeline) and machine.steps:
        step, machine = machine.steps[-1]
        prefix += f"{step}__"
    names: dict[str, Any] = machine.get_params() if isinstance(machine, BaseEstimator) else {}
    lacking = [name for name in ("C", "gamma_factor") if name not in names]
    if lacking:
        raise InputError(
            f"{type(machine).__name__} does not have the parameter {lacking[0]!r}: only machines with a "
            "radial kernel can be tuned, alone or as the last step of a pipeline"
        )
    return prefix
