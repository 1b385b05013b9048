from __future__ import annotations

import gzip
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from datasets.few_molecules import DATA, assert_few_molecules, assert_same_bags
from relforest.datasets import BagSet, read_csv
from relforest.datasets.readers.csv_table import Columns, parse_csv
from relforest.support.errors import InputError
from strategies import BagSet as Drawn
from strategies import bag_sets

Write = Callable[[str | bytes], Path]
HEAD = "bag_id,bag_label,f0,f1\n"


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def file(content: str | bytes) -> Path:
        path = tmp_path / "bags.csv"
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return file


def test_compressed_and_plain_files_are_read(write: Write) -> None:
    packed = (DATA / "few_molecules.csv.gz").read_bytes()
    assert_few_molecules(read_csv(DATA / "few_molecules.csv.gz"))
    assert_few_molecules(read_csv(write(packed)))
    assert_few_molecules(read_csv(str(write(gzip.decompress(packed)))))


def test_rows_of_a_bag_may_be_anywhere_and_columns_have_any_name_and_order(write: Write) -> None:
    path = write("y,skip,b,mol,a\nno,x,1,m2,2\nyes,x,3,m1,4\nno,x,5,m2,6\n")
    data = read_csv(path, bag_id="mol", label="y", features=["a", "b"], positive="yes")
    assert [bag.tolist() for bag in data.bags] == [[[2, 1], [6, 5]], [[4, 3]]]
    assert data.bag_ids.tolist() == ["m2", "m1"]
    assert data.labels.tolist() == [False, True]


def test_identifiers_stay_strings(write: Write) -> None:
    data = read_csv(write(HEAD + "007,1,1,2\n7,0,1,2\nNA,1,1,2\n"))
    assert data.bag_ids.tolist() == ["007", "7", "NA"]


def test_quotes_spaces_blank_lines_line_ends_and_a_byte_order_mark_are_understood(write: Write) -> None:
    path = write(b'\xef\xbb\xbfbag_id, bag_label,f0\r\n"a, b", 1 ,1e3\r\n\r\n"c\nd",-1, -.5 \r\n')
    data = read_csv(path)
    assert data.bag_ids.tolist() == ["a, b", "c\nd"]
    assert [bag.tolist() for bag in data.bags] == [[[1000]], [[-0.5]]]


def test_blanks_around_identifiers_do_not_matter(write: Write) -> None:
    data = read_csv(write(HEAD + 'a,1,1,2\na ,1,3,4\n" a",1,5,6\n'))
    assert data.bag_ids.tolist() == ["a"]
    assert data.n_instances == 3


def test_bags_of_one_class_can_be_read(write: Write) -> None:
    assert read_csv(write(HEAD + "a,1,0,0\nb,1,0,0\n")).labels.tolist() == [True, True]
    assert read_csv(write(HEAD + "a,-1,0,0\n")).labels.tolist() == [False]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty: its first line must name the columns"),
        ("\n\n", "is empty: its first line must name the columns"),
        (HEAD, "does not contain any instances"),
        ("id,bag_label,f0\na,1,2\n", "column 'bag_id' is missing from .*, which has 'id', 'bag_label', 'f0'"),
        ("bag_id,bag_label\na,1\n", "columns of features are missing"),
        ("bag_id,bag_label,f0,f0\na,1,2,3\n", "has two columns 'f0'"),
        (HEAD + "a,1,2,3\na,1,x,3\n", "line 3: column 'f0': 'x' is not a finite number"),
        (HEAD + "a,1,2,3\n\na,1,2,\n", "line 4: column 'f1': '' is not a finite number"),
        (HEAD + "a,1,2,nan\n", "line 2: column 'f1': 'nan' is not a finite number"),
        (HEAD + "a,1,-inf,0\n", "line 2: column 'f0': '-inf' is not a finite number"),
        (HEAD + "a,1,1_0,0\n", "line 2: column 'f0': '1_0' is not a finite number"),
        (HEAD + "a,1,2,3\na,1,2\n", "line 3: the row has 3 of 4 fields"),
        (HEAD + "a,1,2,3\nb,0,1,2,3\n", "line 3: the row has 5 of 4 fields"),
        (HEAD + "a,1,2,3\nb,0,2,3\na,0,4,5\n", "line 4: bag 'a' is labelled '0' here and '1' above"),
        (HEAD + "a,1,2,3\n,0,2,3\n", "line 3: the name of the bag is missing"),
        (HEAD + 'a,1,2,3\nb,0,2,"5 inch\nc,1,2,3\n', "line 3: a quote is not closed: close each"),
        (HEAD + 'a,1,2,3\nb,0,2,"5\nc,1,2,"6\n', "line 3: a quote is not closed"),
        (HEAD + '"a\nb",1,2,x\n', "line 2: column 'f1': 'x' is not a finite number"),
        (
            ",bag_id,bag_label,f0\n0,a,1,2\n",
            "column 1 is unnamed, like a row index: .*index=False",
        ),
        ("bag_id,bag_label,f0,\na,1,2,0\n", "column 4 is unnamed"),
        (
            HEAD + "a,yes,2,3\nb,no,2,3\n",
            "labels 'no', 'yes' is positive: give positive='no' or positive='yes'",
        ),
        (HEAD + "a,0,2,3\nb,-1,2,3\n", "labels '-1', '0' is positive: give positive='-1' or positive='0'"),
        (HEAD + "a,x,2,3\nb,y,2,3\nc,z,2,3\n", "more than two labels, 'x', 'y', 'z'"),
        (HEAD + "a,0,2,3\nb,-1,2,3\nc,1,2,3\n", "more than two labels, '-1', '0', '1'"),
    ],
)
def test_what_is_wrong_and_where_is_said(write: Write, text: str, message: str) -> None:
    path = write(text)
    with pytest.raises(InputError, match=message) as error:
        read_csv(path)
    assert str(path) in str(error.value)


