"""Table -> pictures: scores and times of all methods beside the source's, a panel per data set."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from relforest.experiments.mil.data import DATA_SETS
from relforest.experiments.mil.methods import COVAGG, IMPROVED, METHODS
from relforest.experiments.mil.published import SCORES, TIMES
from relforest.experiments.mil.results import Result, Results
from relforest.experiments.mil.settings import SETTINGS
from relforest.experiments.sheets import Estimate
from relforest.experiments.table import Table
from relforest.metrics import SampleMoments
from relforest.reports.style import BLUE, GREY, INK, ORANGE, PALE, PAPER, styled

_COLUMNS: Final = 4
_COLORS: Final = {COVAGG: BLUE, IMPROVED: ORANGE}
_ROW_INCHES: Final = 0.19
_PANEL_INCHES: Final = 2.15
_BELOW: Final = 0.22
"""How far below ours the source's marks are, in rows."""


def figures(table: Table) -> Mapping[str, Figure]:
    """Draw scores, and times on a logarithmic scale, each with its 95 % interval."""
    results = Results.of(table)
    constant = [name for name in results.methods if not METHODS[name].is_tuned]
    with styled():
        caption = "mean Peirce skill score on test bags"
        scores = _figure(results, results.methods, lambda result: result.skill, SCORES, caption)
        for axes in scores.axes:
            axes.axvline(0, color=PALE, linewidth=0.8, zorder=0)
        caption = "CPU seconds of training and prediction (|: stopped here)"
        limit = min(setting.cpu_limit for setting in SETTINGS)
        times = _figure(results, constant, lambda result: result.seconds, TIMES, caption, limit=limit)
        for axes in times.axes:
            axes.set_xscale("log")
    return {"scores.png": scores, "times.png": times}


def _figure(
    results: Results,
    methods: Sequence[str],
    moments_of: Callable[[Result], SampleMoments | None],
    published: Mapping[tuple[str, str], Estimate],
    abscissa: str,
    *,
    limit: float | None = None,
) -> Figure:
    """Draw a panel per data set, with a row per method that was tried on one of its line of panels.

    Methods that were stopped are marked at the limit, if there is one.
    """
    lines = [
        results.data_sets[begin : begin + _COLUMNS] for begin in range(0, len(results.data_sets), _COLUMNS)
    ]
    shown = [[name for name in methods if any(results.get(one, name) for one in line)] for line in lines]
    heights = [len(rows) + 3 for rows in shown]
    size = (1.0 + _PANEL_INCHES * _COLUMNS, 0.7 + _ROW_INCHES * sum(heights))
    figure = Figure(figsize=size, layout="constrained")
    grid = figure.add_gridspec(len(lines), _COLUMNS, height_ratios=heights)
    for line, (data_sets, rows) in enumerate(zip(lines, shown, strict=True)):
        titles = [METHODS[name].title for name in rows]
        for column, data_set in enumerate(data_sets):
            axes = figure.add_subplot(grid[line, column])
            axes.set_title(DATA_SETS[data_set].title, loc="left")
            axes.set_ylim(len(rows) - 0.4, -0.6)
            axes.set_yticks(range(len(rows)), titles if column == 0 else [""] * len(rows))
            axes.tick_params(axis="y", length=0)
            for row, method in enumerate(rows):
                axes.axhline(row, color=PALE, linewidth=0.4, zorder=0)
                result = results.get(data_set, method)
                ours = None if result is None else moments_of(result)
                _draw(axes, row, method, ours, published.get((data_set, method)))
                if limit is not None and result is not None and result.is_stopped:
                    axes.plot(limit, row - _BELOW / 2, "|", color=INK, markersize=7, markeredgewidth=1.6)
    figure.supxlabel(abscissa, fontsize=9.0)
    figure.legend(handles=_legend(methods), loc="outside upper center", ncols=4)
    return figure


def _draw(axes: Axes, row: int, method: str, ours: SampleMoments | None, source: Estimate | None) -> None:
    """Draw our mean with its interval, and the source's below it with hollow marks."""
    if source is not None and not math.isnan(source.value):
        place = row + _BELOW
        half = source.spread or 0.0
        axes.plot((source.value - half, source.value + half), (place, place), "-", color=GREY, linewidth=0.9)
        axes.plot(source.value, place, "o", color=GREY, markerfacecolor=PAPER, markersize=3.6)
    if ours is not None:
        interval = ours.interval()
        color, place = _COLORS.get(method, INK), row - _BELOW / 2
        axes.plot((interval.low, interval.high), (place, place), "-", color=color, linewidth=1.4)
        axes.plot(interval.mean, place, "o", color=color, markersize=4.2)


def _legend(methods: Sequence[str]) -> list[Line2D]:
    def handle(color: str, label: str, face: str) -> Line2D:
        return Line2D([], [], color=color, marker="o", markersize=4.2, markerfacecolor=face, label=label)

    named = [handle(color, METHODS[name].title, color) for name, color in _COLORS.items() if name in methods]
    others = [handle(INK, "others", INK)] if set(methods) - set(_COLORS) else []
    return [*named, *others, handle(GREY, "Palmer (2015)", PAPER)]
