"""Table -> what was measured of each method on each data set."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import final

from relforest.experiments.mil.data import DATA_SETS
from relforest.experiments.mil.methods import METHODS
from relforest.experiments.mil.settings import ALPHA, N_COMPARISONS
from relforest.experiments.mil.steps import STOPPED
from relforest.experiments.table import Cell, Table
from relforest.metrics import Moments, sidak_level, two_sample_p_value
from relforest.support.errors import RunFolderError


@final
@dataclass(frozen=True, slots=True)
class Result:
    """One method on one data set.

    Parameters
    ----------
    scores, times : tuple of float
        Peirce skill scores and CPU seconds of the folds that were done.
    peak_bytes : int
        The largest memory of its processes.
    is_stopped : bool
        Whether a fold took too long; the others were then not done.
    facts : mapping
        The chosen parameters and the size of the data; unknown ones are None.
    """

    scores: tuple[float, ...]
    times: tuple[float, ...]
    peak_bytes: int
    is_stopped: bool
    facts: Mapping[str, Cell]

    @property
    def skill(self) -> Moments | None:
        """Mean and spread of the scores; None if it was stopped."""
        return None if self.is_stopped else Moments.of(self.scores)

    @property
    def seconds(self) -> Moments | None:
        """Mean and spread of the times; None if it was stopped."""
        return None if self.is_stopped else Moments.of(self.times)


_FACTS = ("C", "gamma_factor", "n_bags", "n_positive", "n_instances", "n_features")


@final
@dataclass(frozen=True, slots=True)
class Results:
    """All that was measured.

    Parameters
    ----------
    by_cell : mapping
        Name of the data set and of the method -> result.
    """

    by_cell: Mapping[tuple[str, str], Result]

    @classmethod
    def of(cls, table: Table) -> Results:
        """Group the rows of a table.

        Raises
        ------
        RunFolderError
            If the score or the time of a finished fold is missing.
        """
        rows: dict[tuple[str, str], list[Mapping[str, Cell]]] = {}
        for row in table.rows:
            rows.setdefault((str(row["data_set"]), str(row["method"])), []).append(row)
        return cls(MappingProxyType({key: _result(own) for key, own in rows.items()}))

    @property
    def data_sets(self) -> tuple[str, ...]:
        """The data sets with results, in the order of the source."""
        return tuple(name for name in DATA_SETS if any(name == key[0] for key in self.by_cell))

    @property
    def methods(self) -> tuple[str, ...]:
        """The methods with results, in the order of the tables."""
        return tuple(name for name in METHODS if any(name == key[1] for key in self.by_cell))

    def get(self, data_set: str, method: str) -> Result | None:
        """Return the result of a method on a data set; None if they were not chosen."""
        return self.by_cell.get((data_set, method))


def mark(ours: Moments | None, other: Moments | None, *, is_cost: bool = False) -> str:
    """Return the sign of a significant difference between covariant aggregation and another method.

    Parameters
    ----------
    ours, other : Moments or None
        Of covariant aggregation and of the other method; None for one that was stopped.
    is_cost : bool
        Whether less is better.

    Returns
    -------
    str
        ``">"`` if ours is more, ``"<"`` if it is less, empty if the difference is not significant: in a
        two-tailed two-sample t-test at the level .05 where the other is better, and at the level corrected
        by Sidak for the number of comparisons where ours is.

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


def _result(rows: list[Mapping[str, Cell]]) -> Result:
    done = [row for row in rows if row["state"] != STOPPED]
    facts = (done or rows)[0]
    return Result(
        tuple(_number(row, "pss") for row in done),
        tuple(_number(row, "cpu_seconds") for row in done),
        max(int(_number(row, "peak_bytes")) for row in rows),
        len(done) < len(rows),
        MappingProxyType({name: facts[name] for name in _FACTS}),
    )


def _number(row: Mapping[str, Cell], column: str) -> float:
    value = row[column]
    if value is None:
        raise RunFolderError(
            f"{row['data_set']}, {row['method']}, fold {row['fold']} is {row['state']}, but its {column} is "
            f"missing: delete cells/{row['data_set']}/{row['method']}.json and the file in settings that "
            "contains this row to compute them again"
        )
    return float(value)