@pytest.mark.parametrize(
    ("features", "column"),
    [(["f0", "bag_label"], "bag_label"), (["bag_id", "f0"], "bag_id"), (["f0", "f1", "f0"], "f0")],
)
def test_no_column_is_chosen_twice(write: Write, features: list[str], column: str) -> None:
    with pytest.raises(InputError, match=f"column '{column}' is chosen twice"):
        read_csv(write(HEAD + "1,1,2,3\n"), features=features)


def test_a_bag_id_is_no_label(write: Write) -> None:
    with pytest.raises(InputError, match="column 'bag_id' is chosen twice"):
        read_csv(write(HEAD + "1,1,2,3\n"), label="bag_id")


def test_a_row_index_does_not_matter_if_features_are_named(write: Write) -> None:
    data = read_csv(write(",bag_id,bag_label,f0\n7,a,1,2\n"), features=["f0"])
    assert data.bags[0].tolist() == [[2]]


@pytest.mark.parametrize("positive", ["maybe", "x"])
def test_the_positive_label_must_be_one_of_two(write: Write, positive: str) -> None:
    labels = ("x", "y", "z") if positive == "x" else ("x", "y")
    path = write(HEAD + "".join(f"b{label},{label},1,2\n" for label in labels))
    with pytest.raises(InputError, match=f"positive='{positive}' must be one of two labels"):
        read_csv(path, positive=positive)


def test_text_that_is_not_utf8_is_refused(write: Write) -> None:
    with pytest.raises(InputError, match=r"is not UTF-8 text \(byte 0xfc in line 2\): pass its encod"):
        read_csv(write(HEAD.encode() + "müsk,1,2,3\n".encode("latin-1")))


def test_files_that_cannot_be_opened_or_unpacked_are_named(tmp_path: Path, write: Write) -> None:
    with pytest.raises(InputError, match=r"file .*none\.csv does not exist"):
        read_csv(tmp_path / "none.csv")
    with pytest.raises(InputError, match="is a folder: give the name of a file"):
        read_csv(tmp_path)
    packed = (DATA / "few_molecules.csv.gz").read_bytes()
    with pytest.raises(InputError, match=r"bags\.csv is damaged: it cannot be unpacked with gzip"):
        read_csv(write(packed[:-20]))


def test_fields_of_boundless_length_are_refused(write: Write) -> None:
    with pytest.raises(InputError, match="line 2: a field is longer than 131072 characters"):
        read_csv(write(HEAD + "a,1,2,3" + "0" * 200_000))


def test_one_string_is_no_list_of_columns(write: Write) -> None:
    with pytest.raises(InputError, match="features must be a sequence of column names, got the string 'f0'"):
        read_csv(write(HEAD), features="f0")


def test_ten_thousand_columns_are_read(write: Write) -> None:
    names = ",".join(f"a_rather_long_name_of_a_column_{number}" for number in range(10_000))
    row = ",".join(["-0.12345678901234567"] * 10_000)
    data = read_csv(write(f"bag_id,bag_label,{names}\na,1,{row}\nb,0,{row}\n"))
    assert data.n_features == 10_000
    assert data.bags[1][0, -1] == -0.12345678901234567


