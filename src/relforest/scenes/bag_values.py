"""Converting arrays, nested lists and data frames of points to numbers."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import date, time, timedelta
from decimal import Decimal
from fractions import Fraction
from typing import Any, Final, NamedTuple, cast, final

import narwhals as nw
import numpy as np

from relforest.scenes.arrays import FloatArray
from relforest.support.errors import InputError
from relforest.support.masks import refuse_masked

_REFUSED: Final = (
    ((str, bytes), "{} contains strings: convert them to numbers"),
    (
        (date, time, timedelta, np.datetime64, np.timedelta64),
        "{} contains dates or times: convert them to numbers, in a unit of your choice",
    ),
    ((complex, np.complexfloating), "Complex data not supported: {} contains complex numbers"),
    (np.void, "{} contains records: convert them to numbers"),
)


@final
class BagTypeError(InputError, TypeError):
    """A value in a bag is not a number; scikit-learn expects a `TypeError` here."""


class Values(NamedTuple):
    """Numbers, and the labels of their columns."""

    array: FloatArray
    columns: tuple[Any, ...] | None = None  # None if unlabelled


def are_names(columns: tuple[Any, ...] | None) -> bool:
    """Whether columns have names; only strings count as names, as in scikit-learn."""
    return columns is not None and all(isinstance(label, str) for label in columns)


def as_values(values: object, what: str) -> Values:
    """Convert an array, nested sequence, or table to a new float64 array of any shape.

    Raises
    ------
    InputError
        If rows differ in length, a value is not a real number or is masked, or column names are repeated or
        of mixed types. Missing values become NaN.
    """
    if _is_frame(values):
        return _from_frame(values, what)
    if is_sparse(values):
        raise InputError(
            f"{what} is sparse, which is not supported: pass a dense array, for instance with .toarray()"
        )
    if hasattr(values, "collect"):
        raise InputError(f"{what} is a lazy table: call its collect() first")
    refuse_masked(values, what)
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise InputError(
            f"{what} has rows of different lengths: every point needs the same number of values, and every "
            "bag must be a 2-D array"
        ) from error
    return Values(_as_floats(array, what))


def in_order_of(reference: Sequence[Any], values: Values) -> Values:
    """Return values with labelled columns in the order of `reference`, which contains the same labels."""
    if values.columns is None or values.columns == tuple(reference):
        return values
    place = {label: number for number, label in enumerate(values.columns)}
    return Values(values.array[..., [place[label] for label in reference]], tuple(reference))


def dimensions(value: object) -> int:
    """Return the number of dimensions, without converting nested lists."""
    shape = getattr(value, "shape", None)
    if isinstance(shape, tuple):
        return len(shape)
    if isinstance(value, (list, tuple)):
        return 1 + (dimensions(value[0]) if value else 0)
    return 0


def is_sparse(value: object) -> bool:
    """Whether this is a sparse matrix or array."""
    return hasattr(value, "toarray") and hasattr(value, "nnz")


def _is_frame(value: object) -> bool:
    plain = isinstance(value, (np.ndarray, list, tuple))
    return not plain and bool(nw.dependencies.is_into_dataframe(value))


def _from_frame(frame: object, what: str) -> Values:
    try:
        table = cast("nw.DataFrame[Any]", nw.from_native(cast("Any", frame), eager_only=True))
        columns = tuple(table.columns)
    except nw.exceptions.NarwhalsError as error:
        raise InputError(f"{what} has two columns of the same name: give every column its own") from error
    named = [isinstance(label, str) for label in columns]
    if any(named) and not all(named):
        types = sorted({type(label).__qualname__ for label in columns})
        raise InputError(
            "Feature names are only supported if all input features have string names, but your input has "
            f"{types} as feature name / column name types ({what}): convert the names to strings"
        )
    # Polars would turn dates into numbers.
    if all(dtype.is_numeric() or dtype == nw.Boolean for dtype in table.schema.values()):
        array = np.asarray(frame)
        if array.dtype.kind in "fiub":
            return Values(array.astype(np.float64), columns)
    numbers = np.empty((len(table), len(columns)))
    for place, label in enumerate(columns):
        entries = np.empty(len(table), dtype=object)
        entries[:] = table.get_column(label).to_list()
        numbers[:, place] = _as_floats(entries, f"column {label!r} of {what}")
    return Values(numbers, columns)


def _as_floats(array: np.ndarray[Any, Any], what: str) -> FloatArray:
    if array.dtype.kind in "fiub":
        # A long double may be too large for a float; it becomes infinite and is refused later.
        with np.errstate(over="ignore"):
            return array.astype(np.float64)
    numbers = [_as_float(value, what) for value in array.flat]
    return np.array(numbers, dtype=np.float64).reshape(array.shape)


def _as_float(value: object, what: str) -> float:
    # The second test is for pandas' missing value.
    if value is None or type(value).__name__ == "NAType":
        return float("nan")
    for types, complaint in _REFUSED:
        if isinstance(value, types):
            raise InputError(complaint.format(what))
    try:
        return float(cast("float | Decimal | Fraction", value))
    except OverflowError:
        return float("inf")
    except (TypeError, ValueError) as error:
        raise BagTypeError(f"{what} must contain numbers: {error}") from error
