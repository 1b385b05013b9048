"""The study's table as samples: all values of one measure, and their mean with its interval."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from relforest.experiments.sheets import Estimate
from relforest.experiments.table import Table

Key: TypeAlias = tuple[str, str, str]
"""Part, condition and measure."""

_NOTHING = np.empty(0)


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
        """Group the rows of a table; missing values are left out."""
        found = table.groups("part", "condition", "measure").items()
        values = {(str(part), str(condition), str(name)): rows for (part, condition, name), rows in found}
        numbers = {key: rows.numbers("value") for key, rows in values.items()}
        return cls({key: column[~np.isnan(column)] for key, column in numbers.items()})

    def __getitem__(self, key: Key) -> NDArray[np.float64]:
        """Return the values of a measure; none if it was never taken."""
        return self.values.get(key, _NOTHING)

    def mean(self, key: Key) -> Estimate:
        """Return the mean of a measure."""
        return Estimate.of(self[key])

    def measured(self, part: str, conditions: Iterable[str], measure: str) -> list[str]:
        """Return the conditions of a part under which a measure was taken."""
        return [condition for condition in conditions if len(self[part, condition, measure])]
