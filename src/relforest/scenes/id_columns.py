"""Columns of identifiers, read as written: different spellings stay different."""

from __future__ import annotations

from typing import Final

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from relforest.scenes.arrow import ArrowArray, is_temporal, is_text, iso_text
from relforest.scenes.columns import Frame, arrow_column
from relforest.support.errors import InputError

# From here on, neighbouring integers can be the same float.
_FIRST_INEXACT: Final = {pa.float16(): 2**11, pa.float32(): 2**24, pa.float64(): 2**53}
_REMEDY: Final = "convert the column to strings"


def id_column(table: Frame, name: str) -> ArrowArray:
    """Return a column of identifiers as an arrow array of int64 or large_string.

    Strings keep their text; dates and times become text in ISO 8601, and numbers beyond 64 bits their digits.
    Whole numbers that a null turned into floats (as pandas does) become integers again.

    Raises
    ------
    InputError
        If the values are of other types, or floats that are not whole or too large to be exact.
    """
    column = arrow_column(table, name)
    if column is None:
        raise InputError(
            f"column {name!r} mixes types or exceeds 64 bits, but ids are all integers or all strings: "
            f"{_REMEDY}"
        )
    datatype, types = column.type, pa.types
    try:
        if types.is_floating(datatype):
            return _whole(column, name)
        if is_temporal(datatype):
            return iso_text(column)
        if types.is_integer(datatype) or types.is_null(datatype) or types.is_decimal(datatype):
            return _integers(column)
        if is_text(datatype) or types.is_binary(datatype) or types.is_large_binary(datatype):
            return pc.cast(column, pa.large_string())
    except pa.ArrowException as error:
        raise InputError(
            f"column {name!r} contains {datatype} values that cannot be converted to text: {_REMEDY}"
        ) from error
    raise InputError(
        f"column {name!r} contains {datatype}, but ids are integers, strings, dates or times: {_REMEDY}"
    )


def _integers(column: ArrowArray) -> ArrowArray:
    try:
        return pc.cast(column, pa.int64())
    except pa.ArrowInvalid:
        return pc.cast(pc.cast(column, pa.string()), pa.large_string())


def _whole(column: ArrowArray, name: str) -> ArrowArray:
    """Return floats that are exact whole numbers as integers."""
    values = pc.cast(column, pa.float64()).to_numpy(zero_copy_only=False)
    first_inexact = _FIRST_INEXACT[column.type]
    inexact = np.flatnonzero(np.abs(values) >= first_inexact)
    if inexact.size:
        raise InputError(
            f"column {name!r} contains the float {values[inexact[0]]:.0f} in row {inexact[0]}, but floats "
            f"are exact only below {first_inexact}, so this id may have lost digits: read the column as "
            "integers (in pandas, dtype 'Int64') or strings"
        )
    broken = np.flatnonzero(values != np.floor(values))
    broken = broken[~np.isnan(values[broken])]
    if broken.size:
        raise InputError(
            f"column {name!r} contains {values[broken[0]]} in row {broken[0]}, but ids are whole numbers or "
            f"strings: {_REMEDY}"
        )
    return pc.cast(column, pa.int64())
