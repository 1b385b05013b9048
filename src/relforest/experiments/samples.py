"""A table with a number per row as samples: all numbers of one measure under one condition."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from relforest.experiments.sheets import Estimate
from relforest.experiments.table import Table

Key: TypeAlias = tuple[str, ...]
_NOTHING: Final = np.empty(0)


@final
@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """All numbers by what was measured."""

    values: Mapping[Key, NDArray[np.float64]]
    """What was measured, such as part, condition and measure -> (n,) float64 in the order of the table."""

    @classmethod
    def of(cls, table: Table, *columns: str) -> Samples:
        """Group the column ``value`` of a table by other columns; empty cells are left out."""
        found = {key: own.numbers("value") for key, own in table.groups(*columns).items()}
        return cls({tuple(map(str, key)): column[~np.isnan(column)] for key, column in found.items()})

    def __getitem__(self, key: Key) -> NDArray[np.float64]:
        """Return the numbers of a measure; none if it was never taken."""
        return self.values.get(key, _NOTHING)

    def mean(self, key: Key) -> Estimate:
        """Return the mean of a measure; NaN if it was never taken."""
        return Estimate.of(self[key])

    def below(self, *key: str) -> dict[str, NDArray[np.float64]]:
        """Return the numbers that were measured under a condition, by what follows it in their keys."""
        size = len(key)
        return {
            " ".join(whole[size:]): values
            for whole, values in self.values.items()
            if whole[:size] == key and len(values)
        }
