"""Tidy rows, one observation each: what a study saves and its analysis reads."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping
from contextlib import suppress
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
        for name in wanted:
            self.cells(name)
        kept = tuple(row for row in self.rows if all(row[name] == value for name, value in wanted.items()))
        if not kept:
            described = ", ".join(f"{name} = {value!r}" for name, value in wanted.items())
            raise InputError(f"no row has {described}")
        return Table(kept)

    def groups(self, *columns: str) -> dict[tuple[Cell, ...], Table]:
        """Return the rows that have the same values in some columns, by these values.

        Groups are in order of first appearance, and their rows in the order of the table.

        Raises
        ------
        InputError
            If a column does not exist.
        """
        grouped: dict[tuple[Cell, ...], list[Mapping[str, Cell]]] = {}
        for row, *key in zip(self.rows, *map(self.cells, columns), strict=True):
            grouped.setdefault(tuple(key), []).append(row)
        return {key: Table(tuple(rows)) for key, rows in grouped.items()}

    @classmethod
    def from_csv(cls, text: str) -> Table:
        """Read what `to_csv` returned: cells that look like numbers are numbers, empty ones None.

        Raises
        ------
        InputError
            If there is no row, a row has not as many cells as the header, or the text is not CSV.
        """
        try:
            header, *lines = csv.reader(io.StringIO(text, newline=""), strict=True)
        except (csv.Error, ValueError) as error:
            raise InputError(f"not a table with a header, as in rows.csv of a study: {error}") from error
        for number, line in enumerate(lines, 1):
            if len(line) != len(header):
                raise InputError(f"row {number} has {len(line)} cells, but the header {len(header)}")
        return cls.of(dict(zip(header, map(_cell, line), strict=True)) for line in lines)

    def to_csv(self) -> str:
        """Return the table as CSV text with a header; floats are written with all their digits."""
        buffer = io.StringIO()
        writer = csv.writer(buffer, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows(row.values() for row in self.rows)
        return buffer.getvalue()


def _cell(text: str) -> Cell:
    if text in {"", "True", "False"}:
        return text == "True" if text else None
    for number in (int, float):
        with suppress(ValueError):
            return number(text)
    return text
