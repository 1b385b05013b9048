"""Means over data sets, with methods that did not finish all of them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from relforest.experiments.mil.cells import Results
from relforest.experiments.mil.data import DATA_SETS
from relforest.experiments.mil.methods import IMPROVED


@final
@dataclass(frozen=True, slots=True)
class Mean:
    """A method over the data sets that it was tried on.

    Parameters
    ----------
    n_data_sets, n_stopped : int
        On how many it was tried, and stopped.
    with_zeros : float
        Mean score with 0 for those where it was stopped; NaN if it was tried on none.
    of_finished : float
        Mean score over those it finished; NaN if there is none.
    improved_with_zeros, improved_on_finished : float
        The improved method's mean score over the same data sets; NaN if it was not tried on one of them.
    """

    n_data_sets: int
    n_stopped: int
    with_zeros: float
    of_finished: float
    improved_with_zeros: float
    improved_on_finished: float

    @property
    def lead(self) -> float:
        """How much better the improved method is, in the comparison that is worse for it."""
        return float(
            np.fmin(self.improved_with_zeros - self.with_zeros, self.improved_on_finished - self.of_finished)
        )


def means(results: Results, method: str, among: Collection[str] = tuple(DATA_SETS)) -> Mean:
    """Return the means of a method over the data sets it was tried on.

    Parameters
    ----------
    results : Results
    method : str
    among : collection of str
        Only of these data sets.
    """
    tried = [name for name in results.data_sets if name in among and results.get(name, method) is not None]
    own = np.array([_score(results, name, method) for name in tried])
    other = np.array([_score(results, name, IMPROVED) for name in tried])
    finished = ~np.isnan(own)
    was_tried = all(results.get(name, IMPROVED) is not None for name in tried)
    # Where it was stopped itself, it has 0 as well.
    other = np.nan_to_num(other) if was_tried else np.full(len(tried), np.nan)
    return Mean(
        len(tried),
        int((~finished).sum()),
        _mean(np.nan_to_num(own)),
        _mean(own[finished]),
        _mean(other),
        _mean(other[finished]),
    )


def _mean(values: NDArray[np.float64]) -> float:
    return float(values.mean()) if len(values) else float("nan")


def _score(results: Results, data_set: str, method: str) -> float:
    found = results.get(data_set, method)
    return float("nan") if found is None or found.skill is None else found.skill.mean
