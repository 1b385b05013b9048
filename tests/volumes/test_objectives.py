from __future__ import annotations

import math

import numpy as np
import pytest

from relforest.volumes.objectives import (
    ACCURACY,
    LOG_LIKELIHOOD,
    SQUARED_ERROR,
    WEIGHTED,
    entropy_table,
    score_counts,
    score_sums,
)


def score(objective: int, inside: tuple[int, int], totals: tuple[int, int]) -> float:
    return score_counts(objective, *inside, totals, entropy_table(sum(totals)))


def test_the_table_by_hand() -> None:
    np.testing.assert_allclose(entropy_table(3), [0, 0, 2 * math.log(2), 3 * math.log(3)])


def test_accuracy_counts_correct_bags() -> None:
    # 2 of 3 positives inside, 1 of 4 negatives inside: 2 + 3.
    assert score(ACCURACY, (2, 1), (3, 4)) == 5
    assert score(ACCURACY, (3, 4), (3, 4)) == 3


def test_nothing_inside_is_no_volume() -> None:
    assert score(ACCURACY, (0, 0), (3, 4)) == -math.inf
    assert score(LOG_LIKELIHOOD, (0, 0), (3, 4)) == -math.inf


def test_log_likelihood_by_hand() -> None:
    # Yes: 3 positives, 1 negative: 3 ln(3/4) + ln(1/4). No: 1 and 4: ln(1/5) + 4 ln(4/5).
    expected = 3 * math.log(3 / 4) + math.log(1 / 4) + math.log(1 / 5) + 4 * math.log(4 / 5)

    assert score(LOG_LIKELIHOOD, (3, 1), (4, 5)) == pytest.approx(expected)


def test_a_perfect_separation_has_probability_one() -> None:
    assert score(LOG_LIKELIHOOD, (4, 0), (4, 5)) == 0


@pytest.mark.parametrize(
    "inside",
    [
        (4, 5),  # nothing outside
        (2, 3),  # 2/5 inside, 2/4 outside
        (0, 2),  # positives avoid it
    ],
)
def test_yes_must_be_more_probable_than_no(inside: tuple[int, int]) -> None:
    assert score(LOG_LIKELIHOOD, inside, (4, 5)) == -math.inf


def test_equal_probabilities_are_not_enough() -> None:
    # 1/2 inside and 1/2 outside.
    assert score(LOG_LIKELIHOOD, (1, 1), (2, 2)) == -math.inf


@pytest.mark.parametrize("objective", [ACCURACY, LOG_LIKELIHOOD])
def test_scores_rise_with_positives_and_fall_with_negatives_inside(objective: int) -> None:
    # The search for the best cut relies on it.
    totals = (6, 7)
    counts = [(positive, negative) for positive in range(7) for negative in range(8)]
    scores = {inside: score(objective, inside, totals) for inside in counts}
    admissible = [inside for inside in counts if scores[inside] > -math.inf]
    assert len(admissible) > 20
    for positive, negative in admissible:
        # With everything inside the likelihood has no second leaf.
        more = (positive + 1, negative)
        if positive < 6 and (objective == ACCURACY or more != totals):
            assert scores[more] > scores[positive, negative]
        if negative > 0 and positive > 0:
            assert scores[positive, negative - 1] > scores[positive, negative]


def test_weighted_log_likelihood_by_hand() -> None:
    # Inside weigh 1.5 positive and .5 negative, outside 1 and 3.
    expected = 1.5 * math.log(3 / 4) + 0.5 * math.log(1 / 4) + math.log(1 / 4) + 3 * math.log(3 / 4)

    assert score_sums(WEIGHTED, (0.5, 1.5), (3.5, 2.5)) == pytest.approx(expected)
    # Whole weights are counts.
    assert score_sums(WEIGHTED, (1.0, 3.0), (5.0, 4.0)) == pytest.approx(
        score(LOG_LIKELIHOOD, (3, 1), (4, 5))
    )
    # The Yes leaf must be the more probable one, and neither leaf empty.
    for inside in ((3.0, 1.0), (0.0, 0.0), (3.5, 2.5)):
        assert score_sums(WEIGHTED, inside, (3.5, 2.5)) == -math.inf


def test_squared_error_by_hand() -> None:
    # Two of mean 3 inside, three of mean -1 outside.
    assert score_sums(SQUARED_ERROR, (2.0, 6.0), (5.0, 3.0)) == pytest.approx(2 * 9 + 3 * 1)
    for inside in ((3.0, -3.0), (0.0, 0.0), (5.0, 3.0)):
        assert score_sums(SQUARED_ERROR, inside, (5.0, 3.0)) == -math.inf
