"""Table -> pictures: how long drops take, options beside the author's simulator, totals of the policies."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from relforest.experiments.blocks import settings
from relforest.experiments.samples import Samples
from relforest.experiments.sheets import Estimate
from relforest.experiments.table import Table
from relforest.reports.style import BLUE, GREY, INK, MARKERS, ORANGE, PALE, PAPER, mixed, styled

_LONGEST_SHOWN = 700
_MOST_DOTS = 1000


def figures(table: Table) -> Mapping[str, Figure]:
    """Draw the steps of drops, the options beside the author's simulator, and the totals of the policies."""
    samples = Samples.of(table, "part", "condition", "measure")
    with styled():
        return {
            "settle.png": _settle_figure(samples),
            "options.png": _options_figure(samples),
            "totals.png": _totals_figure(samples),
        }


def _settle_figure(samples: Samples) -> Figure:
    figure = Figure(figsize=(7.0, 3.0), layout="constrained")
    for place, scenario in enumerate((settings.RANDOM_BLOCKS, settings.ARCH_BLOCKS)):
        axes = figure.add_subplot(1, 2, place + 1)
        steps = np.sort(samples[settings.SETTLE, scenario, "steps"])
        axes.plot(steps, np.arange(1, len(steps) + 1) / len(steps), color=BLUE, label="ours")
        for name, color, marker, size in ((settings.AUTHOR, INK, "o", 9), (settings.PLAIN, ORANGE, "D", 5)):
            reference = settings.SETTLE_REFERENCE[scenario, name]
            steps_known = (reference["median"], reference["p90"], 500)
            shares = (0.5, 0.9, 1 - reference["over"])
            axes.plot(
                steps_known, shares, marker, color=color, markersize=size, markerfacecolor=PAPER, label=name
            )
        axes.set_xlim(0, _LONGEST_SHOWN)
        axes.set_ylim(0, 1.03)
        axes.set_title(scenario, loc="left")
        axes.set_xlabel("steps of 0.01 s until all lie still")
        axes.grid(axis="y", color=PALE, linewidth=0.6)
        if place == 0:
            axes.set_ylabel("share of drops")
            axes.legend(loc="lower right")
    return figure


def _options_figure(samples: Samples) -> Figure:
    figure = Figure(figsize=(7.4, 3.6), layout="constrained")
    shown = {
        "duration in seconds": [key for key in settings.OPTION_REFERENCE if key[2].endswith("duration")],
        "share that succeeds": [key for key in settings.OPTION_REFERENCE if key[2].endswith("success")],
    }
    for place, (title, keys) in enumerate(shown.items()):
        axes = figure.add_subplot(1, 2, place + 1)
        for row, key in enumerate(keys):
            author, plain = settings.OPTION_REFERENCE[key]
            axes.axhline(row, color=PALE, linewidth=0.6, zorder=0)
            own = samples.mean(key)
            axes.errorbar(
                own.value, row, xerr=own.spread or 0.0, fmt="o", color=BLUE, capsize=0, label="ours"
            )
            known = ((author, "o", INK, 9, settings.AUTHOR), (plain, "D", ORANGE, 6, settings.PLAIN))
            for value, marker, color, size, name in known:
                axes.plot(value, row, marker, color=color, markersize=size, mfc="none", label=name)
        axes.set_yticks(range(len(keys)), [_named(key) for key in keys])
        axes.set_ylim(len(keys) - 0.5, -0.5)
        axes.set_xlabel(title)
        if place == 0:
            axes.set_xlim(left=0)
            handles, labels = axes.get_legend_handles_labels()
            entries = dict(zip(labels, handles, strict=True))
            shown_names = ("ours", settings.AUTHOR, settings.PLAIN)
            shown_handles = [entries[name] for name in shown_names]
            figure.legend(shown_handles, shown_names, loc="outside upper center", ncols=3)
    return figure


def _named(key: tuple[str, str, str]) -> str:
    part, policy, measure = key
    option = measure.rpartition("_")[0].replace("_", ", ")
    return f"{option}\n({settings.TASK_TITLES[part]}, {policy})"


def _totals_figure(samples: Samples) -> Figure:
    figure = Figure(figsize=(8.4, 3.4), layout="constrained")
    widths = [1 + len(policies) for policies in settings.POLICIES.values()]
    grid = figure.add_gridspec(1, len(widths), width_ratios=widths)
    ordinates = ("gain in mean height", "gain in score", "score of the final arch")
    for place, ((part, policies), ordinate) in enumerate(
        zip(settings.POLICIES.items(), ordinates, strict=True)
    ):
        axes = figure.add_subplot(grid[place])
        for column, policy in enumerate(policies):
            _draw_totals(axes, column, samples[part, policy, "total"], MARKERS[column])
        axes.set_xticks(
            range(len(policies)), [name.replace(", ", "\n").replace("-", "\n") for name in policies]
        )
        axes.set_xlim(-0.6, len(policies) - 0.4)
        axes.set_title(settings.TASK_TITLES[part], loc="left")
        axes.set_ylabel(ordinate)
        axes.axhline(0, color=PALE, linewidth=0.8, zorder=0)
    return figure


def _draw_totals(axes: Axes, column: int, totals: NDArray[np.float64], marker: str) -> None:
    """Draw every total as a faint dot, and the mean with its interval over them."""
    if not len(totals):
        return
    shown = totals[:_MOST_DOTS]
    # Spread by rank, not at random: equal tables give equal pictures.
    places = column + 0.3 * (2 * ((np.arange(len(shown)) * 0.618034) % 1) - 1)
    axes.plot(places, shown, ".", color=mixed(BLUE, 0.35), markersize=2.2, markeredgewidth=0, zorder=1)
    mean = Estimate.of(totals)
    axes.errorbar(column, mean.value, yerr=mean.spread or 0.0, fmt=marker, color=ORANGE, capsize=3, zorder=3)
    axes.annotate(
        f"{mean.value:.1f}" if abs(mean.value) >= 10 else f"{mean.value:.2f}",
        (column, mean.value),
        (9, 0),
        textcoords="offset points",
        fontsize=8.0,
        color=INK,
        va="center",
        bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": GREY, "linewidth": 0.4},
    )
