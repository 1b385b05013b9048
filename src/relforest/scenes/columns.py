"""Single columns of a data frame: numbers, and identifiers with their codes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from decimal import Decimal
from numbers import Real
from typing import Any, cast, final

import narwhals as nw
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from relforest.scenes.arrays import FloatArray, IntArray
from relforest.scenes.arrow import ArrowArray, is_numeric, is_text, one_array, to_codes
from relforest.scenes.ids import IdArray
from relforest.support.errors import InputError

__all__ = ["Codes", "Frame", "Locate", "arrow_column", "encode", "id_column", "number_column", "open_frame"]

Frame = nw.DataFrame[Any]
Locate = Callable[[int], str]


@final
@dataclass(frozen=True, slots=True, eq=False)
class Codes:
    """A column of identifiers as numbers in order of first appearance."""

    codes: IntArray  # (n,), -1 = null
    ids: IdArray  # (k,), by code

    def __len__(self) -> int:
        """Return the number of distinct identifiers."""
        return len(self.ids)


def open_frame(frame: object, columns: Sequence[str]) -> Frame:
    """Wrap a pandas, polars or pyarrow table and check that it has rows and the named columns.

    Raises
    ------
    InputError
        If the object is no such table, is lazy or empty, or lacks a column; the message lists what there is.
    """
    try:
        table = cast("Frame", nw.from_native(cast("Any", frame), eager_only=True))
        available = [str(name) for name in table.columns]
    except (TypeError, nw.exceptions.NarwhalsError) as error:
        raise InputError(
            "expected a pandas, polars or pyarrow table in memory with unique column names, got "
            f"{type(frame).__module__}.{type(frame).__name__}: {error}"
        ) from error
    for name in columns:
        if not isinstance(name, str):
            raise InputError(f"columns are named by strings, got {name!r}")
        if name not in available:
            raise InputError(
                f"no column {name!r} in the table: it has {', '.join(map(repr, available)) or 'no columns'}"
            )
    if len(table) == 0:
        raise InputError("the table has no rows: there must be at least one scene")
    return table


def number_column(table: Frame, name: str, locate: Locate) -> FloatArray:
    """Return a column as float64 with NaN for nulls, shape (n,).

    Parameters
    ----------
    table : narwhals data frame
    name : str
        The column.
    locate : callable
        Row number -> words that tell the reader where a bad value is.

    Raises
    ------
    InputError
        If a value is not a number, or is infinite.
    """
    column = arrow_column(table, name)
    if column is not None and is_numeric(column.type):
        values = pc.cast(column, pa.float64(), safe=False).to_numpy(zero_copy_only=False)
    else:
        entries = table.get_column(name).to_list() if column is None else column.to_pylist()
        values = np.array([_number(value, name, locate, row) for row, value in enumerate(entries)])
    infinite = np.flatnonzero(np.isinf(values))
    if infinite.size:
        raise InputError(
            f"column {name!r} is infinite in {locate(int(infinite[0]))}: use null or NaN where a value is "
            "undefined"
        )
    return cast("FloatArray", values)


def id_column(table: Frame, name: str) -> ArrowArray:
    """Return a column of identifiers as an arrow array of int64 or large_string.

    Whole numbers that a null turned into floats (as pandas does) become integers again.

    Raises
    ------
    InputError
        If the values are neither integers nor strings.
    """
    column = arrow_column(table, name)
    if column is None:
        raise InputError(
            f"column {name!r} mixes types, but ids are all integers or all strings: convert them to strings"
        )
    kind = column.type
    if is_text(kind):
        return pc.cast(column, pa.large_string())
    if not (pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_null(kind)):
        raise InputError(
            f"column {name!r} holds {kind}, but ids are integers or strings: convert them to strings"
        )
    try:
        return pc.cast(column, pa.int64())
    except pa.ArrowInvalid as error:
        raise InputError(
            f"column {name!r} holds numbers that are no 64-bit integers ({error}): ids are integers or "
            "strings, convert them to strings"
        ) from error


def encode(column: ArrowArray) -> Codes:
    """Return the identifiers of a column from `id_column` as codes."""
    codes, ids = to_codes(column)
    return Codes(codes, ids.to_numpy(zero_copy_only=False))


def arrow_column(table: Frame, name: str) -> ArrowArray | None:
    """Return a column as one arrow array, NaN as null; None if its values have no common type."""
    try:
        return one_array(table.get_column(name).to_arrow())
    except (pa.ArrowException, TypeError, OverflowError):
        return None


def _number(value: object, name: str, locate: Locate, row: int) -> float:
    if value is None:
        return float("nan")
    if isinstance(value, (Real, Decimal, np.bool_)):
        return float(value)
    raise InputError(
        f"column {name!r} holds {value!r} in {locate(row)}, which is not a number: convert the column to "
        "numbers, with null or NaN where a value is undefined"
    )
