"""Rows of CSV text with their line numbers, for header lines and error messages."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from typing import NamedTuple

from relforest.support.errors import InputError


class CsvRow(NamedTuple):
    """A row that is not blank."""

    line: int  # where it begins, from 1
    last_line: int  # where it ends
    fields: list[str]  # without quotes


def csv_rows(data: bytes, separator: str, origin: str, *, skip_blanks: bool = False) -> Iterator[CsvRow]:
    """Yield the rows of CSV text in UTF-8, whose invalid bytes become lone surrogates.

    With `skip_blanks`, blanks after a separator are dropped.

    Raises
    ------
    InputError
        If quotes are not closed, or a field is longer than 131072 characters.
    """
    # Without strict, an unclosed quote silently swallows the rest of the file.
    lines = io.TextIOWrapper(io.BytesIO(data), encoding="utf-8", errors="surrogateescape", newline="")
    table = csv.reader(lines, delimiter=separator, skipinitialspace=skip_blanks, strict=True)
    line = 1
    try:
        for fields in table:
            if fields:
                yield CsvRow(line, table.line_num, fields)
            line = table.line_num + 1
    except csv.Error as error:
        is_long = "limit" in str(error)
        complaint = "a field is longer than 131072 characters" if is_long else "a quote is not closed"
        raise InputError(
            f"{origin}, line {line}: {complaint}: close each quote directly before a separator "
            f"({separator!r}) or the end of the line, and write one within a quoted field twice"
        ) from error


def wrong_length(row: CsvRow, n_columns: int, separator: str) -> str | None:
    """Return a complaint about a row with too few or too many fields, None for other rows."""
    if len(row.fields) == n_columns:
        return None
    return (
        f"the row has {len(row.fields)} of {n_columns} fields: complete the row, and quote fields "
        f"that contain the separator {separator!r}"
    )
