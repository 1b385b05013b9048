from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from sklearn.model_selection import cross_val_score

from relforest.datasets import BagSet, covariant1
from relforest.mil import CovAggClassifier
from relforest.support.errors import InputError
from strategies import BagSet as Drawn
from strategies import bag_sets

Floats = NDArray[np.float64]
BAGS = [np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([[5.0, 6.0]])]
LABELS = np.array([True, False])


def test_bags_are_counted() -> None:
    data = BagSet(BAGS, LABELS, np.array(["a", "b"]))
    assert (len(data), data.n_positive, data.n_instances, data.n_features) == (2, 1, 3, 2)
    assert data.bag_ids.tolist() == ["a", "b"]
    assert data.about is None


def test_bags_are_numbered_unless_they_have_names() -> None:
    assert BagSet(BAGS, LABELS).bag_ids.tolist() == [0, 1]


def test_nothing_is_shared_with_what_was_given_and_nothing_can_be_written() -> None:
    given_bag, labels, ids = np.zeros((2, 1)), np.array([True]), np.array(["a"], dtype=object)
    data = BagSet([given_bag], labels, ids)
    given_bag[0], labels[0], ids[0] = 9, False, "z"
    assert data.bags[0].tolist() == [[0], [0]]
    assert data.labels.tolist() == [True]
    assert data.bag_ids.tolist() == ["a"]
    for array in (*data.bags, data.labels, data.bag_ids):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = array[0]


def test_scikit_learn_takes_bags_and_labels_as_they_are() -> None:
    data = covariant1(np.random.default_rng(0), reading="printed", n_bags=40)
    model = CovAggClassifier(random_state=0)
    assert model.fit(data.bags, data.labels).predict(data.bags).shape == (40,)
    assert cross_val_score(model, data.bags, data.labels, cv=4).mean() > 0.7


@given(bag_sets(), st.randoms())
def test_scattered_rows_come_together_in_order_of_first_appearance(drawn: Drawn, random: Any) -> None:
    points, starts, labels = drawn
    bags: list[Floats] = np.split(points, starts[1:-1])
    # Draw the next row from any of the bags until all are used up.
    turns = [bag for bag, rows in enumerate(bags) for _ in rows]
    random.shuffle(turns)
    taken = [0] * len(bags)
    rows = []
    for bag in turns:
        rows.append(bags[bag][taken[bag]])
        taken[bag] += 1

    data = BagSet.from_instances(np.array(rows), [f"b{bag}" for bag in turns], labels[turns])

    order = list(dict.fromkeys(turns))
    assert data.bag_ids.tolist() == [f"b{bag}" for bag in order]
    assert data.labels.tolist() == labels[order].tolist()
    for found, bag in zip(data.bags, order, strict=True):
        np.testing.assert_array_equal(found, bags[bag])


def test_rows_of_a_bag_agree_about_its_label() -> None:
    points = np.zeros((3, 1))
    with pytest.raises(InputError, match="row 3 labels bag 'a' differently from an earlier row"):
        BagSet.from_instances(points, ["a", "b", "a"], np.array([True, True, False]))


@pytest.mark.parametrize(
    ("bags", "labels", "ids", "message"),
    [
        ([], [], None, "there are no bags"),
        ([np.zeros((0, 2)), np.zeros((1, 2))], [True, False], None, "bag 0 is empty"),
        ([np.zeros((1, 2)), np.zeros((1, 3))], [True, False], None, "all bags must have the same width"),
        ([np.array([[np.nan, 1.0]])], [True], None, "NaN or infinity: bag 0, row 0, component 0"),
        (BAGS, [1, 0], None, "labels must be booleans, got int64"),
        (BAGS, [True], None, r"labels must have the shape \(2,\), one entry per bag, got \(1,\)"),
        (BAGS, [True, False], ["a"], r"bag_ids must have the shape \(2,\)"),
        (BAGS, [True, False], ["a", "a"], "bag_ids contain 'a' twice"),
        (BAGS, [True, False], [0.5, 1.5], "bag_ids must be integers or strings"),
    ],
)
def test_what_is_no_set_of_bags_is_refused(bags: Any, labels: Any, ids: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        BagSet(bags, np.array(labels), np.array([] if ids is None else ids))
