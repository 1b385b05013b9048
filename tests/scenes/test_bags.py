from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import sparse

from relforest.scenes import as_bags
from relforest.scenes.bags import own_labels, rows_of
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


def test_some_bags_can_be_taken_in_any_order() -> None:
    rows, starts = rows_of(np.array([0, 2, 3, 6]), np.array([2, 0]))
    taken = as_bags((np.array([[0.0], [1.0], [2.0], [3.0]]), ["v", "u", "v", "w"])).taken(np.array([2, 0]))

    assert rows.tolist() == [3, 4, 5, 0, 1]
    assert starts.tolist() == [0, 3, 5]
    assert taken.points.tolist() == [[3], [0], [2]]
    assert taken.starts.tolist() == [0, 1, 3]
    assert taken.bag_ids.tolist() == ["w", "v"]


@pytest.mark.parametrize("ids", [["v", "u", "v", "w"], [5, -3, 5, 4]])
@pytest.mark.parametrize("container", [list, np.array, pd.Series, pl.Series, pa.array])
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
        ([[1.0, 2.0], [3.0]], "the array of bags has rows of different lengths"),
        ([POINTS, np.array([["a", "b"]])], "bag 1 contains strings: convert them to numbers"),
        ([POINTS, np.array([["1", 1]], dtype=object)], "bag 1 contains strings: convert them to numbers"),
        (np.zeros((2, 1)) + 1j, "Complex data not supported"),
        (sparse.csr_array(POINTS), "sparse input is not supported: pass a dense array"),
        ([sparse.csr_array(POINTS)], "bag 0 is sparse"),
        ((POINTS, [1, 2]), "bag_ids must have one entry for each of the 3 points, got 2"),
        ((POINTS, [1, 2, 2.5]), "bag_ids must be integers or strings, got 2.5"),
        ((POINTS, np.zeros(3)), "bag_ids must be integers or strings, got float64"),
        ((POINTS, np.array([1, "a", 2], dtype=object)), "bag_ids mix integers and strings"),
        ((POINTS, np.array([1, None, 2], dtype=object)), "bag_ids must be integers or strings, got None"),
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


def cells(bags: list[Any]) -> Any:
    column = np.empty(len(bags), dtype=object)
    column[:] = bags
    return column


@pytest.mark.parametrize("convert", [cells, lambda bags: cells(bags).reshape(-1, 1), pd.Series])
def test_an_object_array_may_hold_a_bag_in_each_cell(convert: Any) -> None:
    bags = as_bags(convert(TWO_BAGS))

    assert bags.points.tolist() == [[0, 1], [2, 3], [4, 5]]
    assert bags.starts.tolist() == [0, 2, 3]
    assert bags.form == "list"


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        ([POINTS, None], r"bag 1 must be a 2-D array, one row per point, got the shape \(\)"),
        ([POINTS, np.zeros((1, 3))], "bag 1 has points of 3 components, but bag 0 of 2"),
        ([np.zeros(2), np.zeros(3)], "the array of bags has rows of different lengths"),
    ],
)
def test_cells_that_are_not_bags_are_refused(contents: list[Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        as_bags(cells(contents))


def test_masked_cells_and_masked_ids_are_refused() -> None:
    with pytest.raises(InputError, match="the array of bags has masked values"):
        as_bags(np.ma.masked_array(cells(TWO_BAGS), [False, True]))
    with pytest.raises(InputError, match="bag_ids must not be a masked array"):
        as_bags((POINTS, np.ma.masked_equal([1, 1, 2], 2)))


def test_a_bag_set_is_its_bags() -> None:
    @dataclass(frozen=True)
    class Held:
        bags: list[Any]
        labels: list[bool]

    held = Held(TWO_BAGS, [True, False])

    assert as_bags(held).starts.tolist() == [0, 2, 3]
    assert own_labels(held) == [True, False]
    # A frame's columns are attributes too.
    assert own_labels(pd.DataFrame({"bags": [1.0], "labels": [0.0]})) is None


FRAMES: dict[str, Any] = {
    "pandas": lambda points, names: pd.DataFrame(points, columns=names),
    "polars": lambda points, names: pl.DataFrame(points, schema=names),
    "pyarrow": lambda points, names: pa.table(dict(zip(names, np.transpose(points), strict=True))),
}
each_library = pytest.mark.parametrize("library", FRAMES)


@each_library
def test_columns_of_bags_are_matched_by_name(library: str) -> None:
    frame = FRAMES[library]
    bags = as_bags([frame(TWO_BAGS[0], ["a", "b"]), frame(TWO_BAGS[1], ["b", "a"])])

    assert bags.points.tolist() == [[0, 1], [2, 3], [5, 4]]
    assert bags.columns == ("a", "b")
    assert bags.has_names


@each_library
def test_a_frame_may_have_bag_ids_or_a_bag_in_each_row(library: str) -> None:
    frame = FRAMES[library](POINTS, ["a", "b"])

    assert as_bags((frame, [1, 2, 1])).starts.tolist() == [0, 2, 3]
    assert as_bags(frame).starts.tolist() == [0, 1, 2, 3]
    assert as_bags(frame).columns == as_bags((frame, [1, 2, 1])).columns == ("a", "b")


@each_library
def test_bags_of_other_columns_are_refused(library: str) -> None:
    frame = FRAMES[library]
    first = frame(POINTS, ["a", "b"])
    with pytest.raises(InputError, match="bag 1: column 'b' is missing, column 'c' is not in bag 0"):
        as_bags([first, frame(POINTS, ["a", "c"])])
    with pytest.raises(InputError, match="bag 1: column 'b' is missing; all bags must have the same columns"):
        as_bags([first, frame(POINTS[:, :1], ["a"])])
    with pytest.raises(InputError, match="bag 0 has column names, but bag 1 does not"):
        as_bags([first, POINTS])
    with pytest.raises(InputError, match="bag 1 has column names, but bag 0 does not"):
        as_bags([POINTS, first])


def test_labels_that_are_not_names_match_only_if_they_are_the_same() -> None:
    first = pd.DataFrame([[1.0, 2.0]])
    swapped = as_bags([first, first[[1, 0]]])
    others = as_bags([first, pd.DataFrame([[3.0, 4.0]], columns=[7, 8])])

    assert swapped.points.tolist() == [[1, 2], [1, 2]]
    assert others.points.tolist() == [[1, 2], [3, 4]]
    assert not swapped.has_names


def test_the_place_of_a_bad_value_names_its_column() -> None:
    with pytest.raises(InputError, match="NaN or infinity: bag 1, row 0, column 'b'"):
        as_bags([pd.DataFrame({"a": [1.0], "b": [2.0]}), pd.DataFrame({"b": [None], "a": [2.0]})])


@pytest.mark.parametrize("types", [(np.int8, np.float16), (np.uint64, np.int64), (np.bool_, np.float32)])
def test_bags_of_different_types_are_all_exact(types: tuple[Any, Any]) -> None:
    bags = [np.array([[1]], dtype=types[0]), np.array([[0]], dtype=types[1])]

    assert as_bags(bags).points.tolist() == [[1], [0]]
    assert as_bags(bags).points.dtype == np.float64
