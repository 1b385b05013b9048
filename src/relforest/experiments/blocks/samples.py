"""The study's table as samples: all values of one measure, and their mean with its interval."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from relforest.experiments.table import Table
from relforest.metrics import NORMAL_95

Key: TypeAlias = tuple[str, str, str]
"""Part, condition and measure."""

_NOTHING = np.empty(0)


@final
@dataclass(frozen=True, slots=True)
class Mean:
    """A mean and half the width of its 95 % interval.

    Parameters
    ----------
    value, error : float
        NaN where values are missing or too few.
    """

    value: float
    error: float

    @classmethod
    def of(cls, values: NDArray[np.float64]) -> Mean:
        """Return the mean of (n,) values."""
        n = len(values)
        error = NORMAL_95 * float(values.std(ddof=1)) / n**0.5 if n > 1 else float("nan")
        return cls(float(values.mean()) if n else float("nan"), error)

    def minus(self, other: Mean) -> Mean:
        """Return the difference to another mean, of values drawn independently."""
        return Mean(self.value - other.value, float(np.hypot(self.error, other.error)))

    def text(self, digits: int = 2) -> str:
        """Return the mean and its interval."""
        if np.isnan(self.value):
            return "-"
        if np.isnan(self.error):
            return f"{self.value:.{digits}f}"
        return f"{self.value:.{digits}f} +- {self.error:.{digits}f}"


@final
@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """All values by part, condition and measure.

    Parameters
    ----------
    values : mapping
        Key -> (n,) float64.
    """

    values: Mapping[Key, NDArray[np.float64]]

    @classmethod
    def of(cls, table: Table) -> Samples:
        """Group the rows of a table in one pass."""
        grouped: dict[Key, list[float]] = {}
        for row in table.rows:
            key = (str(row["part"]), str(row["condition"]), str(row["measure"]))
            value = row["value"]
            if isinstance(value, (int, float)):
                grouped.setdefault(key, []).append(float(value))
        return cls({key: np.array(values) for key, values in grouped.items()})

    def __getitem__(self, key: Key) -> NDArray[np.float64]:
        """Return the values of a measure; none if it was never taken."""
        return self.values.get(key, _NOTHING)

    def mean(self, key: Key) -> Mean:
        """Return the mean of a measure."""
        return Mean.of(self[key])

    def measured(self, part: str, conditions: Iterable[str], measure: str) -> list[str]:
        """Return the conditions of a part under which a measure was taken."""
        return [condition for condition in conditions if len(self[part, condition, measure])]
