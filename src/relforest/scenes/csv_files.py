"""CSV files as tables of text; fields are interpreted where they are used."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import pyarrow as pa
from pyarrow import csv

from relforest.scenes.arrow import ArrowTable
from relforest.scenes.csv_rows import csv_rows, wrong_length
from relforest.scenes.dialect import Dialect, detected_separator
from relforest.scenes.number_columns import with_decimal
from relforest.scenes.sources import decoded, is_broken, utf8
from relforest.scenes.table_file import TableFile
from relforest.support.errors import InputError

_LARGEST_BLOCK: Final = 2**31 - 1


@final
@dataclass(frozen=True, slots=True, eq=False)
class CsvFile(TableFile):
    """CSV text after its header was read."""

    data: bytes  # UTF-8
    separator: str
    decimal: str | None
    n_skipped: int  # lines of the header

    def load(self, chosen: Sequence[str]) -> ArrowTable:
        """Return columns as strings, exactly as written, with nulls for empty fields."""
        if any(map(is_broken, chosen)):
            decoded(self.data, "utf-8", self.origin)
        try:
            table = self._parse(chosen)
        except pa.ArrowException as error:
            self._check_rows()
            raise InputError(f"{self.origin} cannot be read as CSV: write it with shorter rows") from error
        n_lines = self.data.count(b"\n") + (not self.data.endswith(b"\n")) - self.n_skipped
        if len(table) != n_lines and b'"' in self.data:
            # Quotes may have swallowed rows.
            self._check_rows()
        return table if self.decimal is None else with_decimal(table, self.decimal)

    def _parse(self, chosen: Sequence[str]) -> ArrowTable:
        # Names may repeat, positions do not.
        places = [str(place) for place in range(len(self.names))]
        wanted = [str(self.names.index(name)) for name in chosen]
        table = csv.read_csv(
            # A header may be all that there is, and end with the file.
            pa.BufferReader(self.data if self.data.endswith(b"\n") else self.data + b"\n"),
            # One block, because a row may be of any length.
            read_options=csv.ReadOptions(
                column_names=places,
                skip_rows=self.n_skipped,
                block_size=min(len(self.data) + 2, _LARGEST_BLOCK),
            ),
            parse_options=csv.ParseOptions(delimiter=self.separator, newlines_in_values=b'"' in self.data),
            convert_options=csv.ConvertOptions(
                include_columns=wanted,
                column_types=dict.fromkeys(wanted, pa.string()),
                null_values=[""],
                strings_can_be_null=True,
            ),
        )
        return table.rename_columns(list(chosen))

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
    return CsvFile(origin, tuple(head.fields), {}, data, separator, dialect.decimal, head.last_line)
