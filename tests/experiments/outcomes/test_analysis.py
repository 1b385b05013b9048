from __future__ import annotations

from itertools import product

from relforest.experiments.outcomes.analysis import METHODS, figures, summarize
from relforest.experiments.outcomes.settings import BALANCE, KEEPAWAY, LARGE, OURS, SIZES, SMALL, TASKS
from relforest.experiments.table import Row, Table


def rows(task: str, trained: str, tested: str, method: str, score: float) -> list[Row]:
    found = {"pss": score, "best": score + 0.1, "auc": 0.9, "log10 p": -9.0, "seconds": 2.0}
    where = {"trained": trained, "tested": tested, "method": method}
    return [
        {
            "part": "models",
            "task": task,
            "draw": draw,
            **where,
            "measure": measure,
            "value": value + 0.01 * draw,
        }
        for draw in range(2)
        for measure, value in found.items()
    ]


def table(ours_in_large: float) -> Table:
    return Table.of(
        row
        for task, trained, tested, method in product(TASKS, SIZES, SIZES, METHODS)
        for row in rows(
            task,
            trained,
            tested,
            method,
            0.5 if method != OURS else ours_in_large if (trained, tested) == (SMALL, LARGE) else 0.7,
        )
    )


def test_leads_are_claimed() -> None:
    least, lead, mean, balance, chance = summarize(table(0.7)).claims

    assert not any(claim.is_missed for claim in (least, lead, mean, chance))
    assert round(lead.measured, 9) == 0.2
    assert round(mean.measured, 9) == 0.705
    assert balance.is_missed


def test_a_rival_that_is_ahead_in_one_direction_is_noticed() -> None:
    least, lead, mean, *_ = summarize(table(0.3)).claims

    # Always .2 behind from small to large; from large to small still .2 ahead.
    assert round(least.measured, 9) == -0.2
    assert round(lead.measured, 9) == 0.0
    assert least.is_missed
    assert lead.is_missed
    assert mean.is_missed


def test_the_loss_by_the_threshold_is_listed() -> None:
    lines = str(summarize(table(0.7))).splitlines()
    line = next(line.split() for line in lines if "small -> large" in line and OURS in line)

    assert line[-3:] == ["0.100", "0.905", "2.0"]


def test_figures_have_a_panel_per_task() -> None:
    assert [len(figure.axes) for figure in figures(table(0.7)).values()] == [3, 3]


def protocol_rows(task: str, trained: str, tested: str, scores: list[float]) -> list[Row]:
    head: Row = {"part": "protocol", "task": task, "draw": 0, "trained": trained, "tested": tested}
    return [{**head, "method": "25 + 25", "measure": "pss", "value": score} for score in scores]


def test_statements_of_the_source_are_tested() -> None:
    sheet = summarize(
        Table.of(
            [
                *protocol_rows(KEEPAWAY, LARGE, LARGE, [0.3, 0.32, 0.31]),
                *protocol_rows(KEEPAWAY, SMALL, LARGE, [0.5, 0.52, 0.51]),
                *protocol_rows(BALANCE, SMALL, LARGE, [0.1, -0.1, 0.05]),
            ]
        )
    ).parts[0]
    verdicts = {str(row[0]): row[3] for row in sheet.rows}  # type: ignore[union-attr]

    assert verdicts == {
        "balance scale, small to large scenes: above chance": "does not hold",
        "keepaway pass, small to large scenes: above chance": "holds",
        "keepaway, 4 against 3: better predicted by a forest from 3 against 2 (its lead)": "holds",
    }
