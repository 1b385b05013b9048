"""How panels are weighed by their scores of bags left out."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.mil.panel_weights import panel_weights

POSITIVE = np.arange(200) % 2 == 0
SIGN = np.where(POSITIVE, 1.0, -1.0)
ALIKE = np.ones(200)
NOISE = np.random.default_rng(0).standard_normal((200, 2))


def test_a_panel_that_knows_counts_and_one_that_guesses_does_not() -> None:
    weights, _ = panel_weights(np.column_stack([SIGN + 0.8 * NOISE[:, 0], NOISE[:, 1]]), POSITIVE, ALIKE)

    assert weights[0] > 1.0
    assert weights[1] < 0.3


def test_no_weight_is_negative() -> None:
    weights, _ = panel_weights(np.column_stack([SIGN + NOISE[:, 0], -SIGN + NOISE[:, 1]]), POSITIVE, ALIKE)

    assert weights[1] == 0.0


def test_the_units_of_a_panel_do_not_matter() -> None:
    scores = np.column_stack([SIGN + NOISE[:, 0], SIGN + 2.0 * NOISE[:, 1]])
    weights, intercept = panel_weights(scores, POSITIVE, ALIKE)
    scaled, other = panel_weights(scores * [1e3, 1e-3], POSITIVE, ALIKE)

    np.testing.assert_allclose(scaled * [1e3, 1e-3], weights, rtol=1e-3)
    assert other == pytest.approx(intercept, abs=1e-3)


@pytest.mark.parametrize("offset", [-0.3, 1e4])
def test_a_constant_added_to_a_panel_changes_only_the_intercept(offset: float) -> None:
    scores = np.column_stack([SIGN + NOISE[:, 0], SIGN + 2.0 * NOISE[:, 1]])
    weights, intercept = panel_weights(scores, POSITIVE, ALIKE)
    same, other = panel_weights(scores + np.array([offset, 0.0]), POSITIVE, ALIKE)

    np.testing.assert_allclose(same, weights, rtol=1e-6)
    assert other + offset * same[0] == pytest.approx(intercept, abs=1e-6)


@pytest.mark.parametrize("value", [0.0, 0.3, -7e3])
def test_equal_scores_get_equal_weights(value: float) -> None:
    # All the same for every bag: the data say nothing, and the pull alone decides.
    weights, intercept = panel_weights(np.full((200, 4), value), POSITIVE, ALIKE)

    np.testing.assert_allclose(weights, 0.25)
    assert intercept == pytest.approx(-value, abs=1e-6)


def test_a_panel_of_equal_scores_leaves_the_others_as_they_are() -> None:
    good = SIGN + 0.8 * NOISE[:, 0]
    rounded = 0.3 + 1e-15 * NOISE[:, 1]
    weights, _ = panel_weights(np.column_stack([good, rounded]), POSITIVE, ALIKE)
    expected, _ = panel_weights(np.column_stack([good, np.zeros(200)]), POSITIVE, ALIKE)

    np.testing.assert_allclose(weights[0], expected[0], rtol=1e-6)


def test_the_intercept_balances_unequal_classes() -> None:
    # One positive bag of five; the scores are 1 for all positive and 0 for all negative bags, so by symmetry
    # the threshold lies at one half: intercept = -weight / 2.
    positive = np.arange(100) % 5 == 0
    weights, intercept = panel_weights(positive.astype(float)[:, None], positive, np.ones(100))

    assert intercept == pytest.approx(-weights[0] / 2.0, rel=1e-3)


def test_the_result_is_a_minimum() -> None:
    scores = np.column_stack([SIGN + NOISE[:, 0], SIGN + 2.0 * NOISE[:, 1]])
    weights, intercept = panel_weights(scores, POSITIVE, ALIKE)
    spread = scores.std(axis=0)

    def loss(parameters: NDArray[np.float64]) -> float:
        margin = SIGN * (scores / spread @ parameters[:2] + parameters[2])
        return float(np.log1p(np.exp(-margin)).sum() + 0.5 * ((parameters[:2] - 0.5) ** 2).sum())

    best = np.append(weights * spread, intercept)
    for place in range(3):
        for step in (-0.05, 0.05):
            moved = best + step * (np.arange(3) == place)
            assert loss(moved) > loss(best)


def test_a_weight_counts_like_that_many_bags() -> None:
    scores = np.column_stack([SIGN + NOISE[:, 0], SIGN + 2.0 * NOISE[:, 1]])[:60]
    counts = 1 + np.arange(60) % 3
    weighted, intercept = panel_weights(scores, POSITIVE[:60], counts.astype(float))
    spread = scores.std(axis=0), scores.repeat(counts, axis=0).std(axis=0)
    repeated, other = panel_weights(
        scores.repeat(counts, axis=0), POSITIVE[:60].repeat(counts), np.ones(counts.sum())
    )

    # The pull is towards equal weights in units of the spread, which repetition changes a little.
    np.testing.assert_allclose(weighted, repeated, rtol=0.05 + np.abs(spread[0] / spread[1] - 1.0).max())
    assert other == pytest.approx(intercept, abs=0.05)
