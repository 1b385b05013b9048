"""The search for C and the factor of gamma."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from sklearn.model_selection import StratifiedKFold, cross_val_score

from relforest import CovAggClassifier
from relforest.datasets import covariant1
from relforest.metrics import peirce_skill_score
from relforest.mil.peers import BagMarginSVMClassifier, MILESClassifier, svm_grid, tuned
from relforest.support.errors import InputError


def drawn() -> tuple[list[NDArray[np.float64]], NDArray[np.int64]]:
    bag_set = covariant1(np.random.default_rng(0), n_bags=40)
    bags = [np.array(bag) for bag in bag_set.bags]
    return [bag[1:] if i % 4 == 0 else bag for i, bag in enumerate(bags)], bag_set.labels.astype(np.int64)


def test_the_full_grid_is_that_of_the_source() -> None:
    grid = svm_grid()

    assert sorted(grid["C"]) == pytest.approx([10.0**power for power in range(-4, 10)])
    assert sorted(grid["gamma_factor"]) == [2.0**power for power in range(-7, 8)]


@pytest.mark.parametrize("size", ["full", "coarse"])
def test_the_heuristic_values_come_first(size: Literal["full", "coarse"]) -> None:
    grid = svm_grid(size)

    assert (grid["C"][0], grid["gamma_factor"][0]) == (1e4, 1.0)
    assert set(grid["C"]) <= set(svm_grid()["C"])
    assert set(grid["gamma_factor"]) <= set(svm_grid()["gamma_factor"])


def test_the_best_setting_by_skill_is_chosen() -> None:
    bags, y = drawn()
    model = BagMarginSVMClassifier(max_solver_iter=100_000)
    search = tuned(model, grid="coarse", n_splits=3).fit(bags, y)
    folds = StratifiedKFold(3, shuffle=True, random_state=0)

    def skill(estimator: Any, some_bags: Any, labels: Any) -> float:
        return peirce_skill_score(labels, estimator.predict(some_bags))

    again = cross_val_score(search.best_estimator_, bags, y, cv=folds, scoring=skill).mean()
    heuristic = cross_val_score(model, bags, y, cv=folds, scoring=skill).mean()
    assert search.best_score_ == pytest.approx(again)
    assert again >= heuristic
    assert search.best_estimator_.max_solver_iter == 100_000
    assert peirce_skill_score(y, search.predict(bags)) > 0.7


def test_of_equal_settings_the_heuristic_one_wins() -> None:
    bags = [np.full((2, 1), 8.0 * (i % 2)) for i in range(12)]
    search = tuned(BagMarginSVMClassifier(), grid="coarse", n_splits=3).fit(bags, np.arange(12) % 2)

    assert search.best_params_ == {"C": 1e4, "gamma_factor": 1.0}


def test_errors_of_the_estimator_come_through() -> None:
    bags, y = drawn()
    with pytest.raises(InputError, match="gamma must be 'heuristic'"):
        tuned(MILESClassifier(gamma="auto"), grid="coarse").fit(bags, y)


def test_bad_options_are_refused() -> None:
    with pytest.raises(InputError, match="CovAggClassifier has no parameter 'C'"):
        tuned(CovAggClassifier())
    with pytest.raises(InputError, match="n_splits must be an integer of at least 2, got 1"):
        tuned(MILESClassifier(), n_splits=1)
    size: Any = "fine"
    with pytest.raises(InputError, match="size must be one of 'full', 'coarse', got 'fine'"):
        tuned(MILESClassifier(), grid=size)
