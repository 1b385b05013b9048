"""A table in a file of which only the columns that are used are read."""

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
    """A table whose columns are known, but not read yet.

    Parameters
    ----------
    origin : str
        The file, for messages.
    names : tuple of str
        The columns, in order; those that are not used may have the same name.
    load : callable
        Returns an arrow table with the columns named, each of which is there once.
    metadata : mapping of bytes to bytes
        What a Parquet file says about itself.
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