@given(bag_sets())
def test_what_is_written_is_read(drawn: Drawn) -> None:
    points, starts, labels = drawn
    expected = BagSet(np.split(points, starts[1:-1]), labels, np.array([f"b{i}" for i in range(len(labels))]))
    names = ",".join(f"f{number}" for number in range(points.shape[1]))
    rows = "".join(
        f"{name},{int(label)},{','.join(map(repr, point))}\n"
        for name, label, bag in zip(expected.bag_ids, expected.labels, expected.bags, strict=True)
        for point in bag.tolist()
    )
    found = parse_csv(f"bag_id,bag_label,{names}\n{rows}".encode(), Columns(), origin="bags.csv")
    assert_same_bags(found, expected)


VALID = gzip.decompress((DATA / "few_molecules.csv.gz").read_bytes())


@given(st.data())
def test_hostile_tables_are_read_or_refused(data: st.DataObject) -> None:
    start = data.draw(st.integers(0, len(VALID)))
    end = data.draw(st.integers(start, min(start + 8, len(VALID))))
    patch = data.draw(
        st.one_of(st.binary(max_size=6), st.sampled_from([b'"', b",", b"\n", b"\r", b"nan", b"\0"]))
    )
    content = VALID[:start] + patch + VALID[end:]
    try:
        found = parse_csv(content, Columns(), origin="bags.csv")
    except InputError as error:
        assert "bags.csv" in str(error)  # noqa: PT017 - both outcomes are right
    else:
        assert all(np.isfinite(bag).all() for bag in found.bags)


@pytest.mark.parametrize(
    ("content", "options"),
    [
        ("bag_id;bag_label;f0\na;1;0,5\nb;0;3\n", {}),
        ("bag_id\tbag_label\tf0\na\t1\t0.5\nb\t0\t3\n", {}),
        ('bag_id,bag_label,f0\na,1,"0,5"\nb,0,3\n', {}),
        ("bag_id;bag_label;f0\na;1;0,500\nb;0;3\n", {"decimal": ","}),
        ("bag_id bag_label f0\na 1 .5\nb 0 3\n", {"separator": " "}),
    ],
)
def test_dialects_are_seen_or_named(write: Write, content: str, options: dict[str, str]) -> None:
    data = read_csv(write(content), **options)
    assert [bag.tolist() for bag in data.bags] == [[[0.5]], [[3]]]


def test_a_comma_that_may_mean_two_things_needs_a_word(write: Write) -> None:
    with pytest.raises(
        InputError, match=r"line 2: column 'f0': '1,500' is .*: if the comma is the decimal mark"
    ):
        read_csv(write("bag_id;bag_label;f0\na;1;1,500\n"))
    with pytest.raises(InputError, match=r"line 2: column 'f0': '1\.500' is not a finite number"):
        read_csv(write("bag_id;bag_label;f0\na;1;1.500\n"), decimal=",")


def test_other_encodings_can_be_named(write: Write) -> None:
    path = write((HEAD + "müsk,1,2,3\n").encode("latin-1"))
    assert read_csv(path, encoding="latin-1").bag_ids.tolist() == ["müsk"]
    assert read_csv(write((HEAD + "müsk,1,2,3\n").encode("utf-16"))).bag_ids.tolist() == ["müsk"]


def test_columns_that_are_not_used_do_not_matter(write: Write) -> None:
    path = write(b"bag_id,note,bag_label,note,f0\na,\xff,1,x,2\n")
    assert read_csv(path, features=["f0"]).bags[0].tolist() == [[2]]
    with pytest.raises(InputError, match="has two columns 'note': rename one of them"):
        read_csv(path)
    with pytest.raises(InputError, match="is not UTF-8 text"):
        read_csv(write(HEAD.encode() + b"a,1,2,\xff\n"))


def test_open_files_are_read(write: Write) -> None:
    with write(HEAD + "a,1,2,3\n").open(encoding="utf-8") as file:
        assert read_csv(file).bag_ids.tolist() == ["a"]
    with pytest.raises(InputError, match="the open BytesIO, line 2: the row has 3 of 4 fields"):
        read_csv(io.BytesIO(HEAD.encode() + b"a,1,2\n"))


@pytest.mark.parametrize("path", ["", "a\0b", "https://example.org/bags.csv", None])
def test_things_that_are_no_path_are_refused(path: Any) -> None:
    with pytest.raises(InputError, match=r"is not a path|is a web address|expected a path"):
        read_csv(path)
