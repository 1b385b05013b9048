from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.scenes.columns import open_frame
from relforest.scenes.number_columns import number_columns, with_decimal
from relforest.support.errors import InputError


def numbers(*columns: list[Any], decimal: str | None = None) -> list[list[float]]:
    """Return the columns a, b, ... as rows of numbers."""
    names = "abcdef"[: len(columns)]
    table = pa.table(dict(zip(names, columns, strict=True)))
    frame = open_frame(table if decimal is None else with_decimal(table, decimal), list(names))
    found: list[list[float]] = number_columns(frame, list(names), "row {}".format).tolist()
    return found


@given(st.lists(st.floats(allow_infinity=False), min_size=1))
def test_what_python_writes_is_read_exactly(values: list[float]) -> None:
    for texts in ([repr(value) for value in values], [f" {value!r}\t" for value in values]):
        np.testing.assert_array_equal(np.ravel(numbers(texts)), values)
        commas = [text.replace(".", ",") for text in texts]
        np.testing.assert_array_equal(np.ravel(numbers(commas, decimal=",")), values)


def test_missing_values_and_booleans_have_many_spellings() -> None:
    found = numbers(["1", "NA", " nan ", "null", "NULL", "n/a", "#N/A", "None", "", None, "true", "FALSE"])

    np.testing.assert_array_equal(np.ravel(found), [1, *[np.nan] * 9, 1, 0])


def test_columns_of_all_kinds_stand_side_by_side() -> None:
    assert numbers(["1.5", "+2"], [1, 2], [True, False], [0.5, 1e300]) == [[1.5, 1, 1, 0.5], [2, 2, 0, 1e300]]


def test_a_decimal_comma_is_seen_where_nothing_else_can_be_meant() -> None:
    assert numbers(["0,5", "12"], ["1,234", "-7,"]) == [[0.5, 1.234], [12, -7]]


@pytest.mark.parametrize(
    ("columns", "decimal", "message"),
    [
        # Perhaps a thousand, perhaps hardly more than one.
        (
            [["1,234", "5"]],
            None,
            "'a' contains '1,234' in row 0, .*: if the comma is the decimal mark, pass decimal=','",
        ),
        (
            [["1.5", "2"], ["1", "0,5"]],
            None,
            "column 'b' contains '0,5' in row 1, which is not a number: if the comma",
        ),
        ([["0,5", "1.234,5"]], None, "column 'a' contains '0,5' in row 0"),
        (
            [["0,5", "1.5"]],
            ",",
            "column 'a' contains '1.5' in row 1, which is not a number with a decimal comma",
        ),
        ([["0,5", "1.5"]], ".", "column 'a' contains '0,5' in row 0, which is not a number"),
        (
            [["1", "1_000"]],
            None,
            "'1_000' in row 1, .* correct it, or leave it empty if it",
        ),
        ([["1", "0x10"]], None, "'0x10' in row 1"),
        ([["1", "\u0661"]], None, "'\u0661' in row 1"),
        ([["1", "2020-01-01"]], None, "'2020-01-01' in row 1"),
        ([["1", "-inf"]], None, "column 'a' is infinite in row 1"),
        ([["1", "1e999"]], None, "column 'a' is infinite in row 1"),
    ],
)
def test_other_text_is_named(columns: list[list[str]], decimal: str | None, message: str) -> None:
    with pytest.raises(InputError, match=message):
        numbers(*columns, decimal=decimal)


def test_tables_of_other_libraries_may_hold_text_too() -> None:
    frame = open_frame(pd.DataFrame({"a": ["1", "NA"]}), ["a"])

    np.testing.assert_array_equal(number_columns(frame, ["a"], str), [[1], [np.nan]])
