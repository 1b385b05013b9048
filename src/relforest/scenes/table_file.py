"""A table in a file; only the columns that are used are read."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import final

from relforest.scenes.arrow import ArrowTable
from relforest.scenes.columns import check_named

__all__ = ["TableFile"]


@final
@dataclass(frozen=True, slots=True, eq=False)
class TableFile:
    """A table with known columns that are read on demand.

    Parameters
    ----------
    origin : str
        The file, for messages.
    names : tuple of str
        The columns, in order; unused ones may share a name.
    load : callable
        Returns an arrow table of the named columns, each of which occurs once.
    metadata : mapping of bytes to bytes
        The metadata of a Parquet file.
    """

    origin: str
    names: tuple[str, ...]
    load: Callable[[Sequence[str]], ArrowTable]
    metadata: Mapping[bytes, bytes] = field(default_factory=dict)

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
