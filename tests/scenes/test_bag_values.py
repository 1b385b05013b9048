"""Numbers out of arrays, nested lists and data frames, and what is refused in them."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime, timedelta
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest

from relforest.scenes.bag_values import BagTypeError, Values, as_values, dimensions, in_order_of
from relforest.support.errors import InputError

FRAMES: dict[str, Callable[[dict[str, Any]], Any]] = {
    "pandas": pd.DataFrame,
    "polars": pl.DataFrame,
    "pyarrow": pa.table,
}
each_library = pytest.mark.parametrize("library", FRAMES)
NOON = datetime(2020, 1, 1, 12)  # noqa: DTZ001  # as data often are


@pytest.mark.parametrize(
    "values",
    [
        [[1, 2], [3, 4.5]],
        [[True, 2], [3, 4.5]],
        np.array([[1, 2], [3, 4.5]], dtype=np.float16),
        np.array([[1, 2], [3, 4.5]], dtype=np.longdouble),
        [[Decimal(1), Fraction(2)], [np.int8(3), Decimal("4.5")]],
        np.array([[1, 2.0], [np.float32(3), Decimal("4.5")]], dtype=object),
        np.ma.masked_array([[1, 2], [3, 4.5]]),
        pd.DataFrame({"a": [True, 3], "b": [2, 4.5]}),
        pd.DataFrame({"a": pd.array([1, 3], dtype="Int64"), "b": [2, 4.5]}),
        pl.DataFrame({"a": [1, 3], "b": [Decimal(2), Decimal("4.5")]}),
    ],
)
def test_real_numbers_of_any_kind_are_floats(values: Any) -> None:
    array, _ = as_values(values, "bag 0")

    assert array.dtype == np.float64
    assert array[1].tolist() == [3, 4.5]
    assert array[0, 1] == 2


def test_the_result_shares_nothing_with_the_input() -> None:
    given = np.zeros((2, 1))
    as_values(given, "bag 0").array[0] = 9

    assert given.tolist() == [[0], [0]]


@each_library
def test_columns_are_labelled(library: str) -> None:
    values = as_values(FRAMES[library]({"width": [1, 2], "height": [3, 4]}), "bag 0")

    assert values.columns == ("width", "height")
    assert values.array.tolist() == [[1, 3], [2, 4]]
    assert in_order_of(["height", "width"], values).array.tolist() == [[3, 1], [4, 2]]
    assert as_values([[1.0]], "bag 0").columns is None
    assert in_order_of(["height", "width"], Values(values.array)).array is values.array


@pytest.mark.parametrize("missing", [None, np.nan])
@each_library
def test_missing_values_are_nan(library: str, missing: object) -> None:
    assert np.isnan(as_values(FRAMES[library]({"a": [1.0, missing]}), "bag 0").array[1, 0])


def test_pandas_missing_values_are_nan() -> None:
    frame = pd.DataFrame({"a": pd.array([1, None], dtype="Int64"), "b": [1.0, 2.0]})

    assert np.isnan(as_values(frame, "bag 0").array).tolist() == [[False, False], [True, False]]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([["a", "1"]], "bag 7 contains strings: convert them to numbers"),
        (np.array([["1", 2]], dtype=object), "bag 7 contains strings"),
        (np.array([[b"1"]]), "bag 7 contains strings"),
        (np.array([["2020-01-01"]], dtype="M8[s]"), "bag 7 contains dates or times: convert them to numbers"),
        (np.array([[5]], dtype="m8[s]"), "bag 7 contains dates or times"),
        ([[NOON]], "bag 7 contains dates or times"),
        ([[1.0, timedelta(1)]], "bag 7 contains dates or times"),
        (np.array([[np.timedelta64(1), 2]], dtype=object), "bag 7 contains dates or times"),
        ([[pd.Timestamp(NOON), 2]], "bag 7 contains dates or times"),
        ([[1j]], "Complex data not supported: bag 7 contains complex numbers"),
        (np.array([[1j, 2]], dtype=object), "Complex data not supported"),
        (np.ma.masked_equal([[1.0, 2.0]], 2.0), "bag 7 has masked values: leave them out or fill them in"),
        ([np.ma.masked_equal([1.0, 2.0], 2.0)], "bag 7 has masked values"),
        ([[1.0, np.ma.masked]], "bag 7 has masked values"),
        ([[1.0], [2.0, 3.0]], "bag 7 has rows of different lengths"),
        (np.zeros((2, 1), dtype=[("x", float)]), "bag 7 contains records: convert them to numbers"),
        (pl.LazyFrame({"a": [1.0]}), r"bag 7 is a lazy table: call its collect\(\) first"),
        (pd.DataFrame([[1, 2]], columns=["a", "a"]), "bag 7 has two columns of the same name"),
        (pd.DataFrame([[1, 2]], columns=["a", 1]), r"names, but your input has \['int', 'str'\]"),
    ],
)
def test_values_that_are_not_real_numbers_are_refused(values: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        as_values(values, "bag 7")


@pytest.mark.parametrize(
    ("column", "message"),
    [
        (["x", "y"], "column 'size' of bag 7 contains strings: convert them to numbers"),
        ([NOON, NOON], "column 'size' of bag 7 contains dates or times"),
        ([timedelta(1), timedelta(2)], "column 'size' of bag 7 contains dates or times"),
    ],
)
@each_library
def test_the_column_at_fault_is_named(library: str, column: list[object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        as_values(FRAMES[library]({"place": [1.0, 2.0], "size": column}), "bag 7")


def test_other_objects_are_type_errors() -> None:
    for values in ({"a": 1}, [[object()]], np.array([[{}]]), {1.0}):
        with pytest.raises(BagTypeError, match=r"bag 7 must contain numbers: float\(\) argument must be"):
            as_values(values, "bag 7")


def test_integers_too_large_for_floats_are_infinite() -> None:
    assert as_values([[10**400]], "bag 0").array.tolist() == [[np.inf]]


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (1.0, 0),
        ([], 1),
        ([[1.0]], 2),
        (np.zeros((1, 1, 1)), 3),
        (pl.DataFrame({"a": [1]}), 2),
        (pd.Series([1]), 1),
    ],
)
def test_dimensions(value: object, expected: int) -> None:
    assert dimensions(value) == expected
