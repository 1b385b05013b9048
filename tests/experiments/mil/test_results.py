from __future__ import annotations

import math

import pytest

from experiments.mil.results import results_of, rows
from relforest.experiments.mil.data import HELD_OUT
from relforest.experiments.mil.methods import IMPROVED
from relforest.experiments.mil.results import Results, mark, means
from relforest.experiments.mil.settings import N_COMPARISONS
from relforest.experiments.table import Table
from relforest.metrics import SampleMoments


def of(mean: float) -> SampleMoments:
    return SampleMoments(mean, 1.0, 10)


# Two samples of 10 with standard deviation 1: the error of the difference is sqrt(2 / 10) = .4472, with 18
# degrees of freedom. A difference of 1.2 has t = 2.683 and p = .0152, one of 1.6 t = 3.578 and p = .0021;
# the levels are .05 and 1 - .95^(1/12) = .0043.
@pytest.mark.parametrize(
    ("ours", "other", "score", "cost"),
    [
        (0.0, 0.5, "", ""),
        (0.0, 1.2, "<", ""),
        (1.2, 0.0, "", ">"),
        (0.0, 1.6, "<", "<"),
        (1.6, 0.0, ">", ">"),
        (0.0, 0.0, "", ""),
    ],
)
def test_wins_need_more_than_losses(ours: float, other: float, score: str, cost: str) -> None:
    assert N_COMPARISONS == 12
    assert mark(of(ours), of(other)) == score
    assert mark(of(ours), of(other), is_cost=True) == cost


def test_what_was_stopped_is_not_compared() -> None:
    assert mark(None, of(1.0)) == mark(of(1.0), None) == ""


def test_rows_are_grouped_by_cell() -> None:
    table = Table.of(
        [
            *rows("musk1", "dd", pss=[0.2, 0.4], seconds=[1.0, 3.0], peak=[5, 7]),
            *rows("color", "covagg", pss=[0.5, None], seconds=[1.0, None], peak=[5, 9]),
        ]
    )
    results = Results.of(table)

    assert results.data_sets == ("color", "musk1")
    assert results.methods == ("covagg", "dd")
    assert results.get("color", "dd") is None
    done, stopped = results.get("musk1", "dd"), results.get("color", "covagg")
    assert done is not None
    assert stopped is not None
    assert (done.skill, done.is_stopped, done.peak_bytes) == (SampleMoments.of([0.2, 0.4]), False, 7)
    assert done.seconds == SampleMoments.of([1.0, 3.0])
    assert (stopped.skill, stopped.seconds, stopped.is_stopped, stopped.peak_bytes) == (None, None, True, 9)
    assert stopped.facts["n_bags"] == 92


def test_stopped_methods_are_compared_in_two_ways() -> None:
    results = results_of(
        rows("color", IMPROVED, pss=[0.8, 0.8]),
        rows("musk1", IMPROVED, pss=[0.4, 0.4]),
        rows("color", "dd", pss=[0.7, 0.7]),
        rows("musk1", "dd", pss=[0.9, None]),
    )
    dd = means(results, "dd")

    assert (dd.n_data_sets, dd.n_stopped) == (2, 1)
    assert dd.with_zeros == pytest.approx(0.35)
    assert dd.of_finished == pytest.approx(0.7)
    assert dd.improved_with_zeros == pytest.approx(0.6)
    assert dd.improved_on_finished == pytest.approx(0.8)
    # .8 - .7 is less than .6 - .35
    assert dd.lead == pytest.approx(0.1)


def test_the_improved_method_has_zeros_too() -> None:
    results = results_of(
        rows("color", IMPROVED, pss=[None]),
        rows("musk1", IMPROVED, pss=[0.4, 0.4]),
        rows("color", "dd", pss=[0.2, 0.2]),
        rows("musk1", "dd", pss=[0.3, 0.3]),
    )

    assert means(results, "dd").lead == pytest.approx((0.0 + 0.4 - 0.2 - 0.3) / 2)


def test_without_the_improved_method_there_is_no_lead() -> None:
    results = results_of(rows("color", "dd", pss=[0.2, 0.2]), rows("musk1", "dd", pss=[None]))

    assert math.isnan(means(results, "dd").lead)
    assert means(results, "dd").of_finished == pytest.approx(0.2)


def test_means_may_be_over_some_data_sets_only() -> None:
    results = results_of(
        rows("color", IMPROVED, pss=[0.8, 0.8]),
        rows("fox", IMPROVED, pss=[0.4, 0.4]),
        rows("color", "dd", pss=[0.2, 0.2]),
        rows("fox", "dd", pss=[0.3, 0.3]),
    )
    held_out = means(results, "dd", HELD_OUT)

    assert (held_out.n_data_sets, held_out.n_stopped) == (1, 0)
    assert (held_out.with_zeros, held_out.of_finished) == pytest.approx((0.3, 0.3))
    assert held_out.lead == pytest.approx(0.1)
    none = means(results, "dd", ["tiger"])
    assert (none.n_data_sets, none.n_stopped) == (0, 0)
    assert all(map(math.isnan, (none.with_zeros, none.of_finished, none.improved_with_zeros, none.lead)))


def test_a_method_that_never_finished_is_compared_with_zeros() -> None:
    results = results_of(rows("color", IMPROVED, pss=[0.8, 0.8]), rows("color", "dd", pss=[None]))
    dd = means(results, "dd")

    assert math.isnan(dd.of_finished)
    assert dd.lead == pytest.approx(0.8)
