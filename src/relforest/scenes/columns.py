"""Columns of data frames as arrow arrays, and codes of identifiers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, cast, final

import narwhals as nw
import pyarrow as pa

from relforest.scenes.arrays import IntArray
from relforest.scenes.arrow import ArrowArray, one_array, to_codes
from relforest.scenes.ids import IdArray
from relforest.scenes.sources import encoding_hint
from relforest.support.errors import InputError

Frame = nw.DataFrame[Any]
Locate = Callable[[int], str]

_SHOWN = 20


@final
@dataclass(frozen=True, slots=True, eq=False)
class Codes:
    """A column of identifiers as numbers in order of first appearance."""

    codes: IntArray  # (n,), -1 = null
    ids: IdArray  # (k,), by code

    def __len__(self) -> int:
        """Return the number of distinct identifiers."""
        return len(self.ids)


def listed(values: Sequence[object], shown: int = 8) -> str:
    """Return the first few values, for messages."""
    first = ", ".join(repr(value) for value in values[:shown])
    return f"{first} and {len(values) - shown} more" if len(values) > shown else first


def check_named(columns: Sequence[str], available: Sequence[str], origin: str) -> None:
    """Check that each column occurs exactly once; other columns are ignored.

    Raises
    ------
    InputError
        If a column is missing or ambiguous; the message lists the available ones.
    """
    for name in columns:
        if not isinstance(name, str):
            raise InputError(f"column names must be strings, got {name!r}")
        found = available.count(name)
        if not found:
            known = listed(available, _SHOWN) or "no columns"
            hint = encoding_hint(map(str, available))
            raise InputError(f"column {name!r} is missing from {origin}, which has {known}{hint}")
        if found > 1:
            raise InputError(f"{found} columns of {origin} are named {name!r}: rename all but one")


def open_frame(frame: object, columns: Sequence[str]) -> Frame:
    """Wrap the named columns of a pandas, polars or pyarrow table and check that it has rows.

    Raises
    ------
    InputError
        If the object is not such a table, is lazy or empty, or lacks a column; the message lists the
        available ones.
    """
    try:
        table = cast("Frame", nw.from_native(cast("Any", _only_named(frame, columns)), eager_only=True))
    except (TypeError, nw.exceptions.NarwhalsError) as error:
        raise InputError(
            "expected a pandas, polars or pyarrow table in memory, got "
            f"{type(frame).__module__}.{type(frame).__name__}"
        ) from error
    check_named(columns, table.columns, "the table")
    if len(table) == 0:
        raise InputError("the table has no rows: at least one scene is needed")
    return table


def encode(column: ArrowArray) -> Codes:
    """Return the identifiers of a column from `id_column` as codes."""
    codes, ids = to_codes(column)
    return Codes(codes, ids.to_numpy(zero_copy_only=False))


def arrow_column(table: Frame, name: str) -> ArrowArray | None:
    """Return a column as one arrow array, NaN as null; None if its values have no common type."""
    try:
        return one_array(table.get_column(name).to_arrow())
    except (pa.ArrowException, TypeError, ValueError, OverflowError):
        return None


def _only_named(frame: object, columns: Sequence[str]) -> object:
    """Return a table without unused columns, which may share a name; narwhals refuses those."""
    if isinstance(frame, pa.Table):
        available: list[Any] = frame.column_names
    elif nw.dependencies.is_pandas_dataframe(frame):
        available = list(frame.columns)
    else:
        return frame
    check_named(columns, available, "the table")
    positions = [available.index(name) for name in dict.fromkeys(columns)]
    return frame.select(positions) if isinstance(frame, pa.Table) else frame.iloc[:, positions]
