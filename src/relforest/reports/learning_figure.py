"""Learning curves: a quantity per iteration, averaged over independent runs.

Compare Figures 7.2 to 7.4 of Palmer (2015).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from relforest.reports.style import GREY, MARKERS, SERIES, styled
from relforest.support.errors import InputError

Row = Mapping[str, Any]
Runs = Sequence[Sequence[Row]]

_SIZE: Final = (5.6, 3.6)
# Series are shifted, so that error bars of one iteration do not hide each other.
_SHIFT: Final = 0.06


def reward_figure(
    metrics_by_run: Mapping[str, Runs], *, title: str = "", optimum: float | None = None
) -> Figure:
    """Draw the mean total reward per iteration, with standard deviations across runs.

    Parameters
    ----------
    metrics_by_run : mapping of str to runs
        Runs of each labelled series. A run is a sequence of rows with the keys ``iteration`` and
        ``test_reward``, as in ``metrics.jsonl``.
    title : str
    optimum : float, optional
        Reward of an optimal policy, drawn as a line.

    Raises
    ------
    InputError
        If no series is given, a series has no runs or rows, or a key is missing.

    References
    ----------
    Palmer (2015), Figures 7.2 and 7.3.
    """
    figure = _series_figure(metrics_by_run, "test_reward", "mean total reward per test episode", title)
    if optimum is not None:
        with styled():
            axes = figure.axes[0]
            axes.axhline(optimum, color=GREY, linewidth=0.9, linestyle="--", zorder=0.5)
            axes.annotate(
                f"optimum\n{optimum:g}",
                (1.0, optimum),
                xycoords=("axes fraction", "data"),
                xytext=(4, 0),
                textcoords="offset points",
                ha="left",
                va="center",
                fontsize=8.0,
                color=GREY,
            )
    return figure


def leaves_figure(metrics_by_run: Mapping[str, Runs], *, title: str = "") -> Figure:
    """Draw the mean number of leaves of all trees per iteration, with standard deviations across runs.

    Parameters as for `reward_figure`; rows need the keys ``iteration`` and ``leaves``.

    References
    ----------
    Palmer (2015), Figure 7.4.
    """
    return _series_figure(metrics_by_run, "leaves", "leaves of all trees", title)


def mean_and_deviation(
    runs: Runs, key: str
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Return iterations, means and standard deviations (0 for a single run) of a quantity; each (k,).

    Runs may differ in length.

    Raises
    ------
    InputError
        If no run or row is given, or a key is missing from a row or not a number.
    """
    values: dict[int, list[float]] = {}
    for run in runs:
        for row in run:
            try:
                values.setdefault(int(row["iteration"]), []).append(float(row[key]))
            except (KeyError, TypeError, ValueError) as error:
                raise InputError(
                    f"'iteration' or {key!r} is missing or not a number in a row of metrics: {row!r:.200}"
                ) from error
    if not values:
        raise InputError("nothing to draw: a series needs at least one run with one row of metrics")
    iterations = sorted(values)
    means = [float(np.mean(values[iteration])) for iteration in iterations]
    deviations = [
        float(np.std(values[iteration], ddof=1)) if len(values[iteration]) > 1 else 0.0
        for iteration in iterations
    ]
    return np.array(iterations), np.array(means), np.array(deviations)


def _series_figure(series: Mapping[str, Runs], key: str, ylabel: str, title: str) -> Figure:
    if not series:
        raise InputError("nothing to draw: pass at least one series of runs")
    with styled():
        figure = Figure(figsize=_SIZE, layout="constrained")
        axes = figure.add_subplot()
        lines = []
        for number, runs in enumerate(series.values()):
            iterations, means, deviations = mean_and_deviation(runs, key)
            shift = (number - (len(series) - 1) / 2) * _SHIFT
            lines.append(
                axes.errorbar(
                    iterations + shift,
                    means,
                    yerr=deviations if len(runs) > 1 else None,
                    color=SERIES[number % len(SERIES)],
                    marker=MARKERS[number % len(MARKERS)],
                    markersize=5,
                    capsize=3,
                    elinewidth=1.0,
                )
            )
        axes.set_xlabel("iteration")
        axes.set_ylabel(ylabel)
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        axes.grid(axis="y", color=GREY, alpha=0.2, linewidth=0.6)
        axes.margins(x=0.04)
        notes = sorted({len(runs) for runs in series.values() if len(runs) > 1})
        if notes:
            counts = " or ".join(map(str, notes))
            axes.annotate(
                f"mean and standard deviation of {counts} runs",
                (0.0, 1.0),
                xycoords="axes fraction",
                xytext=(0, 4),
                textcoords="offset points",
                va="bottom",
                fontsize=8.0,
                color=GREY,
            )
        if title:
            axes.set_title(title, loc="left", pad=18.0 if notes else None, parse_math=False)
        if len(series) > 1:
            legend = axes.legend(lines, list(series), loc="best")
            for text in legend.get_texts():
                text.set_parse_math(False)
    return figure
