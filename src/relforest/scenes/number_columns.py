"""Columns of numbers, which may be written as text: with a point or a comma as the decimal mark."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from numbers import Real
from typing import Final, cast

import narwhals as nw
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from relforest.scenes.arrays import FloatArray
from relforest.scenes.arrow import ArrowArray, ArrowTable, is_numeric, is_text
from relforest.scenes.columns import Frame, Locate, arrow_column
from relforest.support.errors import InputError

MISSING: Final = (
    *("", "NA", "N/A", "n/a", "#N/A", "#N/A N/A", "#NA", "NaN", "-NaN", "nan", "-nan", "NULL", "null"),
    *("None", "<NA>", "-1.#IND", "-1.#QNAN", "1.#IND", "1.#QNAN"),
)
"""Text that marks an undefined value in a column of numbers."""

_TRUE: Final = ("true", "True", "TRUE")
_FALSE: Final = ("false", "False", "FALSE")
_EXPONENT: Final = r"([eE][+-]?\d+)?"
_POINT: Final = rf"^[+-]?((\d+\.?\d*|\.\d+){_EXPONENT}|(?i:inf|infinity))$"
_COMMA: Final = rf"^[+-]?(\d+(,\d*)?|,\d+){_EXPONENT}$"
_GROUPED: Final = r"^[+-]?\d{1,3}(,\d{3})*$"
_DECIMAL_KEY: Final = b"relforest.decimal"


def with_decimal(table: ArrowTable, mark: str) -> ArrowTable:
    """Return an arrow table of text with the decimal mark of its numbers in the metadata."""
    return table.replace_schema_metadata({**(table.schema.metadata or {}), _DECIMAL_KEY: mark.encode()})


def number_columns(table: Frame, names: Sequence[str], locate: Locate) -> FloatArray:
    """Return columns as float64 with NaN for nulls, (n, number of names).

    In columns of text, the words of `MISSING` are nulls. The decimal mark is that of `with_decimal`; without
    one it is a point, or a comma if the values allow no other reading. `locate` describes the place of a row
    in messages.

    Raises
    ------
    InputError
        If a value is not a number, or is infinite.
    """
    columns = {name: arrow_column(table, name) for name in names}
    texts = {name: column for name, column in columns.items() if column is not None and is_text(column.type)}
    parsed = _parse(texts, _decimal_of(table), locate)
    for name, column in columns.items():
        if column is not None and is_numeric(column.type):
            parsed[name] = pc.cast(column, pa.float64(), safe=False).to_numpy(zero_copy_only=False)
        elif name not in parsed:
            entries = table.get_column(name).to_list() if column is None else column.to_pylist()
            parsed[name] = np.array([_number(value, name, locate, row) for row, value in enumerate(entries)])
        infinite = np.flatnonzero(np.isinf(parsed[name]))
        if infinite.size:
            raise InputError(
                f"column {name!r} is infinite in {locate(int(infinite[0]))}: use null or NaN where a value "
                "is undefined"
            )
    return np.column_stack([parsed[name] for name in names])


def _decimal_of(table: Frame) -> str | None:
    native = nw.to_native(table)
    metadata = native.schema.metadata if isinstance(native, pa.Table) else None
    mark = (metadata or {}).get(_DECIMAL_KEY)
    return None if mark is None else cast("str", mark.decode())


def _parse(texts: Mapping[str, ArrowArray], decimal: str | None, locate: Locate) -> dict[str, FloatArray]:
    """Return columns of text as numbers."""
    if decimal != ",":
        parsed = {}
        for name, column in texts.items():
            values = _cast(column)
            parsed[name] = _cast(_cleaned(column)) if values is None else values
        if all(values is not None for values in parsed.values()):
            return cast("dict[str, FloatArray]", parsed)
    cleaned = {name: _cleaned(column) for name, column in texts.items()}
    has_commas = decimal == "," or (decimal is None and allow_only_commas(cleaned.values()))
    for name, column in cleaned.items():
        matches = pc.match_substring_regex(column, _COMMA if has_commas else _POINT)
        wrong = np.flatnonzero(~pc.fill_null(matches, True).to_numpy(zero_copy_only=False))  # noqa: FBT003
        if wrong.size:
            row = int(wrong[0])
            raise InputError(_complaint(column[row].as_py(), name, locate(row), decimal))
    if has_commas:
        cleaned = {name: pc.replace_substring(column, ",", ".") for name, column in cleaned.items()}
    return {
        name: pc.cast(column, pa.float64()).to_numpy(zero_copy_only=False) for name, column in cleaned.items()
    }


def _cast(column: ArrowArray) -> FloatArray | None:
    """Return plainly written numbers, or None if a value is anything else."""
    try:
        return cast("FloatArray", pc.cast(column, pa.float64()).to_numpy(zero_copy_only=False))
    except pa.ArrowInvalid:
        return None


def _cleaned(column: ArrowArray) -> ArrowArray:
    """Return text stripped of blanks, with nulls for missing values and booleans as 0 and 1."""
    text = pc.utf8_trim_whitespace(column)
    for words, meaning in ((MISSING, None), (_TRUE, "1"), (_FALSE, "0")):
        found = pc.is_in(text, value_set=pa.array(words, text.type))
        text = pc.if_else(found, pa.scalar(meaning, text.type), text)
    return text


def allow_only_commas(columns: Iterable[ArrowArray]) -> bool:
    """Return whether all texts can be numbers with a decimal comma, and at least one can be nothing else.

    ``1,234`` may also be a thousand in groups of three digits.
    """
    certain = False
    for column in columns:
        if pc.any(pc.invert(pc.match_substring_regex(column, _COMMA))).as_py():
            return False
        certain |= pc.any(pc.invert(pc.match_substring_regex(column, _GROUPED))).as_py() is True
    return certain


def _complaint(value: str, name: str, where: str, decimal: str | None) -> str:
    complaint = f"column {name!r} contains {value!r} in {where}, which is not a number"
    if decimal == ",":
        return f"{complaint} with a decimal comma: correct it, or omit decimal="
    if decimal is None and "," in value:
        return f"{complaint}: if the comma is the decimal mark, pass decimal=',' (--decimal ,)"
    return f"{complaint}: correct it, or leave it empty if it is undefined"


def _number(value: object, name: str, locate: Locate, row: int) -> float:
    if value is None:
        return float("nan")
    if isinstance(value, (Real, Decimal, np.bool_)):
        return float(value)
    raise InputError(
        f"column {name!r} contains {value!r} in {locate(row)}, which is not a number: convert the column to "
        "numbers, with null or NaN where a value is undefined"
    )
