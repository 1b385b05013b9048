from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from datasets.few_molecules import DATA, assert_few_molecules, assert_same_bags
from relforest.datasets import BagSet, read_c45
from relforest.support.errors import InputError
from strategies import BagSet as Drawn
from strategies import bag_sets

Write = Callable[[str], Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def file(content: str) -> Path:
        path = tmp_path / "clean.data"
        path.write_bytes(content.encode())
        return path

    return file


def test_the_layout_of_musk_is_read() -> None:
    assert_few_molecules(read_c45(DATA / "few_molecules.data"))


def test_instances_may_have_no_names_and_labels_no_dots(write: Write) -> None:
    data = read_c45(
        write("b , 1, 2, yes\r\n\r\n| a comment\nc,3,4,no. | another\nb,5,6,yes"),
        instance_ids=False,
        positive="yes",
    )
    assert [bag.tolist() for bag in data.bags] == [[[1, 2], [5, 6]], [[3, 4]]]
    assert data.bag_ids.tolist() == ["b", "c"]
    assert data.labels.tolist() == [True, False]


NUMBERS = "a,a1,10,20,1.\na,5,30,40,1.\n"


def test_a_number_may_name_an_instance_or_be_its_first_feature(write: Write) -> None:
    path = write(NUMBERS)
    message = "line 2: the second field, '5', may be .* give instance_ids=True or instance_ids=False"
    with pytest.raises(InputError, match=message):
        read_c45(path)
    assert read_c45(path, instance_ids=True).bags[0].tolist() == [[10, 20], [30, 40]]
    assert read_c45(write(NUMBERS.replace("a1", "1")), instance_ids=False).n_features == 3


def test_a_name_that_is_read_as_a_number_is_recognised(write: Write) -> None:
    with pytest.raises(InputError, match=r"line 1: 'a1' is not a finite number.* give instance_ids=True"):
        read_c45(write(NUMBERS), instance_ids=False)
    with pytest.raises(InputError, match=r"line 1: 'x' is not a finite number: correct it.* is missing$"):
        read_c45(write("a,1,x,1.\n"), instance_ids=False)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "does not contain any instances"),
        ("| nothing\n\n", "does not contain any instances"),
        ("a,a1,1,2,1.\na,a2,1,1.\n", "line 2: the line has 1 of 2 features"),
        ("a,a1,1.\n", "line 1: a line needs a bag, an instance, features and a label"),
        ("a,a1,1,2,1.\n\nb,b1,?,2,0.\n", r"line 3: '\?' is not a finite number"),
        ("a,a1,1,inf,1.\n", "line 1: 'inf' is not a finite number"),
        ("a,a1,1,2,1.\na,a2,1,2,0.\n", "line 2: bag 'a' is labelled '0' here and '1' above"),
        (",a1,1,2,1.\n", "line 1: the name of the bag is missing"),
        ("a,a1,1,2,musk.\n", "ambiguous which of the labels 'musk' is positive: give positive='musk'"),
    ],
)
def test_what_is_wrong_and_where_is_said(write: Write, text: str, message: str) -> None:
    path = write(text)
    with pytest.raises(InputError, match=message) as error:
        read_c45(path)
    assert str(path) in str(error.value)


def test_text_that_is_not_utf8_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "clean.data"
    path.write_bytes("a,a1,1,2,1.\nü,a1,1,2,1.\n".encode("latin-1"))
    with pytest.raises(InputError, match=r"is not UTF-8 text \(byte 0xfc in line 2\): pass its encoding"):
        read_c45(path)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(drawn=bag_sets())
def test_what_is_written_is_read(write: Write, drawn: Drawn) -> None:
    points, starts, labels = drawn
    expected = BagSet(np.split(points, starts[1:-1]), labels, np.array([f"b{i}" for i in range(len(labels))]))
    lines = [
        f"{name},{name}_{row},{','.join(map(repr, point))},{int(label)}.\n"
        for name, label, bag in zip(expected.bag_ids, expected.labels, expected.bags, strict=True)
        for row, point in enumerate(bag.tolist())
    ]
    assert_same_bags(read_c45(write("".join(lines))), expected)


VALID = (DATA / "few_molecules.data").read_text(encoding="utf-8")


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_hostile_files_are_read_or_refused(write: Write, data: st.DataObject) -> None:
    start = data.draw(st.integers(0, len(VALID)))
    end = data.draw(st.integers(start, min(start + 8, len(VALID))))
    patch = data.draw(
        st.one_of(st.text(st.characters(codec="utf-8"), max_size=6), st.sampled_from("?|.,\n\0"))
    )
    path = write(VALID[:start] + patch + VALID[end:])
    try:
        found = read_c45(path)
    except InputError as error:
        assert str(path) in str(error)  # noqa: PT017 - both outcomes are right
    else:
        assert all(np.isfinite(bag).all() for bag in found.bags)


def test_other_encodings_and_open_files_are_read(tmp_path: Path) -> None:
    path = tmp_path / "clean.data"
    path.write_bytes("ü,a1,1,2,1.\n".encode("latin-1"))
    assert read_c45(path, encoding="latin-1").bag_ids.tolist() == ["ü"]
    with path.open(encoding="latin-1") as file:
        assert read_c45(file).bag_ids.tolist() == ["ü"]
    with pytest.raises(InputError, match=r"the open StringIO, line 1: '\?' is not a finite number"):
        read_c45(io.StringIO("a,a1,?,1.\n"))


def test_names_of_bags_are_read_as_they_are_written(write: Write) -> None:
    assert read_c45(write("01,a,1,1.\n1,a,1,0.\n1e0,a,1,1.\n")).bag_ids.tolist() == ["01", "1", "1e0"]
