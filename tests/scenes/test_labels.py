from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest
from sklearn.exceptions import DataConversionWarning

from relforest.scenes.labels import class_labels
from relforest.support.errors import InputError


@pytest.mark.parametrize("classes", [[0, 1], [-1, 1], [False, True], ["far", "near"]])
def test_classes_come_in_sorted_order(classes: list[Any]) -> None:
    no, yes = classes
    found, codes = class_labels([yes, no, no], 3, what="scenes")

    assert found.tolist() == classes
    assert codes.tolist() == [1, 0, 0]


@pytest.mark.parametrize(
    ("y", "message"),
    [
        ([1, 0], "got 2 labels for 3 bags: give one label for each"),
        ([1, 1, 1], "labels of 2 classes are needed, but 3 bags have only 1 class: 1"),
        (
            [1.0, 0.0, float("nan")],
            "values: give each of the bags one of the classes",
        ),
        ([1.0, 0.0, float("inf")], "labels contain NaN or infinite values"),
        ([1, 2, 3], "3 bags have 3 classes: give at least two bags a class on average"),
    ],
)
def test_labels_that_do_not_name_a_class_of_each_bag_are_refused(y: list[float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        class_labels(y, 3, what="bags")


@pytest.mark.parametrize(
    ("y", "message"),
    [
        (np.ma.masked_array([0, 1, 0], [False, False, True]), "y has masked values"),
        ([0.5, 1.0, 0.0], "Unknown label type: continuous"),
        (["a", 1, "a"], "Unknown label type: the labels contain 'a'"),
        ([None, 1, 0], "Unknown label type: the labels contain None"),
        (np.array(["a", np.nan, "b"], dtype=object), "Unknown label type: the labels contain 'a'"),
        (np.array(["2020", "2021", "2020"], dtype="M8[Y]"), "Unknown label type: the labels contain"),
        (np.array([1j, 0, 0]), "Unknown label type"),
        (np.zeros((3, 2)), r"y should be a 1d array, got an array of shape \(3, 2\) instead"),
        ([[0], [1, 2], [0]], "y should be a 1d array"),
        (1.0, "y should be a 1d array"),
        ([], "got 0 labels for 3 bags"),
    ],
)
def test_things_that_are_not_labels_are_refused(y: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        class_labels(y, 3, what="bags")


@pytest.mark.parametrize(
    "y",
    [
        pd.Series([0, 1, 0]),
        pd.Series([0, 1, 0], dtype="Int64"),
        pd.Series([False, True, False], dtype="boolean"),
        pd.Series(["a", "b", "a"]),
        pd.Series(["a", "b", "a"], dtype="category"),
        pl.Series([0, 1, 0]),
        pa.chunked_array([["a", "b", "a"]]),
        np.array(["a", "b", "a"], dtype=object),
        np.array([0, np.int64(1), False], dtype=object),
        np.ma.masked_array([0, 1, 0]),
        (np.str_("a"), "b", "a"),
    ],
)
def test_columns_of_any_library_are_labels(y: Any) -> None:
    assert class_labels(y, 3, what="bags")[1].tolist() == [0, 1, 0]


def test_a_column_vector_is_flattened_with_scikit_learns_warning() -> None:
    with pytest.warns(
        DataConversionWarning, match="A column-vector y was passed when a 1d array was expected"
    ):
        _, codes = class_labels(np.array([[0], [1], [0]]), 3, what="bags")

    assert codes.tolist() == [0, 1, 0]
