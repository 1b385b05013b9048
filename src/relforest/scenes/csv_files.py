"""CSV files as tables of text; fields are interpreted where they are used."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import pyarrow as pa
from pyarrow import csv

from relforest.scenes.arrow import ArrowTable
from relforest.scenes.csv_rows import csv_rows, start_of_line, wrong_length
from relforest.scenes.dialect import Dialect, detected_separator
from relforest.scenes.number_columns import with_decimal
from relforest.scenes.sources import decoded, is_broken, utf8
from relforest.scenes.table_file import TableFile
from relforest.support.errors import InputError

__all__ = ["open_csv"]

_BLOCK: Final = 2**20
_LARGEST_BLOCK: Final = 2**31 - 1


@final
@dataclass(frozen=True, slots=True, eq=False)
class _CsvText:
    """CSV text after its header was read."""

    data: bytes  # UTF-8
    origin: str
    names: tuple[str, ...]
    separator: str
    decimal: str | None
    first_line: int  # the line after the header

    def load(self, chosen: Sequence[str]) -> ArrowTable:
        """Return columns as strings, exactly as written, with nulls for empty fields."""
        if any(map(is_broken, chosen)):
            decoded(self.data, "utf-8", self.origin)
        start = start_of_line(self.data, self.first_line)
        try:
            table = self._parse(start, chosen, _BLOCK)
        except pa.ArrowException:
            table = self._parse_long_rows(start, chosen)
        self._check_quotes(start, len(table))
        return table if self.decimal is None else with_decimal(table, self.decimal)

    def _parse_long_rows(self, start: int, chosen: Sequence[str]) -> ArrowTable:
        try:
            return self._parse(start, chosen, _LARGEST_BLOCK)
        except pa.ArrowException as error:
            self._check_rows()
            raise InputError(f"{self.origin} cannot be read as CSV: write it with shorter rows") from error

    def _parse(self, start: int, chosen: Sequence[str], block_size: int) -> ArrowTable:
        # Names may repeat, positions do not.
        places = [str(place) for place in range(len(self.names))]
        wanted = [str(self.names.index(name)) for name in chosen]
        body = pa.py_buffer(self.data)[start:]
        if not body.size:
            return pa.table([pa.array([], pa.string())] * len(chosen), names=list(chosen))
        table = csv.read_csv(
            pa.BufferReader(body),
            read_options=csv.ReadOptions(column_names=places, block_size=block_size),
            parse_options=csv.ParseOptions(
                delimiter=self.separator, newlines_in_values=self.data.find(b'"', start) >= 0
            ),
            convert_options=csv.ConvertOptions(
                include_columns=wanted,
                column_types=dict.fromkeys(wanted, pa.string()),
                null_values=[""],
                strings_can_be_null=True,
            ),
        )
        return table.rename_columns(list(chosen))

    def _check_quotes(self, start: int, n_rows: int) -> None:
        """Check every row if quotes may have swallowed some."""
        n_lines = self.data.count(b"\n", start) + (not self.data.endswith(b"\n"))
        if n_rows != n_lines and self.data.find(b'"', start) >= 0:
            self._check_rows()

    def _check_rows(self) -> None:
        """Raise an error that names the first fault and its place, if there is one."""
        for row in csv_rows(self.data, self.separator, self.origin):
            complaint = wrong_length(row, len(self.names), self.separator)
            if complaint is not None:
                raise InputError(f"{self.origin}, line {row.line}: {complaint}")
        decoded(self.data, "utf-8", self.origin)


def open_csv(content: bytes, origin: str, dialect: Dialect) -> TableFile:
    """Return the table in a CSV file with a header.

    Raises
    ------
    InputError
        If the file cannot be decoded, or is empty.
    """
    data = utf8(content, dialect.encoding, origin)
    separator = dialect.separator
    if separator is None:
        separator = detected_separator(data[: 2**16].decode("utf-8", "surrogateescape"))
    head = next(csv_rows(data, separator, origin), None)
    if head is None:
        raise InputError(f"{origin} is empty: its first line must name the columns")
    text = _CsvText(data, origin, tuple(head.fields), separator, dialect.decimal, head.last_line + 1)
    return TableFile(origin, text.names, text.load)
