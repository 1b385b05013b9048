from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from relforest.experiments.corridor.analysis import STATEMENTS, below_p, figures, summarize, values
from relforest.experiments.statements import statements_sheet
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
    assert not len(values(TABLE, "500-untested", -1, "leaves"))
    assert not len(values(TABLE, "10-bits", 7, "leaves"))


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
    assert "p < 1e-11" in text


def verdict(words: str, table: Table) -> str:
    (found,) = [line[-1] for line in statements_sheet(STATEMENTS, table).lines() if words in line[0]]
    return found


def test_the_source_is_judged_where_runs_were_made() -> None:
    # Rewards 8.8 and 8.6: a mean above the optimum of 8.69.
    assert verdict("500 episodes, in the end: reward not below the optimum", TABLE) == "holds"
    # 8.6 and 8.5: t = -.14 / .05, one degree of freedom, p = atan(.05 / .14) / pi = .109.
    assert verdict("500 episodes, one batch: reward not below the optimum", TABLE) == "holds"
    assert verdict("bits alone need more leaves", TABLE) == "holds"
    assert verdict("densities do not give more reward", TABLE) == "holds"
    assert verdict("trees untested", TABLE) == "not run"


@pytest.mark.parametrize(("trees", "expected"), [(38, "does not hold"), (39, "holds")])
def test_rounds_without_end_add_more_trees_than_all_but_one_could(trees: int, expected: str) -> None:
    untested = [dict(row, trees=trees) for row in rows("500-untested", 0, [2.0, 8.6], [0, 300])]
    assert verdict("trees untested", Table.of(untested)) == expected


def test_a_single_run_has_no_deviation_and_proves_nothing() -> None:
    alone = Table.of([row for row in TABLE.rows if row["run"] == 0])
    findings = summarize(alone)
    assert [claim.name[:11] for claim in findings.claims] == ["500 episode"] * 2
    assert "31" not in str(findings.parts[2].to_text())
    assert verdict("bits alone need more leaves", alone) == "not run"


def test_there_are_the_three_figures_of_the_source() -> None:
    assert list(figures(TABLE)) == ["figure-7.2.png", "figure-7.3.png", "figure-7.4.png"]
