"""How a text file writes tables: field separator, decimal mark and encoding."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, final

from relforest.support.errors import InputError
from relforest.support.options import one_of

_SEPARATORS: Final = (",", ";", "\t", "|")
_SAMPLE_ROWS: Final = 20
_SAMPLE_LENGTH: Final = 2**16


@final
@dataclass(frozen=True, slots=True)
class Dialect:
    r"""How a CSV file is written; options that are None are detected.

    Raises
    ------
    InputError
        If an option is invalid.
    """

    separator: str | None = None
    """One character, or ``\\t`` or ``tab``. Default: comma, semicolon, tab or bar, from the first line."""
    decimal: str | None = None
    """{".", ","}: Decimal mark. Default: a point, or a comma where values allow no other reading."""
    encoding: str | None = None
    """Name of the encoding. Default: UTF-8, or UTF-16 if the first bytes show it."""

    def __post_init__(self) -> None:
        """Check the options."""
        if self.separator in {"\\t", "tab"}:
            object.__setattr__(self, "separator", "\t")
        mark = self.separator
        if mark is not None and (
            not isinstance(mark, str) or len(mark) != 1 or not mark.isascii() or mark in '"\0\r\n'
        ):
            raise InputError(f"separator must be one character, such as ',' or ';' or 'tab', got {mark!r}")
        if self.decimal is not None:
            one_of("decimal", self.decimal, (".", ","))
            if self.decimal == mark:
                raise InputError(f"separator and decimal are both {mark!r}: name two different characters")
        if self.encoding is not None and not isinstance(self.encoding, str):
            raise InputError(f"encoding must be the name of an encoding, got {self.encoding!r}")


ANY_DIALECT: Final = Dialect()
"""Everything is detected."""


def detected_separator(text: str) -> str:
    """Return the character that separates the fields of a CSV file, given its first lines.

    It must split the first row that is not blank. If several characters do, those that split the next rows
    into as many fields are preferred, the comma first.
    """
    sample = text[:_SAMPLE_LENGTH]
    splitting = [mark for mark in _SEPARATORS if len(next(_rows(sample, mark), [])) > 1]
    if len(splitting) > 1:
        steady = [mark for mark in splitting if _is_steady(sample, mark)]
        splitting = steady or splitting
    return splitting[0] if splitting else ","


def _is_steady(sample: str, mark: str) -> bool:
    rows = [fields for fields, _ in zip(_rows(sample, mark), range(_SAMPLE_ROWS), strict=False)]
    # The sample may end within its last row.
    complete = rows if len(sample) < _SAMPLE_LENGTH else rows[:-1]
    return len({len(fields) for fields in complete}) == 1


def _rows(sample: str, mark: str) -> Iterator[list[str]]:
    try:
        yield from filter(None, csv.reader(io.StringIO(sample, newline=""), delimiter=mark))
    except csv.Error:
        return
