"""Tidy rows, one observation each: what a study saves and its analysis reads."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError

Cell: TypeAlias = str | int | float | bool | None
Row: TypeAlias = dict[str, Cell]


@final
@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Rows with the same columns.

    Parameters
    ----------
    rows : tuple of dict
        One per observation.

    Raises
    ------
    InputError
        If the table is empty, or a row has other columns than the first.

    Examples
    --------
    >>> table = Table.of([{"set": "a", "score": 0.5}, {"set": "b", "score": 0.25}])
    >>> table.where(set="b").numbers("score").tolist()
    [0.25]
    """

    rows: tuple[Mapping[str, Cell], ...]

    def __post_init__(self) -> None:
        if not self.rows:
            raise InputError("a table needs at least one row")
        for number, row in enumerate(self.rows):
            if tuple(row) != self.columns:
                raise InputError(
                    f"row {number} has the columns {', '.join(row)}, but the first {', '.join(self.columns)}"
                )

    @classmethod
    def of(cls, rows: Iterable[Mapping[str, Cell]]) -> Table:
        """Build a table from any iterable of rows."""
        return cls(tuple(rows))

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.rows)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(self.rows[0])

    def cells(self, column: str) -> list[Cell]:
        """Return a column as it is.

        Raises
        ------
        InputError
            If the column does not exist.
        """
        if column not in self.columns:
            raise InputError(f"the table does not have a column {column!r}, only {', '.join(self.columns)}")
        return [row[column] for row in self.rows]

    def numbers(self, column: str) -> NDArray[np.float64]:
        """Return a column as (n_rows,) float64; an empty cell is NaN.

        Raises
        ------
        InputError
            If the column does not exist, or a cell is text.
        """
        cells = self.cells(column)
        for cell in cells:
            if isinstance(cell, str):
                raise InputError(f"column {column!r} contains text ({cell!r:.40}), not numbers")
        return np.array([np.nan if cell is None else cell for cell in cells], dtype=np.float64)

    def distinct(self, column: str) -> list[Cell]:
        """Return the values of a column without repetitions, in order of first appearance."""
        return list(dict.fromkeys(self.cells(column)))

    def where(self, **wanted: Cell) -> Table:
        """Return the rows in which every named column has the given value.

        Raises
        ------
        InputError
            If no row is left, or a column does not exist.
        """
        kept = [
            i for i in range(len(self)) if all(self.cells(name)[i] == value for name, value in wanted.items())
        ]
        if not kept:
            described = ", ".join(f"{name} = {value!r}" for name, value in wanted.items())
            raise InputError(f"no row has {described}")
        return Table(tuple(self.rows[i] for i in kept))

    def to_csv(self) -> str:
        """Return the table as CSV text with a header; floats are written with all their digits."""
        buffer = io.StringIO()
        writer = csv.writer(buffer, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows(row.values() for row in self.rows)
        return buffer.getvalue()


def aligned(header: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Lay out cells as text in columns: the first to the left, the others to the right.

    Parameters
    ----------
    header : iterable of str
    rows : iterable of iterable of str
        As many cells each as the header.

    Returns
    -------
    str
        One line per row, without a newline at the end.
    """
    lines = [list(header), *(list(row) for row in rows)]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    text = []
    for line in lines:
        first, *others = (
            cell.ljust(width) if place == 0 else cell.rjust(width)
            for place, (cell, width) in enumerate(zip(line, widths, strict=True))
        )
        text.append("  ".join((first, *others)).rstrip())
    return "\n".join(text)
