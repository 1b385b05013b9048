"""A run folder as text: the metrics of its iterations, and the trees or questions it learned."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from typing import Any

from relforest.reports.learning_figure import mean_and_deviation
from relforest.reports.questions_in_words import questions_in_words
from relforest.rl.fitted.value import QValue
from relforest.rl.saved_policy import read_policy
from relforest.rl.value import ValueFunction
from relforest.runs.learner import METRIC_NAMES
from relforest.runs.store import read_checkpoint
from relforest.trees.text import describe


def run_report(folder: str | PathLike[str]) -> str:
    """Describe what a run has learned: a line of metrics per iteration, then its trees or main questions.

    Parameters
    ----------
    folder : path
        The folder of a single run, see `relforest.runs.store`.

    Raises
    ------
    ModelFormatError
        If a file is missing or malformed.
    InputError
        If smrf-q has not learned anything in it yet.
    """
    checkpoint = read_checkpoint(folder)
    value = read_policy(folder)
    words = questions_in_words(value) if isinstance(value, QValue) else trees_in_words(value)
    return f"{metrics_table(checkpoint.metrics)}\n\n{words}"


def metrics_table(rows: Iterable[Mapping[str, Any]], names: Sequence[str] = METRIC_NAMES) -> str:
    """Return the named metrics as a text table, one line per row; missing values are dashes."""
    return _aligned(names, [[_cell(row.get(name)) for name in names] for row in rows])


def averages_table(runs: Sequence[Sequence[Mapping[str, Any]]], names: Sequence[str] = METRIC_NAMES) -> str:
    """Return the mean and the standard deviation of each named metric over runs, one line per iteration.

    The first name must be that of the iteration.
    """
    iterations = sorted({int(row["iteration"]) for run in runs for row in run})
    columns = []
    for name in names[1:]:
        measured = [[row for row in run if row.get(name) is not None] for run in runs]
        found = zip(*mean_and_deviation(measured, name), strict=True)
        cells = {int(i): f"{mean:.3f} ({deviation:.3f})" for i, mean, deviation in found}
        columns.append([cells.get(i, "-") for i in iterations])
    rows = [[str(i), *cells] for i, *cells in zip(iterations, *columns, strict=True)]
    return _aligned(names, rows)


def trees_in_words(value: ValueFunction) -> str:
    """Return every tree of an action-value function in words, by action type."""
    parts = []
    for action_type, trees in zip(value.action_types, value.forests, strict=True):
        name = action_type.name
        if action_type.parameters:
            name += f"({', '.join(action_type.parameters)})"
        parts.append(f"{name}: {len(trees) or 'no'} tree{'' if len(trees) == 1 else 's'}")
        for number, tree in enumerate(trees, start=1):
            # Advice for classifiers: here trees are features.
            words = describe(tree.schema, tree.nodes, other=None)
            parts.append(f"{name}, tree {number}: {words}")
    return "\n\n".join(parts)


def _cell(value: object) -> str:
    if value is None:
        return "-"
    return f"{value:.3f}" if isinstance(value, float) else str(value)


def _aligned(names: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return rows below the names of the metrics, with right-aligned columns."""
    lines = [[name.replace("_", " ") for name in names], *rows]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    return "\n".join(
        "  ".join(cell.rjust(width) for cell, width in zip(line, widths, strict=True)) for line in lines
    )
