"""A table in a file; only the columns that are used are read."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from relforest.scenes.arrow import ArrowTable
from relforest.scenes.columns import check_named


@dataclass(frozen=True, slots=True, eq=False)
class TableFile(ABC):
    """A table with known columns that are read on demand."""

    origin: str  # the file, for messages
    names: tuple[str, ...]  # the columns, in order; unused ones may share a name
    metadata: Mapping[bytes, bytes]  # of a Parquet file

    @abstractmethod
    def load(self, chosen: Sequence[str]) -> ArrowTable:
        """Return the named columns, each of which occurs once."""

    def read(self, names: Sequence[str]) -> ArrowTable:
        """Read some columns.

        Raises
        ------
        InputError
            If a column is missing or ambiguous, or its values cannot be read.
        """
        chosen = tuple(dict.fromkeys(names))
        check_named(chosen, self.names, self.origin)
        return self.load(chosen)
