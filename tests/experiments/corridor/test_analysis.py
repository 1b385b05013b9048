from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from relforest.experiments.corridor.analysis import below_p, figures, greater_p, summarize, values
from relforest.experiments.table import Row, Table


def rows(condition: str, run: int, rewards: list[float], leaves: list[int]) -> list[Row]:
    return [
        {
            "condition": condition,
            "run": run,
            "iteration": iteration,
            "test_reward": reward,
            "train_reward": None if iteration == 0 else 2.5,
            "trees": 1,
            "leaves": count,
        }
        for iteration, (reward, count) in enumerate(zip(rewards, leaves, strict=True))
    ]


TABLE = Table.of(
    [
        *rows("500-densities", 0, [2.0, 8.6, 8.6, 8.8], [0, 3, 4, 5]),
        *rows("500-densities", 1, [3.0, 8.5, 8.6, 8.6], [0, 3, 4, 5]),
        *rows("10-densities", 0, [2.0, 7.0], [0, 3]),
        *rows("10-densities", 1, [2.2, 8.0], [0, 4]),
        *rows("10-bits", 0, [2.1, 7.2], [0, 30]),
        *rows("10-bits", 1, [2.4, 7.7], [0, 32]),
    ]
)


def test_values_are_taken_after_an_iteration_or_the_last() -> None:
    np.testing.assert_array_equal(values(TABLE, "500-densities", 1, "test_reward"), [8.6, 8.5])
    np.testing.assert_array_equal(values(TABLE, "500-densities", -1, "test_reward"), [8.8, 8.6])
    np.testing.assert_array_equal(values(TABLE, "10-bits", -1, "leaves"), [30.0, 32.0])


def test_the_two_sample_test_is_students() -> None:
    rng = np.random.default_rng(0)
    one, other = rng.normal(1.0, 1.0, 8), rng.normal(0.5, 2.0, 12)

    expected = stats.ttest_ind(one, other, alternative="greater").pvalue
    assert greater_p(one, other) == pytest.approx(expected, rel=1e-12)
    assert greater_p(np.full(3, 8.0), np.full(3, 7.0)) == 0.0
    assert greater_p(np.full(3, 7.0), np.full(3, 7.0)) == 1.0
    # One constant sample: means 3 and 1, pooled variance (0 + 2) / 4, t = 2 / sqrt(.5 * 2 / 3), 4 degrees.
    assert greater_p(np.full(3, 3.0), np.array([0.0, 1.0, 2.0])) == pytest.approx(
        float(stats.t.sf(2.0 / np.sqrt(1.0 / 3.0), 4))
    )


def test_the_one_sample_test_is_students() -> None:
    sample = np.random.default_rng(1).normal(8.6, 0.1, 10)

    assert below_p(sample, 8.69) == pytest.approx(stats.ttest_1samp(sample, 8.69, alternative="less").pvalue)
    assert below_p(np.full(3, 8.0), 8.69) == 0.0
    assert below_p(np.full(3, 9.0), 8.69) == 1.0


def test_claims_are_made_where_the_table_reaches() -> None:
    claims = {claim.name: claim for claim in summarize(TABLE).claims}

    first = claims["500 episodes, densities and bits: mean test reward after iteration 1"]
    third = claims["500 episodes, densities and bits: mean test reward after iteration 3"]
    assert (first.measured, first.low) == (8.55, 8.5)
    assert third.measured == pytest.approx(8.7)
    # There is no iteration 5 with 10 episodes here.
    assert len(claims) == 4
    assert claims["bits only: p of more leaves than with densities, at the end"].verdict == "met"
    assert claims["bits only: p of a lower reward than with densities, at the end"].verdict == "met"


def test_the_summary_has_means_deviations_and_tests() -> None:
    text = str(summarize(TABLE))

    # sd of 8.6 and 8.5: .0707
    assert "8.55 +- 0.07" in text
    assert "31.0 +- 1.4" in text
    assert "< 1e-11" in text


def test_there_are_the_three_figures_of_the_source() -> None:
    assert list(figures(TABLE)) == ["figure-7.2.png", "figure-7.3.png", "figure-7.4.png"]
