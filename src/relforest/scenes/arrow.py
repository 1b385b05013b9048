"""What the library needs to know of Arrow, the common ground of all data frames and of Parquet."""

from __future__ import annotations

from typing import Any, TypeAlias, cast

import pyarrow as pa
import pyarrow.compute as pc

from relforest.scenes.arrays import IntArray

__all__ = ["ArrowArray", "ArrowTable", "ArrowType", "is_numeric", "is_text", "one_array", "to_codes"]

# pyarrow ships no types; the names say at least what is meant.
ArrowArray: TypeAlias = Any
ArrowTable: TypeAlias = Any
ArrowType: TypeAlias = Any


def one_array(column: ArrowArray) -> ArrowArray:
    """Return a column as a single array: chunks joined, categories replaced by their values, NaN by null."""
    array = column.combine_chunks() if isinstance(column, pa.ChunkedArray) else column
    if pa.types.is_dictionary(array.type):
        array = pc.cast(array, array.type.value_type)
    if pa.types.is_floating(array.type):
        array = pc.cast(array, pa.float64())
        array = pc.if_else(pc.is_nan(array), pa.scalar(None, pa.float64()), array)
    return array


def to_codes(column: ArrowArray) -> tuple[IntArray, ArrowArray]:
    """Return each entry's number (-1 for null), and the distinct values in order of first appearance."""
    encoded = column.dictionary_encode()
    codes = pc.fill_null(pc.cast(encoded.indices, pa.int64()), -1).to_numpy(zero_copy_only=False)
    return cast("IntArray", codes), encoded.dictionary


def is_numeric(kind: ArrowType) -> bool:
    """Tell whether values of a type are numbers (booleans are 0 and 1, a column of nulls counts too)."""
    types = pa.types
    tests = (types.is_integer, types.is_floating, types.is_decimal, types.is_boolean, types.is_null)
    return any(test(kind) for test in tests)


def is_text(kind: ArrowType) -> bool:
    """Tell whether values of a type are strings."""
    types = pa.types
    return any(test(kind) for test in (types.is_string, types.is_large_string, types.is_string_view))
