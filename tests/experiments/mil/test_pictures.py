from __future__ import annotations

import numpy as np
from matplotlib.lines import Line2D

from experiments.mil.results import around, rows
from relforest.experiments.mil.pictures import figures
from relforest.experiments.table import Table

SETS = ("color", "covariant1", "covariant2", "disjunctive", "musk1")


def test_there_is_a_panel_per_data_set_with_the_methods_tried_on_its_line() -> None:
    table = Table.of(
        [
            row
            for data_set in SETS
            for method in ("covagg", "optimal-ball", "dd")
            if method != "dd" or data_set == "musk1"
            for row in rows(data_set, method, pss=around(0.5) if data_set != "color" else [None])
        ]
        + rows("color", "miles-tuned", pss=around(0.5), chosen=(1.0, 1.0))
    )
    drawn = figures(table)

    assert sorted(drawn) == ["scores.png", "times.png"]
    panels = drawn["scores.png"].axes
    assert [axes.get_title(loc="left") for axes in panels] == [
        "Color",
        "Covariant 1",
        "Covariant 2",
        "Disjunctive",
        "Musk 1",
    ]
    assert labels(panels[0]) == ["CovAgg", "OptBall", "MILES*"]
    assert labels(panels[1]) == ["", "", ""]
    assert labels(panels[4]) == ["CovAgg", "OptBall", "DD"]
    times = drawn["times.png"].axes
    assert labels(times[0]) == ["CovAgg", "OptBall"]
    assert {axes.get_xscale() for axes in times} == {"log"}


def test_the_sources_values_are_hollow_and_ours_are_not() -> None:
    (axes,) = figures(Table.of(rows("musk1", "covagg", pss=around(0.5))))["scores.png"].axes
    marks = {
        first(line): line.get_markerfacecolor() != line.get_color()
        for line in axes.lines
        if line.get_marker() == "o"
    }

    assert {round(mean, 6): hollow for mean, hollow in marks.items()} == {0.5: False, 0.61: True}


def test_stopped_methods_are_marked_at_the_limit() -> None:
    (axes,) = figures(Table.of(rows("musk1", "dd", pss=[None])))["times.png"].axes

    assert [first(line) for line in axes.lines if line.get_marker() == "|"] == [300.0]


def labels(axes: object) -> list[str]:
    return [text.get_text() for text in axes.get_yticklabels()]  # type: ignore[attr-defined]


def first(line: Line2D) -> float:
    return float(np.asarray(line.get_xdata())[0])
