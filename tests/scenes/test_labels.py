from __future__ import annotations

from typing import Any

import pytest

from relforest.scenes.labels import binary_labels
from relforest.support.errors import InputError


@pytest.mark.parametrize("classes", [[0, 1], [-1, 1], [False, True], ["far", "near"]])
def test_the_second_class_in_sorted_order_is_positive(classes: list[Any]) -> None:
    no, yes = classes
    labels = binary_labels([yes, no, no], 3, what="scenes")

    assert labels.classes.tolist() == classes
    assert labels.positive.tolist() == [True, False, False]


@pytest.mark.parametrize(
    ("y", "message"),
    [
        ([1, 0], "got 2 labels for 3 bags: give one label for each"),
        ([1, 1, 1], "labels of 2 classes are needed, but 3 bags have only 1 class: 1"),
        ([1.0, 0.0, float("nan")], "labels hold NaN or infinite values: give each of the bags one of two"),
        ([1.0, 0.0, float("inf")], "labels hold NaN or infinite values"),
        ([1, 2, 3], r"Only binary classification is supported.* 3 classes \(1, 2, 3"),
    ],
)
def test_labels_that_are_not_one_of_two_classes_per_bag_are_refused(y: list[float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        binary_labels(y, 3, what="bags")
