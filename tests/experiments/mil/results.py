"""Rows of the study with given scores and times."""

from __future__ import annotations

from collections.abc import Sequence

from relforest.experiments.mil.results import Results
from relforest.experiments.mil.settings import DONE, STOPPED
from relforest.experiments.table import Row, Table


def rows(
    data_set: str,
    method: str,
    *,
    pss: Sequence[float | None],
    seconds: Sequence[float | None] | float = 1.0,
    peak: Sequence[int] | int = 10**8,
    chosen: tuple[float, float] | None = None,
) -> list[Row]:
    """Return a row per fold; a score of None is that of a fold that was stopped."""
    times = [seconds] * len(pss) if isinstance(seconds, float) else seconds
    peaks = [peak] * len(pss) if isinstance(peak, int) else peak
    return [
        {
            "data_set": data_set,
            "method": method,
            "fold": fold,
            "state": STOPPED if score is None else DONE,
            "pss": score,
            "cpu_seconds": None if score is None else times[fold],
            "peak_bytes": peaks[fold],
            "C": None if chosen is None else chosen[0],
            "gamma_factor": None if chosen is None else chosen[1],
            **dict.fromkeys(
                ("n_bags", "n_positive", "n_instances", "n_features"), None if score is None else 92
            ),
        }
        for fold, score in enumerate(pss)
    ]


def around(mean: float) -> list[float]:
    """Return ten scores with this mean and a standard deviation of .1054."""
    return [mean - 0.1, mean + 0.1] * 5


def results_of(*parts: list[Row]) -> Results:
    """Return the results of all these rows."""
    return Results.of(Table.of(row for part in parts for row in part))
