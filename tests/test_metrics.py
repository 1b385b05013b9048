from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy import stats

from relforest.metrics import (
    SampleMoments,
    mean_interval,
    peirce_skill_score,
    sidak_level,
    two_sample_p_value,
)
from relforest.support.errors import InputError

LABELS: list[list[Any]] = [[0, 1], [-1, 1], [False, True], ["far", "near"], [0.0, 1.0]]


@pytest.mark.parametrize("classes", LABELS)
def test_the_score_is_hit_rate_minus_false_alarm_rate(classes: list[Any]) -> None:
    no, yes = classes
    truth = [yes, yes, yes, yes, no, no, no, no, no]
    found = [yes, yes, yes, no, yes, no, no, no, no]

    # 3 of 4 positives hit, 1 of 5 negatives a false alarm: .75 - .2
    assert peirce_skill_score(truth, found) == pytest.approx(0.55)


def test_the_positive_class_does_not_matter_but_must_exist() -> None:
    truth, found = ["a", "a", "b", "b"], ["a", "b", "b", "b"]

    # b positive: 2/2 - 1/2; a positive: 1/2 - 0/2
    assert peirce_skill_score(truth, found, pos_label="b") == 0.5
    assert peirce_skill_score(truth, found, pos_label="a") == 0.5
    with pytest.raises(InputError, match="pos_label 'c' is not one of the labels in y_true, 'a', 'b'"):
        peirce_skill_score(truth, found, pos_label="c")


two_classes = hnp.arrays(np.bool_, st.integers(2, 12)).filter(lambda truth: 0 < truth.sum() < len(truth))


@given(truth=two_classes, data=st.data())
def test_the_score_of_a_prediction_and_its_opposite_cancel(truth: Any, data: st.DataObject) -> None:
    found = data.draw(hnp.arrays(np.bool_, len(truth)))
    score = peirce_skill_score(truth, found)

    assert -1 <= score <= 1
    assert peirce_skill_score(truth, ~found) == pytest.approx(-score)
    assert peirce_skill_score(~truth, ~found) == pytest.approx(score)
    assert peirce_skill_score(truth, truth) == 1
    assert peirce_skill_score(truth, np.ones_like(truth)) == 0


