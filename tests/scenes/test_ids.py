from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from relforest.scenes.ids import as_ids, codes_by_appearance, plain
from relforest.support.errors import InputError


@pytest.mark.parametrize("values", [[3, 1], np.array([3, 1], dtype=np.uint8), (np.int64(3), 1)])
def test_integers_become_int64(values: Any) -> None:
    ids = as_ids("ids", values)

    assert ids.dtype == np.int64
    assert ids.tolist() == [3, 1]
    assert not ids.flags.writeable


@pytest.mark.parametrize("values", [["b", "a"], np.array(["b", "a"]), np.array(["b", "a"], dtype=object)])
def test_strings_become_objects(values: Any) -> None:
    ids = as_ids("ids", values)

    assert ids.dtype == object
    assert [type(each) for each in ids] == [str, str]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([1, "a"], r"scene ids mix integers and strings \(such as 'a'\)"),
        ([1, 2.5], "scene ids must be integers or strings, got 2.5"),
        ([True], "got True"),
        ([2**70], "exceed 64-bit integers"),
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
