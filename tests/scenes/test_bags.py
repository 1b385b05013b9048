from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import sparse

from relforest.scenes import as_bags
from relforest.support.errors import InputError
from strategies import BagSet, bag_sets

TWO_BAGS = [np.array([[0.0, 1.0], [2.0, 3.0]]), np.array([[4.0, 5.0]])]


def test_a_list_of_arrays_keeps_its_order() -> None:
    for given_as in (TWO_BAGS, tuple(map(tuple, TWO_BAGS)), [bag.tolist() for bag in TWO_BAGS]):
        bags = as_bags(given_as)

        assert len(bags) == 2
        assert bags.dim == 2
        assert bags.points.tolist() == [[0, 1], [2, 3], [4, 5]]
        assert bags.starts.tolist() == [0, 2, 3]
        assert bags.counts.tolist() == [2, 1]
        assert bags.bag_ids.tolist() == [0, 1]


@pytest.mark.parametrize("ids", [["v", "u", "v", "w"], [5, -3, 5, 4]])
@pytest.mark.parametrize("container", [list, np.array, pd.Series])
def test_scattered_rows_are_grouped_in_order_of_first_appearance(ids: list[Any], container: Any) -> None:
    bags = as_bags((np.array([[0.0], [1.0], [2.0], [3.0]]), container(ids)))

    assert bags.bag_ids.tolist() == [ids[0], ids[1], ids[3]]
    assert bags.points[:, 0].tolist() == [0, 2, 1, 3]
    assert bags.starts.tolist() == [0, 2, 3, 4]


def test_a_3d_array_is_bags_of_equal_size() -> None:
    bags = as_bags(np.arange(12).reshape(2, 3, 2))

    assert bags.points.tolist() == np.arange(12).reshape(6, 2).tolist()
    assert bags.starts.tolist() == [0, 3, 6]


@pytest.mark.parametrize("convert", [np.array, list, pd.DataFrame, lambda rows: np.array(rows, dtype=object)])
def test_a_2d_array_is_one_point_per_bag(convert: Any) -> None:
    bags = as_bags(convert([[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]]))

    assert bags.points.tolist() == [[0, 1], [2, 3], [4, 5]]
    assert bags.starts.tolist() == [0, 1, 2, 3]


def test_the_input_is_never_changed_or_shared() -> None:
    array = np.zeros((2, 1))
    bags = as_bags(array)
    bags.points[0] = 9

    assert array.tolist() == [[0], [0]]


@given(bag_set=bag_sets(), data=st.data())
def test_all_forms_agree_wherever_the_rows_of_a_bag_are(bag_set: BagSet, data: st.DataObject) -> None:
    points, starts, _ = bag_set
    listed = as_bags([points[low:high] for low, high in pairwise(starts)])
    owners = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    shuffle = np.array(data.draw(st.permutations(range(len(points)))))
    scattered = as_bags((points[shuffle], owners[shuffle]))

    np.testing.assert_array_equal(listed.points, points)
    np.testing.assert_array_equal(listed.starts, starts)
    for number, owner in enumerate(scattered.bag_ids):
        members = shuffle[owners[shuffle] == owner]
        found = slice(scattered.starts[number], scattered.starts[number + 1])
        np.testing.assert_array_equal(scattered.points[found], points[members])


POINTS = np.zeros((3, 2))


@pytest.mark.parametrize(
    ("bags", "message"),
    [
        ([], "there are no bags"),
        (np.empty((0, 3)), r"there are no bags: Found array with 0 sample\(s\)"),
        (np.empty((0, 2, 3)), "there are no bags"),
        (np.empty((12, 0)), r"0 feature\(s\) \(shape=\(12, 0\)\) while a minimum of 1 is required"),
        ([POINTS, np.empty((0, 2))], "bag 1 is empty"),
        ([POINTS, []], "bag 1 is empty"),
        ([[], POINTS], "bag 0 is empty"),
        (np.empty((4, 0, 2)), "every bag is empty"),
        ([POINTS, np.zeros((1, 3))], "bag 1 has points of 3 components, but bag 0 of 2"),
        ([POINTS, np.zeros(2)], r"bag 1 must be a 2-D array, one row per point, got the shape \(2,\)"),
        ([POINTS, np.zeros((1, 1, 2))], "bag 1 must be a 2-D array"),
        (np.zeros(3), "got 1D array instead.* Reshape your data"),
        ([1.0, 2.0], "got 1D array instead"),
        (3.0, "got 0D array instead"),
        (np.zeros((1, 1, 1, 1)), "2-D or 3-D array, got the shape"),
        (np.array([[0.0], [np.nan]]), "Input X contains NaN or infinity: bag 1, row 0, component 0"),
        ([POINTS, np.array([[0.0, 0.0], [0.0, -np.inf]])], "NaN or infinity: bag 1, row 1, component 1"),
        ((np.array([[0.0], [np.nan]]), ["u", "u"]), "bag 'u', row 1, component 0"),
        ([POINTS, [[0.0, -1.1e30]]], r"values beyond 1e\+30: use other units \(bag 1, row 0, component 1"),
        ([[1.0, 2.0], [3.0]], "rows of equal length"),
        ([POINTS, np.array([["a", "b"]])], "bag 1 holds strings: convert them to numbers"),
        ([POINTS, np.array([["a", 1]], dtype=object)], "bag 1 must be an array of numbers"),
        (np.zeros((2, 1)) + 1j, "Complex data not supported"),
        (sparse.csr_array(POINTS), "sparse input is not supported: pass a dense array"),
        ([sparse.csr_array(POINTS)], "bag 0 is sparse"),
        ((POINTS, [1, 2]), "bag_ids must have one entry for each of the 3 points, got 2"),
        ((POINTS, [1, 2, 2.5]), "bag_ids must be integers or strings, got 2.5"),
        ((POINTS, np.zeros(3)), "bag_ids must be integers or strings, got float64"),
        ((np.zeros(3), [1, 2, 3]), "Reshape your data"),
    ],
)
def test_things_that_are_no_bags_are_refused(bags: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        as_bags(bags)


def test_objects_that_are_no_numbers_are_type_errors_as_scikit_learn_expects() -> None:
    array = np.zeros((2, 1), dtype=object)
    array[0, 0] = {"foo": "bar"}

    with pytest.raises(TypeError, match=r"argument must be .* string.* number") as caught:
        as_bags(array)
    assert isinstance(caught.value, InputError)