@pytest.mark.parametrize(
    ("truth", "found", "message"),
    [
        ([1, 1], [1, 0], r"two classes, got 1 \(1\)"),
        ([], [], r"two classes, got 0 \(no labels\)"),
        ([0, 1, 2], [0, 1, 2], r"two classes, got 3 \(0, 1, 2\)"),
        ([0, 1], [0, 1, 1], "y_true has 2 labels, but y_pred has 3: give one prediction per label"),
        ([0, 1], [-1, 1], "y_pred contains -1, but y_true only 0, 1"),
        ([0, 1], ["no", "yes"], "y_pred contains 'no'"),
        ([[0, 1]], [0], r"y_true must be one-dimensional, got the shape \(1, 2\)"),
        ([0.0, np.nan], [0, 1], "y_true contains NaN"),
        ([0, 1], [1j, 0], "y_pred contains complex128"),
        (np.array([0, "a"], dtype=object), [0, 1], "y_true mixes types of labels"),
    ],
)
def test_labels_that_cannot_be_scored_are_named(truth: Any, found: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        peirce_skill_score(truth, found)


def test_the_interval_of_a_hand_worked_sample() -> None:
    interval = mean_interval([1.0, 2.0, 3.0])

    # s = 1, t(2, .975) = 4.302652730, half width t / sqrt(3) = 2.484137712
    assert interval.mean == 2.0
    assert interval.half_width == pytest.approx(2.484137712, abs=1e-9)
    assert interval.low == pytest.approx(2 - 2.484137712, abs=1e-9)
    assert interval.high == pytest.approx(2 + 2.484137712, abs=1e-9)
    assert (interval.level, interval.count) == (0.95, 3)


@given(st.lists(st.floats(-1e3, 1e3), min_size=2, max_size=20), st.floats(0.01, 0.99))
def test_the_interval_is_that_of_the_t_distribution(values: list[float], level: float) -> None:
    interval = mean_interval(values, level)
    scale = max(float(stats.sem(values)), 1e-300)
    low, high = stats.t.interval(level, len(values) - 1, loc=np.mean(values), scale=scale)

    np.testing.assert_allclose([interval.low, interval.high], [low, high], rtol=1e-7, atol=1e-7)


@pytest.mark.parametrize(
    ("values", "level", "message"),
    [
        ([1.0], 0.95, r"at least 2 entries, got the shape \(1,\)"),
        ([[1.0, 2.0]], 0.95, "one-dimensional"),
        ([1.0, np.nan], 0.95, "values must be finite"),
        (["a", "b"], 0.95, "values must be numbers"),
        ([1.0, 2.0], 95, "level must be a number"),
        ([1.0, 2.0], 1.0, "level must be a number above 0 and below 1"),
    ],
)
def test_samples_without_an_interval_are_refused(values: Any, level: float, message: str) -> None:
    with pytest.raises(InputError, match=message):
        mean_interval(values, level)


def test_a_difference_of_means_is_tested_with_pooled_variances() -> None:
    one, other = SampleMoments.of([1.0, 2.0, 3.0]), SampleMoments.of([2.0, 4.0, 6.0, 8.0])

    # Variances 1 and 20/3, pooled (2 * 1 + 3 * 20/3) / 5 = 4.4; t = 3 / sqrt(4.4 * 7/12) = 1.8726, 5 degrees
    assert (one.mean, one.std, one.count) == (2.0, 1.0, 3)
    assert two_sample_p_value(one, other) == pytest.approx(2 * stats.t.sf(1.872563, 5), rel=1e-5)
    assert two_sample_p_value(other, one) == two_sample_p_value(one, other)


SAMPLES = st.lists(st.floats(-1e3, 1e3).map(lambda value: round(value, 3)), min_size=2, max_size=20)


@given(SAMPLES, SAMPLES)
def test_the_p_value_is_that_of_students_test(one: list[float], other: list[float]) -> None:
    # SciPy warns of a sample without spread, which is worked by hand below.
    assume(len(set(one)) > 1 and len(set(other)) > 1)
    p_value = two_sample_p_value(SampleMoments.of(one), SampleMoments.of(other))
    assert p_value == pytest.approx(stats.ttest_ind(one, other).pvalue, abs=1e-9)


def test_one_sample_without_spread_is_compared() -> None:
    # Variances 0 and 1/2, pooled 1/4; t = 1/2 / sqrt(1/4 * (1/2 + 1/2)) = 1, 2 degrees of freedom.
    p_value = two_sample_p_value(SampleMoments.of([1.0, 1.0]), SampleMoments.of([0.0, 1.0]))
    assert p_value == pytest.approx(1 - 1 / math.sqrt(3))


def test_samples_without_variance_differ_or_not() -> None:
    # .1 has no exact mean: added up ten times it is not 1.
    constant = SampleMoments.of([0.1] * 10)

    assert constant.std == 0.0
    assert two_sample_p_value(constant, SampleMoments(constant.mean, 0.0, 10)) == 1.0
    assert two_sample_p_value(constant, SampleMoments.of([0.2] * 10)) == 0.0


def test_a_published_interval_tells_the_spread() -> None:
    values = [0.1, 0.4, 0.2, 0.9]
    interval = mean_interval(values, 0.9)
    back = SampleMoments.from_interval(interval.mean, interval.half_width, 4, 0.9)

    assert back.std == pytest.approx(SampleMoments.of(values).std)
    assert back.interval(0.9).low == pytest.approx(interval.low)


def test_the_level_of_several_tests_is_that_of_the_source() -> None:
    assert sidak_level(0.05, 9) == pytest.approx(0.00568, abs=5e-6)
    assert sidak_level(0.05, 1) == pytest.approx(0.05)
    with pytest.raises(InputError, match="count must be an integer of at least 1, got 0"):
        sidak_level(0.05, 0)
    with pytest.raises(InputError, match="level must be a number above 0"):
        sidak_level(0.0, 2)


def test_masked_values_are_refused() -> None:
    masked = np.ma.masked_equal([1, 0, 0], 1)
    with pytest.raises(InputError, match="y_pred has masked values"):
        peirce_skill_score([1, 0, 0], masked)
    with pytest.raises(InputError, match="the sample has masked values"):
        SampleMoments.of(masked)
