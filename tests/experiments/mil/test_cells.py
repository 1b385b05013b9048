from __future__ import annotations

import pytest

from experiments.mil.results import rows
from relforest.experiments.mil.cells import Results, mark
from relforest.experiments.mil.settings import N_COMPARISONS
from relforest.experiments.table import Table
from relforest.metrics import Moments
from relforest.support.errors import RunFolderError


def of(mean: float) -> Moments:
    return Moments(mean, 1.0, 10)


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
    assert (done.skill, done.is_stopped, done.peak_bytes) == (Moments.of([0.2, 0.4]), False, 7)
    assert done.seconds == Moments.of([1.0, 3.0])
    assert (stopped.skill, stopped.seconds, stopped.is_stopped, stopped.peak_bytes) == (None, None, True, 9)
    assert stopped.facts["n_bags"] == 92


@pytest.mark.parametrize("column", ["pss", "cpu_seconds"])
def test_what_was_done_has_a_score_and_a_time(column: str) -> None:
    first, second = rows("musk1", "dd", pss=[0.2, 0.0])

    assert Results.of(Table.of([first, second])).by_cell["musk1", "dd"].scores == (0.2, 0.0)
    with pytest.raises(
        RunFolderError,
        match=rf"musk1, dd, fold 1 is done, but its {column} is missing: .*cells/musk1/dd\.json",
    ):
        Results.of(Table.of([first, {**second, column: None}]))
