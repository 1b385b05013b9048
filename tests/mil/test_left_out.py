"""How bags are left out, and what their scores say about probabilities."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import expit
from sklearn.model_selection import StratifiedKFold

from relforest.mil.left_out import log_odds_factor, split_bags


@pytest.mark.parametrize(("n_bags", "n_splits"), [(20, 5), (23, 4), (9, 2)])
def test_splits_are_those_of_scikit_learn(n_bags: int, n_splits: int) -> None:
    for seed in range(5):
        positive = np.random.default_rng(seed).permutation(n_bags) < n_bags // 2
        splits = split_bags(positive, n_splits, np.random.default_rng(seed))
        fold_seed = int(np.random.default_rng(seed).integers(2**31))
        expected = StratifiedKFold(n_splits, shuffle=True, random_state=fold_seed).split(positive, positive)

        for (train, test), (train_expected, test_expected) in zip(splits, expected, strict=True):
            assert train.tolist() == train_expected.tolist()
            assert test.tolist() == test_expected.tolist()


def test_a_class_of_one_bag_cannot_be_split() -> None:
    splits = split_bags(np.array([True, False, False]), 5, np.random.default_rng(0))

    assert [[part.tolist() for part in split] for split in splits] == [[[0, 1, 2], [0, 1, 2]]]


def test_scores_that_are_log_odds_keep_their_size() -> None:
    rng = np.random.default_rng(0)
    odds = 2.0 * rng.standard_normal(20_000)
    positive = rng.random(20_000) < expit(odds)

    assert log_odds_factor(odds, positive, np.ones(20_000)) == pytest.approx(1.0, abs=0.05)
    assert log_odds_factor(1e-3 * odds, positive, np.ones(20_000)) == pytest.approx(1e3, rel=0.05)


def test_two_bags_by_hand() -> None:
    # One bag of either class at 1 and -1: both targets are (1 + 1) / (1 + 2), so expit(a) = 2 / 3, a = log 2.
    positive = np.array([True, False])

    assert log_odds_factor(np.array([1.0, -1.0]), positive, np.ones(2)) == pytest.approx(np.log(2.0))


@pytest.mark.parametrize("scores", [[-1.0, 1.0, 2.0, -3.0], [0.0, 0.0, 0.0, 0.0], [1e30, 1e-30, -1e30, 5.0]])
def test_any_scores_get_a_factor_above_zero(scores: list[float]) -> None:
    factor = log_odds_factor(np.array(scores), np.array([True, False, False, True]), np.ones(4))

    assert 0.0 < factor < np.inf


def test_scores_that_know_nothing_get_odds_that_are_nearly_even() -> None:
    scores = np.array([1.0, -1.0, 1.0, -1.0])
    factor = log_odds_factor(scores, np.array([True, True, False, False]), np.ones(4))

    assert expit(factor) == pytest.approx(0.5, abs=0.01)


def test_a_weight_counts_like_that_many_bags() -> None:
    rng = np.random.default_rng(0)
    scores, counts = rng.standard_normal(50), rng.integers(1, 4, 50)
    positive = scores + rng.standard_normal(50) > 0
    weighted = log_odds_factor(scores, positive, counts.astype(float))
    repeated = log_odds_factor(scores.repeat(counts), positive.repeat(counts), np.ones(counts.sum()))

    assert weighted == pytest.approx(repeated)
