"""Table -> mean measures of all methods with their spread over repetitions, and what picking adds."""

from __future__ import annotations

from collections.abc import Iterator
from operator import attrgetter
from typing import Final

import numpy as np

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.mil.data import DATA_SETS, unavailable
from relforest.experiments.mil.methods import METHODS
from relforest.experiments.mil_folds.run import compute
from relforest.experiments.mil_folds.settings import SETTINGS, SMOKE
from relforest.experiments.registry import heading
from relforest.experiments.sheets import Entry, Estimate, Sheet
from relforest.experiments.study import Study
from relforest.experiments.table import Table

MEASURES: Final = ("balanced", "accuracy", "auc", "picked")
_TITLES: Final = ("balanced accuracy", "accuracy", "AUC", "accuracy, threshold picked on the test fold")
_CAPTION: Final = "Mean over folds, +- the standard deviation of this mean over repetitions"


def summarize(table: Table) -> Findings:
    """Lay out the means of each method on each data set."""
    columns = {"data set": "", "method": "", **dict.fromkeys(_TITLES, ".3f")}
    gain = float(np.mean(table.numbers("picked") - table.numbers("accuracy")))
    claim = Claim("what a threshold that is picked on each test fold adds to the accuracy", gain, low=0.02)
    return Findings("", (claim,), (Sheet(_CAPTION, columns, tuple(_rows(table))),))


def mean_of(table: Table, measure: str) -> Estimate:
    """Return the mean over repetitions of the mean over folds, and its standard deviation."""
    repetitions = [table.where(repetition=each) for each in table.distinct("repetition")]
    means = np.array([each.numbers(measure).mean() for each in repetitions])
    return Estimate(float(means.mean()), float(means.std(ddof=1)) if len(means) > 1 else None)


def _rows(table: Table) -> Iterator[tuple[Entry, ...]]:
    for data_set in map(str, table.distinct("data_set")):
        own = table.where(data_set=data_set)
        for method in map(str, own.distinct("method")):
            means = (mean_of(own.where(method=method), measure) for measure in MEASURES)
            yield (DATA_SETS[data_set].title, METHODS[method].title, *means)


STUDY: Final = Study(
    *heading(__package__),
    SETTINGS,
    SMOKE,
    compute,
    summarize,
    choices={"datasets": attrgetter("data_set"), "methods": attrgetter("method")},
    unavailable=unavailable,
)
