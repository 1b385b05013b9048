"""The few operations on Arrow, the common form of data frames and Parquet, that the library needs."""

from __future__ import annotations

from typing import Any, TypeAlias, cast

import pyarrow as pa
import pyarrow.compute as pc

from relforest.scenes.arrays import IntArray

# pyarrow has no type annotations; these names at least show what is meant.
ArrowArray: TypeAlias = Any
ArrowTable: TypeAlias = Any
ArrowType: TypeAlias = Any


def one_array(column: ArrowArray) -> ArrowArray:
    """Return a column as a single array: chunks joined, categories replaced by their values, NaN by null."""
    array = column.combine_chunks() if isinstance(column, pa.ChunkedArray) else column
    if pa.types.is_dictionary(array.type):
        array = pc.cast(array, array.type.value_type)
    if pa.types.is_string_view(array.type):
        array = pc.cast(array, pa.large_string())
    if pa.types.is_floating(array.type):
        array = pc.if_else(pc.is_nan(array), pa.scalar(None, array.type), array)
    return array


def to_codes(column: ArrowArray) -> tuple[IntArray, ArrowArray]:
    """Return each entry's number (-1 for null), and the distinct values in order of first appearance."""
    encoded = column.dictionary_encode()
    codes = pc.fill_null(pc.cast(encoded.indices, pa.int64()), -1).to_numpy(zero_copy_only=False)
    return cast("IntArray", codes), encoded.dictionary


def iso_text(column: ArrowArray) -> ArrowArray:
    """Return dates, times or timestamps as large_string in ISO 8601, such as ``2020-01-31T09:30:00``."""
    if pa.types.is_date64(column.type):
        column = pc.cast(column, pa.date32())
    text = pc.cast(pc.cast(column, pa.string()), pa.large_string())
    # Arrow writes "2020-01-31 09:30:00.000000+0100".
    for pattern, replacement in (
        (r"^(\S+) ", r"\1T"),
        (r"(:\d\d\.\d*?)0+([+Z-].*)?$", r"\1\2"),
        (r"\.([+Z-].*)?$", r"\1"),
        (r"(T.*[+-]\d\d)(\d\d)$", r"\1:\2"),
    ):
        text = pc.replace_substring_regex(text, pattern, replacement)
    return text


def is_numeric(datatype: ArrowType) -> bool:
    """Return whether values of a type are numbers (including booleans, as 0 and 1, and columns of nulls)."""
    types = pa.types
    tests = (types.is_integer, types.is_floating, types.is_decimal, types.is_boolean, types.is_null)
    return any(test(datatype) for test in tests)


def is_temporal(datatype: ArrowType) -> bool:
    """Return whether values of a type are dates, times or timestamps."""
    return any(test(datatype) for test in (pa.types.is_date, pa.types.is_time, pa.types.is_timestamp))


def is_text(datatype: ArrowType) -> bool:
    """Return whether values of a type are strings."""
    types = pa.types
    return any(test(datatype) for test in (types.is_string, types.is_large_string, types.is_string_view))
