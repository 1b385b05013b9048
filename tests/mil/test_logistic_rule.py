"""Logistic regression: an optimum by hand, and scikit-learn as a peer."""

from __future__ import annotations

import numpy as np
import pytest
from sklearn.linear_model import LogisticRegression

from relforest.mil.logistic_rule import balance, fit_logistic


def test_both_classes_weigh_the_same() -> None:
    positive = np.array([True, False, False, False])

    assert balance(positive, np.ones(4)).tolist() == [2.0, 2 / 3, 2 / 3, 2 / 3]
    # 8 in all: 4 for each class, and in the same proportions within it.
    assert balance(positive, np.array([2.0, 3.0, 2.0, 1.0])).tolist() == [4.0, 2.0, 4 / 3, 2 / 3]


def test_without_features_that_tell_the_odds_are_even() -> None:
    weights, intercept = fit_logistic(
        np.ones((4, 2)) * 0.5, np.array([True, False, False, False]), np.ones(4), C=1.0
    )

    assert weights == pytest.approx([0, 0], abs=1e-6)
    assert intercept == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("C", [1e-2, 1.0, 1e4])
def test_scikit_learn_gives_the_same(C: float) -> None:
    rng = np.random.default_rng(0)
    # Far from 0, every form of the loss is used.
    features = rng.normal(size=(50, 6)) * 20
    positive = features[:, 0] + 5 * rng.normal(size=50) > 5
    peer = LogisticRegression(C=C, class_weight="balanced", max_iter=2000).fit(features, positive)
    weights, intercept = fit_logistic(features, positive, np.ones(50), C=C)

    np.testing.assert_allclose(weights, peer.coef_[0], rtol=1e-6, atol=1e-9)
    assert intercept == pytest.approx(peer.intercept_[0], rel=1e-6, abs=1e-9)


def test_scores_far_from_zero_do_not_overflow() -> None:
    features = np.array([[1e4], [-1e4], [3e4], [-2e4]])
    weights, intercept = fit_logistic(features, np.array([True, False, True, False]), np.ones(4), C=1e8)

    assert np.isfinite([*weights, intercept]).all()
    assert ((features @ weights + intercept > 0) == [True, False, True, False]).all()


def test_a_weight_counts_like_that_many_examples() -> None:
    rng = np.random.default_rng(1)
    features, counts = rng.normal(size=(30, 3)), rng.integers(1, 4, 30)
    positive = features[:, 0] + rng.normal(size=30) > 0
    weights, intercept = fit_logistic(features, positive, counts.astype(float), C=1.0)
    repeated, other = fit_logistic(
        features.repeat(counts, axis=0), positive.repeat(counts), np.ones(counts.sum()), C=1.0
    )

    np.testing.assert_allclose(weights, repeated, rtol=1e-3)
    assert intercept == pytest.approx(other, abs=1e-3)
