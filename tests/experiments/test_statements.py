from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from relforest.experiments.statements import (
    Judge,
    Judgement,
    Sample,
    Statement,
    Values,
    above,
    correlated,
    greater_p,
    improvement,
    interquartile_mean,
    not_above,
    reached,
    statements_sheet,
)
from relforest.experiments.table import Table

TABLE = Table.of([{"any": 1}])


def always(*numbers: float) -> Sample:
    return lambda _table: np.array(numbers)


HIGH, LOW, NONE = always(4.0, 5.0, 6.0), always(1.0, 2.0, 3.0), always()


def judged(judge: Judge) -> Judgement:
    found = judge(TABLE)
    assert found is not None
    return found


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


def test_above_is_about_the_first_sample() -> None:
    # Means 5 and 2, variances 1: t = 3 / sqrt(2 / 3), 4 degrees of freedom.
    expected = float(stats.t.sf(3.0 / np.sqrt(2.0 / 3.0), 4))
    found, turned = judged(above(HIGH, LOW)), judged(above(LOW, HIGH))
    assert (found.ours, found.holds, found.improves) == ("5 (3) / 2 (3)", True, 1.0)
    assert (turned.ours, turned.holds, turned.improves) == ("2 (3) / 5 (3)", False, 0.0)
    assert found.p == pytest.approx(expected)
    assert turned.p == pytest.approx(1.0 - expected)


def test_not_above_holds_where_above_does_not() -> None:
    assert not judged(not_above(HIGH, LOW)).holds
    assert judged(not_above(LOW, HIGH)).holds
    assert judged(not_above(HIGH, HIGH)).holds
    # p = .011 is no lead where several are compared.
    assert judged(not_above(HIGH, LOW, level=0.01)).holds


@pytest.mark.parametrize("judge", [above(NONE, LOW), above(HIGH, always(1.0)), not_above(HIGH, NONE)])
def test_nothing_is_said_of_fewer_than_two_runs(judge: Judge) -> None:
    assert judge(TABLE) is None


def test_the_best_run_reaches_a_bound() -> None:
    assert judged(reached(LOW, always(3.0, 9.0), np.min)) == Judgement("3 / 3", holds=True)
    assert not judged(reached(LOW, always(2.9, 3.3), np.mean)).holds
    assert reached(NONE, LOW, np.min)(TABLE) is None
    assert reached(LOW, NONE, np.min)(TABLE) is None


def test_correlation_is_pearsons() -> None:
    def pairs(_table: Table) -> tuple[Values, Values]:
        return np.array([-1.0, 0.0, 1.0, 2.0]), np.array([-1.0, 0.0, 2.0, 1.0])

    found = judged(correlated(pairs))
    # Sums of products 4, of squares 5 and 5.
    assert found.ours == "R = 0.80 (4)"
    assert found.p == pytest.approx(0.1)
    assert not found.holds
    assert math.isnan(found.improves)
    assert correlated(lambda _table: (np.ones(5), np.arange(5.0)))(TABLE) is None
    assert correlated(lambda _table: (np.empty(0), np.empty(0)))(TABLE) is None


def test_improvement_counts_pairs() -> None:
    # 1 beats 0, ties with 1; 2 beats both.
    assert improvement(np.array([1.0, 2.0]), np.array([0.0, 1.0])) == 0.875


def test_the_interquartile_mean_leaves_out_both_ends() -> None:
    assert interquartile_mean(np.array([-100.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 1000.0])) == 3.5


def test_a_table_says_what_holds_what_does_not_and_what_was_not_run() -> None:
    statements = [
        Statement("7.1", "high above low", "p < 1e-3", above(HIGH, LOW)),
        Statement("7.2", "low above high", "", above(LOW, HIGH)),
        Statement("7.3", "low reaches high", "about", reached(LOW, HIGH, np.min)),
        Statement("7.4", "none above low", "p < .5", above(NONE, LOW)),
    ]
    header, *lines = statements_sheet(statements, TABLE).lines()
    assert header == ["the source says", "source", "here", "improves", "p", "verdict"]
    assert lines == [
        ["7.1 high above low", "p < 1e-3", "5 (3) / 2 (3)", "1.00", "1.1e-02", "holds"],
        ["7.2 low above high", "", "2 (3) / 5 (3)", "0.00", "9.9e-01", "does not hold"],
        ["7.3 low reaches high", "about", "3 / 4", "", "", "does not hold"],
        ["7.4 none above low", "p < .5", "", "", "", "not run"],
    ]
