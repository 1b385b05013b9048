"""Curves of learning: those of the source's figures, and one of all other learners."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Final, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from relforest.experiments.learning.settings import (
    ARCH,
    COLORS,
    DONE,
    KEEPAWAY,
    LARGER,
    LEARNERS,
    OURS,
    RGB,
    SARSA,
    TOWERS,
)
from relforest.experiments.learning.statements import measured
from relforest.experiments.table import Table
from relforest.reports.style import GREY, MARKERS, SERIES, styled

Curve: TypeAlias = tuple[str, str]
"""Where was played, and the condition."""

_RPI: Final = "smrf-rpi-500"
_LABELS: Final = {"reward": "mean reward of a test episode", "leaves": "leaves of all trees"}
# More curves need a legend beside them.
_FEW: Final = 5


def _in(played: str, *conditions: str) -> tuple[Curve, ...]:
    return tuple((played, condition) for condition in conditions)


_VARIANTS: Final = _in(
    KEEPAWAY,
    "smrf-rpi-500-long",
    "smrf-rpi-500-once",
    "smrf-rpi-500-single",
    "smrf-rpi-500-single-tree",
    "smrf-rpi-50",
    "smrf-rpi-50-single",
)
SOURCE: Final[Mapping[str, Mapping[str, tuple[str, tuple[Curve, ...]]]]] = {
    TOWERS: {"figure-7.8.png": ("reward", _in(TOWERS, _RPI, "large-first", "small-first"))},
    COLORS: {
        "figure-7.12.png": ("reward", _in(COLORS, _RPI, "manual")),
        "figure-7.13.png": ("reward", _in(RGB, "smrf-rpi-500-rgb", "manual")),
        "figure-7.14.png": ("leaves", ((COLORS, _RPI), (RGB, "smrf-rpi-500-rgb"))),
    },
    ARCH: {"figure-7.18.png": ("reward", (*_in(DONE, _RPI), *_in(ARCH, "careful", "trainer")))},
    KEEPAWAY: {
        "figure-7.21.png": ("reward", _in(KEEPAWAY, "smrf-rpi-50", "cmac-sarsa-shared-50")),
        "figure-7.22.png": ("reward", _in(KEEPAWAY, "smrf-rpi-500-long", "cmac-sarsa-shared-500")),
        "figure-7.23.png": ("reward", _in(KEEPAWAY, "sarsa-on-smrf", SARSA)),
        "figure-7.24.png": (
            "reward",
            _in(LARGER[0], "smrf-rpi-500-once", "smrf-rpi-500-long", "cmac-sarsa-shared-4v3"),
        ),
        "figure-7.25.png": ("reward", _VARIANTS),
        "figure-7.26.png": ("leaves", _VARIANTS),
    },
}
"""Task -> file name -> what is drawn, and the curves."""
_BY_BATCH: Final = frozenset({"figure-7.25.png", "figure-7.26.png"})
"""Those that compare batches of different sizes."""


def figures(task: str, table: Table) -> Mapping[str, Figure]:
    """Draw the figures of the source for which there are runs, and one of all other learners."""
    found = dict.fromkeys((str(row["played"]), str(row["condition"])) for row in table.rows)
    in_source = {curve for _, curves in SOURCE[task].values() for curve in curves} - {(KEEPAWAY, SARSA)}
    rest = [
        curve
        for curve in found
        if curve[0] == task
        and (curve not in in_source or curve[1] not in LEARNERS)
        and not curve[1].startswith(f"{OURS},")
    ]
    wanted = {"learning.png": ("reward", tuple(rest)), **SOURCE[task]}
    there = {
        name: (column, [curve for curve in curves if curve in found])
        for name, (column, curves) in wanted.items()
    }
    return {
        name: _drawn(table, column, curves, by_batch=name in _BY_BATCH)
        for name, (column, curves) in there.items()
        if any(condition in LEARNERS for _, condition in curves)
    }


def _drawn(table: Table, column: str, curves: Iterable[Curve], *, by_batch: bool) -> Figure:
    """Draw learners by their training episodes or batches of them, and hand-made policies as lines."""
    learners = [curve for curve in curves if curve[1] in LEARNERS]
    is_wide = len(learners) > _FEW
    with styled():
        figure = Figure(figsize=(7.6 if is_wide else 5.6, 3.6), layout="constrained")
        axes = figure.add_subplot()
        for place, curve in enumerate(learners):
            _draw_learner(axes, place, curve[1], tuple(_points(table, column, curve, by_batch=by_batch)))
        for played, condition in curves:
            if condition not in LEARNERS:
                level = float(measured(table, played, condition, 0).mean())
                axes.axhline(level, color=GREY, linestyle="--", linewidth=0.9)
                # Beside the axes, where no curve runs through it.
                at = ("axes fraction", "data")
                axes.annotate(condition, (1.0, level), (4, 0), at, "offset points", va="center")
        axes.set_xlabel(f"{'batches of ' if by_batch else ''}training episodes (band: all runs)")
        axes.set_ylabel(_LABELS[column])
        if is_wide:
            figure.legend(loc="outside right upper")
        else:
            axes.legend(frameon=True, framealpha=0.9, edgecolor="none")
    return figure


def _points(
    table: Table, column: str, curve: Curve, *, by_batch: bool
) -> Iterator[tuple[int, float, float, float]]:
    """Give training episodes or batches, mean, least and most of all runs that have such a number."""
    own = [row for row in table.rows if (row["played"], row["condition"]) == curve]
    for batch, episodes in enumerate(sorted({int(row["episodes"] or 0) for row in own})):
        values = measured(table, *curve, episodes, column)
        if len(values):
            yield (
                batch if by_batch else episodes,
                float(values.mean()),
                float(values.min()),
                float(values.max()),
            )


def _draw_learner(
    axes: Axes, place: int, label: str, points: tuple[tuple[int, float, float, float], ...]
) -> None:
    episodes, means, least, most = np.array(points, dtype=np.float64).T.reshape(4, -1)
    color = SERIES[place % len(SERIES)]
    # Those of the same color differ by their marker.
    marker = MARKERS[(place + place // len(SERIES)) % len(MARKERS)]
    axes.plot(episodes, means, color=color, marker=marker, label=label)
    axes.fill_between(episodes, least, most, color=color, alpha=0.15, linewidth=0)
