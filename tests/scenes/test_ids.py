from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest

from relforest.scenes.ids import as_ids, codes_by_appearance, plain
from relforest.support.errors import InputError


@pytest.mark.parametrize(
    "values",
    [
        [3, 1],
        np.array([3, 1], dtype=np.uint8),
        (np.int64(3), 1),
        np.array([3, 1], dtype=object),
        pd.Series([3, 1], dtype="Int64"),
    ],
)
def test_integers_become_int64(values: Any) -> None:
    ids = as_ids("ids", values)

    assert ids.dtype == np.int64
    assert ids.tolist() == [3, 1]
    assert not ids.flags.writeable


@pytest.mark.parametrize(
    "values",
    [
        ["b", "a"],
        ("b", np.str_("a")),
        np.array(["b", "a"]),
        np.array(["b", "a"], dtype=object),
        np.array(["b", "a"], dtype=np.dtypes.StringDType()),
        pd.Series(["b", "a"]),
        pd.Series(["b", "a"], dtype="category"),
        pl.Series(["b", "a"]),
        pa.array(["b", "a"]),
    ],
)
def test_strings_become_objects(values: Any) -> None:
    ids = as_ids("ids", values)

    assert ids.dtype == object
    assert [type(each) for each in ids] == [str, str]
    assert ids.tolist() == ["b", "a"]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([1, "a"], r"scene ids mix integers and strings \(such as 'a'\)"),
        ([1, 2.5], "scene ids must be integers or strings, got 2.5"),
        ([True], "got True"),
        ([2**70], "exceed 64-bit integers"),
        ((1, "1"), "mix integers and strings"),
        (np.array([1, "1"], dtype=object), "mix integers and strings"),
        (np.array([2**63, 2**63 + 1], dtype=np.uint64), "exceed 64-bit integers"),
        ([np.uint64(2**63)], "exceed 64-bit integers"),
        (pd.Series([1, None], dtype="Int64"), "must be integers or strings, got float64"),
        (pd.Series([1, None]), "must be integers or strings, got float64"),
        (np.ma.masked_array([1, 2], mask=[False, True]), "must not be a masked array"),
        (np.array(["2020-01-01"], dtype="M8[D]"), "got datetime64"),
        (3, r"one-dimensional, got the shape \(\)"),
        ("abc", r"one-dimensional, got the shape \(\)"),
        ([("a",)], r"got \('a',\)"),
        (np.array([1.5]), "must be integers or strings, got float64"),
        (np.array([[1]]), r"one-dimensional, got the shape \(1, 1\)"),
    ],
)
def test_other_ids_are_refused(values: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        as_ids("scene ids", values)


@pytest.mark.parametrize(
    "ids", [np.array([7, 3, 7, 9, 3]), np.array(["z", "b", "z", "c", "b"], dtype=object)]
)
def test_codes_follow_first_appearance(ids: Any) -> None:
    codes, distinct = codes_by_appearance(ids)

    assert codes.tolist() == [0, 1, 0, 2, 1]
    assert distinct.tolist() == [ids[0], ids[1], ids[3]]


def test_plain_values_are_of_python() -> None:
    assert type(plain(np.int64(3))) is int
    assert plain("a") == "a"
