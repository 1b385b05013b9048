"""The search for C and the factor of gamma."""

from __future__ import annotations

import itertools
from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from sklearn.model_selection import cross_val_score
from sklearn.pipeline import Pipeline, make_pipeline

from relforest import CovAggClassifier
from relforest.datasets import covariant1
from relforest.metrics import peirce_skill_score
from relforest.mil.baselines import BagMarginSVMClassifier, MILESClassifier, svm_grid, tuned
from relforest.mil.scaling import BagScaler
from relforest.support.errors import InputError


def drawn() -> tuple[list[NDArray[np.float64]], NDArray[np.int64]]:
    bag_set = covariant1(np.random.default_rng(0), n_bags=40)
    bags = [np.array(bag) for bag in bag_set.bags]
    return [bag[1:] if i % 4 == 0 else bag for i, bag in enumerate(bags)], bag_set.labels.astype(np.int64)


def skill(estimator: Any, bags: Any, labels: Any) -> float:
    return peirce_skill_score(labels, estimator.predict(bags))


def folds_of(random_state: Any) -> list[list[int]]:
    cv = tuned(MILESClassifier(), n_splits=3, random_state=random_state).cv
    return [test.tolist() for _, test in cv.split(np.zeros(12), np.arange(12) % 2)]


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
    again = cross_val_score(search.best_estimator_, bags, y, cv=search.cv, scoring=skill).mean()
    heuristic = cross_val_score(model, bags, y, cv=search.cv, scoring=skill).mean()
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


@pytest.mark.parametrize("seed", [0, 2**40, np.int64(7)])
def test_an_integer_repeats_the_folds(seed: Any) -> None:
    assert folds_of(seed) == folds_of(seed)
    assert sorted(itertools.chain(*folds_of(seed))) == list(range(12))


def test_seeds_may_be_all_that_the_library_takes() -> None:
    assert folds_of(np.random.SeedSequence(5)) == folds_of(5)
    rng = np.random.default_rng(0)
    assert folds_of(rng) != folds_of(rng)
    cv = tuned(MILESClassifier(), random_state=None).cv
    first, second = ([test.tolist() for _, test in cv.split(np.zeros(20), np.arange(20) % 2)] for _ in "12")
    assert first == second


@pytest.mark.parametrize("seed", [-1, 0.5, True, "0"])
def test_other_seeds_are_refused(seed: Any) -> None:
    with pytest.raises(InputError, match="random_state must be an integer of at least 0"):
        tuned(MILESClassifier(), random_state=seed)


def test_a_machine_at_the_end_of_a_pipeline_is_tuned() -> None:
    # The second feature is a million times what it was: unscaled, only it would count.
    bags, y = drawn()
    stretched = [bag * np.array([1.0, 1e6]) for bag in bags]
    pipeline = make_pipeline(BagScaler(), BagMarginSVMClassifier(max_solver_iter=100_000))
    search = tuned(pipeline, grid="coarse", n_splits=3).fit(stretched, y)
    found = search.best_estimator_
    again = cross_val_score(found, stretched, y, cv=search.cv, scoring=skill).mean()

    assert search.best_params_ == {
        "bagmarginsvmclassifier__C": found[-1].C,
        "bagmarginsvmclassifier__gamma_factor": found[-1].gamma_factor,
    }
    assert len(search.cv_results_["params"]) == 20
    assert search.best_score_ == pytest.approx(again)
    assert found[-1].max_solver_iter == 100_000
    assert peirce_skill_score(y, search.predict(stretched)) > 0.7


def test_pipelines_may_be_nested() -> None:
    inner = Pipeline([("scale", BagScaler()), ("machine", MILESClassifier())])
    search = tuned(Pipeline([("outer", inner)]))

    assert set(search.param_grid) == {"outer__machine__C", "outer__machine__gamma_factor"}


@pytest.mark.parametrize(
    ("estimator", "name"),
    [
        (CovAggClassifier(), "CovAggClassifier"),
        (make_pipeline(MILESClassifier(), BagScaler()), "BagScaler"),
        (make_pipeline(BagScaler(), CovAggClassifier()), "CovAggClassifier"),
        (Pipeline([("scale", BagScaler()), ("none", "passthrough")]), "str"),
        (Pipeline([]), "Pipeline"),
    ],
)
def test_what_has_no_radial_kernel_is_refused(estimator: Any, name: str) -> None:
    message = f"{name} does not have the parameter 'C': only machines with a radial kernel .* of a pipeline"
    with pytest.raises(InputError, match=message):
        tuned(estimator)


def test_bad_options_are_refused() -> None:
    with pytest.raises(InputError, match="n_splits must be an integer of at least 2, got 1"):
        tuned(MILESClassifier(), n_splits=1)
    size: Any = "fine"
    with pytest.raises(InputError, match="size must be one of 'full', 'coarse', got 'fine'"):
        tuned(MILESClassifier(), grid=size)
