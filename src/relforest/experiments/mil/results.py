"""Table -> what was measured of each method on each data set, and means over data sets."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import final

import numpy as np

from relforest.experiments.mil.data import COMPARED, DATA_SETS
from relforest.experiments.mil.methods import IMPROVED, METHODS
from relforest.experiments.mil.settings import ALPHA, N_COMPARISONS, STOPPED
from relforest.experiments.table import Cell, Table
from relforest.metrics import SampleMoments, sidak_level, two_sample_p_value


@final
@dataclass(frozen=True, slots=True)
class Result:
    """One method on one data set."""

    scores: tuple[float, ...]
    times: tuple[float, ...]
    """Peirce skill scores and CPU seconds of the folds that were done."""
    peak_bytes: int  # the largest memory of its processes
    is_stopped: bool  # whether a fold took too long
    facts: Mapping[str, Cell]  # the chosen parameters and the size of the data; unknown ones are None

    @property
    def skill(self) -> SampleMoments | None:
        """Mean and spread of the scores; None if it was stopped."""
        return None if self.is_stopped else SampleMoments.of(self.scores)

    @property
    def seconds(self) -> SampleMoments | None:
        """Mean and spread of the times; None if it was stopped."""
        return None if self.is_stopped else SampleMoments.of(self.times)


_FACTS = ("C", "gamma_factor", "n_bags", "n_positive", "n_instances", "n_features")


@final
@dataclass(frozen=True, slots=True)
class Results:
    """All that was measured."""

    by_cell: Mapping[tuple[str, str], Result]  # name of the data set and of the method -> result

    @classmethod
    def of(cls, table: Table) -> Results:
        """Group the rows of a table."""
        cells = table.groups("data_set", "method")
        return cls({(str(data_set), str(method)): _result(own) for (data_set, method), own in cells.items()})

    @property
    def data_sets(self) -> tuple[str, ...]:
        """The data sets with results, in the order of the source."""
        return tuple(name for name in DATA_SETS if any(name == key[0] for key in self.by_cell))

    @property
    def methods(self) -> tuple[str, ...]:
        """The methods with results, in the order of the tables."""
        return tuple(name for name in METHODS if any(name == key[1] for key in self.by_cell))

    def mean(self, data_set: str, method: str) -> float:
        """Return the mean score of a method on a data set; NaN if it was stopped or not chosen."""
        found = self.get(data_set, method)
        return float("nan") if found is None or found.skill is None else found.skill.mean

    def get(self, data_set: str, method: str) -> Result | None:
        """Return the result of a method on a data set; None if they were not chosen."""
        return self.by_cell.get((data_set, method))


def mark(ours: SampleMoments | None, other: SampleMoments | None, *, is_cost: bool = False) -> str:
    """Return the sign of a significant difference between covariant aggregation and another method.

    Return ``">"`` if ours is more, ``"<"`` if it is less, empty if the difference is not significant: in a
    two-tailed two-sample t-test at the level .05 where the other is better, and at the level corrected by
    Sidak for the number of comparisons where ours is.

    Parameters
    ----------
    ours, other : SampleMoments or None
        Of covariant aggregation and of the other method; None for one that was stopped.
    is_cost : bool
        Whether less is better.

    References
    ----------
    Palmer (2015), section 3.3.3.
    """
    if ours is None or other is None:
        return ""
    is_more = ours.mean > other.mean
    is_better = is_more != is_cost
    level = sidak_level(ALPHA, N_COMPARISONS) if is_better else ALPHA
    if two_sample_p_value(ours, other) >= level:
        return ""
    return ">" if is_more else "<"


@final
@dataclass(frozen=True, slots=True)
class Mean:
    """A method over the data sets that it was tried on."""

    n_data_sets: int
    n_stopped: int
    """On how many it was tried, and stopped."""
    with_zeros: float  # mean score with 0 for those where it was stopped; NaN if it was tried on none
    of_finished: float  # mean score over those it finished; NaN if there is none
    improved_with_zeros: float
    improved_on_finished: float
    """The improved method's mean score over the same data sets; NaN if it was not tried on one of them."""

    @property
    def lead(self) -> float:
        """How much better the improved method is, in the comparison that is worse for it."""
        return float(
            np.fmin(self.improved_with_zeros - self.with_zeros, self.improved_on_finished - self.of_finished)
        )


def means(results: Results, method: str, among: Collection[str] = COMPARED) -> Mean:
    """Return the means of a method over the data sets it was tried on, as far as they are `among` these."""
    tried = [name for name in results.data_sets if name in among and results.get(name, method) is not None]
    own, other = (np.array([results.mean(name, one) for name in tried]) for one in (method, IMPROVED))
    finished = ~np.isnan(own)
    if all(results.get(name, IMPROVED) is not None for name in tried):
        # Where it was stopped itself, it has 0 as well.
        other = np.nan_to_num(other)
    else:
        other = np.full(len(tried), np.nan)
    samples = (np.nan_to_num(own), own[finished], other, other[finished])
    numbers = (float(sample.mean()) if len(sample) else float("nan") for sample in samples)
    return Mean(len(tried), int((~finished).sum()), *numbers)


def _result(rows: Table) -> Result:
    state, peaks = rows.cells("state"), rows.numbers("peak_bytes")
    done = [row for row in rows.rows if row["state"] != STOPPED]
    facts = (done or rows.rows)[0]
    scores, times = (rows.numbers(name)[[one != STOPPED for one in state]] for name in ("pss", "cpu_seconds"))
    return Result(
        tuple(scores.tolist()),
        tuple(times.tolist()),
        int(np.nan_to_num(peaks).max()),
        len(done) < len(rows),
        {name: facts[name] for name in _FACTS},
    )
