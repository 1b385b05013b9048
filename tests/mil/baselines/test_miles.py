"""MILES: its features by a loop, its machine, and what must not matter to it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from sklearn.svm import LinearSVC

from interpreted import compiled_only
from relforest.datasets import disjunctive
from relforest.metrics import peirce_skill_score
from relforest.mil.baselines import MILESClassifier, miles
from relforest.mil.baselines.miles import embed
from relforest.scenes.bags import as_bags
from relforest.support.errors import InputError

Floats = NDArray[np.float64]
# With this C the solution is unique enough to compare.
PRECISE: dict[str, Any] = {"C": 1.0, "tol": 1e-4, "max_iter": 100_000}


def drawn(seed: int = 0) -> tuple[list[Floats], NDArray[np.int64]]:
    bag_set = disjunctive(np.random.default_rng(seed), n_bags=40)
    bags = [np.array(bag) for bag in bag_set.bags]
    return [bag[:-1] if i % 3 == 0 else bag for i, bag in enumerate(bags)], bag_set.labels.astype(np.int64)


def slow_embed(bags: list[Floats], prototypes: Floats, gamma: float) -> Floats:
    return np.array(
        [[max(np.exp(-gamma * np.sum((x - p) ** 2)) for x in bag) for p in prototypes] for bag in bags]
    )


@given(st.integers(0, 1000), st.floats(0.01, 10), st.lists(st.integers(1, 4), min_size=1, max_size=5))
def test_features_agree_with_a_loop(seed: int, gamma: float, sizes: list[int]) -> None:
    rng = np.random.default_rng(seed)
    bags = [rng.normal(size=(size, 2)) for size in sizes]
    prototypes = rng.normal(size=(3, 2))

    found = embed(as_bags(bags), prototypes, gamma)
    np.testing.assert_allclose(found, slow_embed(bags, prototypes, gamma), atol=1e-12)


def test_features_come_in_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    bags, _ = drawn()
    prototypes = np.concatenate(bags)[:7]
    monkeypatch.setattr(miles, "_BLOCK", 1)

    found = embed(as_bags(bags), prototypes, 0.5)
    np.testing.assert_allclose(found, slow_embed(bags, prototypes, 0.5), atol=1e-12)


@compiled_only
@pytest.mark.parametrize("intercept", [False, True])
def test_the_machine_is_a_sparse_linear_one_on_the_features(*, intercept: bool) -> None:
    bags, y = drawn()
    options = {**PRECISE, "fit_intercept": intercept, "random_state": 0}
    model = MILESClassifier(**options).fit(bags, y)
    features = slow_embed(bags, np.unique(np.concatenate(bags), axis=0), model.gamma_)
    expected = LinearSVC(penalty="l1", loss="squared_hinge", dual=False, **options).fit(features, y)

    assert model.converged_
    assert 0 < len(model.prototypes_) == len(model.coef_) < features.shape[1]
    assert intercept or model.intercept_ == 0.0
    np.testing.assert_allclose(model.decision_function(bags), expected.decision_function(features), atol=2e-2)


@compiled_only
def test_scores_on_fresh_bags() -> None:
    rng = np.random.default_rng(0)
    train, test = disjunctive(rng), disjunctive(rng)
    model = MILESClassifier(random_state=0).fit(train.bags, train.labels)

    # 60 other draws gave a mean of 0.48.
    assert peirce_skill_score(test.labels, model.predict(test.bags)) > 0.25


@compiled_only
def test_neither_order_nor_place_matters() -> None:
    bags, y = drawn()
    rng = np.random.default_rng(3)
    order = rng.permutation(len(bags))
    shift = np.array([10.0, -5.0])
    moved = [rng.permutation(bags[i]) + shift for i in order]
    expected = MILESClassifier(**PRECISE, random_state=0).fit(bags, y).decision_function(bags)

    scores = MILESClassifier(**PRECISE, random_state=1).fit(moved, y[order]).decision_function(moved)
    np.testing.assert_allclose(scores, expected[order], atol=2e-2)


@compiled_only
def test_the_same_seed_gives_the_same_machine() -> None:
    bags, y = drawn()
    models = [MILESClassifier(max_iter=20, random_state=7).fit(bags, y) for _ in range(2)]

    assert (models[0].n_iter_, models[0].converged_) == (20, False)
    np.testing.assert_array_equal(models[0].coef_, models[1].coef_)


@compiled_only
def test_duplicate_instances_count_once() -> None:
    bags, y = drawn()
    doubled = [np.concatenate([bag, bag]) for bag in bags]
    gamma = 0.3
    once = MILESClassifier(gamma=gamma, random_state=0).fit(bags, y)
    twice = MILESClassifier(gamma=gamma, random_state=0).fit(doubled, y)

    np.testing.assert_allclose(twice.decision_function(bags), once.decision_function(bags), atol=1e-6)


def test_a_price_too_small_leaves_no_prototype() -> None:
    # All weights are 0, and a score of 0 is positive.
    bags, y = drawn()
    model = MILESClassifier(C=1e-6, random_state=0).fit(bags, y)

    assert len(model.prototypes_) == 0
    assert model.decision_function(bags).tolist() == [0.0] * len(bags)
    assert model.predict(bags).tolist() == [1] * len(bags)


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("C", 0.0, "C must be a finite number above 0"),
        ("tol", -1.0, "tol must be a finite number above 0"),
        ("max_iter", 0, "max_iter must be an integer of at least 1"),
        ("random_state", -1, "random_state must be an integer of at least 0"),
        ("gamma", "auto", "gamma must be 'heuristic' or a finite number above 0"),
    ],
)
def test_options_out_of_range_are_refused(option: str, value: Any, message: str) -> None:
    bags, y = drawn()
    with pytest.raises(InputError, match=message):
        MILESClassifier(**{option: value}).fit(bags, y)
