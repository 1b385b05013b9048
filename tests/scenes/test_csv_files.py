from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import pytest

from relforest.scenes import Scenes, read_table
from relforest.scenes.csv_files import open_csv
from relforest.scenes.dialect import ANY_DIALECT
from relforest.support.errors import InputError

ROWS = "s,x,note\n1,0.5,a\n2,1.5,b\n"


def read(content: str | bytes, columns: list[str]) -> list[list[Any]]:
    """Return columns of CSV text as lists."""
    data = content.encode() if isinstance(content, str) else content
    table = open_csv(data, "t.csv", ANY_DIALECT).read(columns)
    return [table[name].to_pylist() for name in columns]


def test_fields_keep_their_text_and_empty_ones_are_null() -> None:
    content = 's,x\n007, 1 \n"a ""b"", c",\nNA,""\ntrue,"2\n3"\n'

    assert read(content, ["x", "s"]) == [[" 1 ", None, None, "2\n3"], ["007", 'a "b", c', "NA", "true"]]


@pytest.mark.parametrize(
    "content",
    [
        ROWS,
        ROWS.replace("\n", "\r\n"),
        ROWS.replace("\n", "\r"),
        "\n\n" + ROWS.replace("\n", "\n\n"),
        ROWS.rstrip("\n"),
        ROWS.replace("note", '"a\nnote"'),
        ROWS.replace(",a", ',5" wide').replace(",b", ',"it""s, ""quoted"""'),
    ],
    ids=["plain", "windows", "mac", "blank lines", "no end", "two lines of names", "quotes"],
)
def test_lines_may_end_in_many_ways(content: str) -> None:
    assert read(content, ["s", "x"]) == [["1", "2"], ["0.5", "1.5"]]


def test_columns_that_are_not_used_may_be_named_and_filled_with_anything() -> None:
    content = b"s,note,x,note,\n1,\xff\xfe,0.5,a,\n2,b,1.5,\xe9,\x00\n"

    assert read(content, ["s", "x"]) == [["1", "2"], ["0.5", "1.5"]]
    with pytest.raises(InputError, match=r"2 columns of t\.csv are named 'note'"):
        read(content, ["note"])


def test_rows_of_any_length_are_read() -> None:
    long = "x" * 3_000_000

    assert read(f"s,x\n1,{long}\n2,y\n", ["s", "x"]) == [["1", "2"], [long, "y"]]


def test_a_file_with_nothing_but_names_has_no_rows() -> None:
    assert read("s,x", ["x"]) == [[]]
    assert read("s,x\n\n\n", ["x", "s"]) == [[], []]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", r"t\.csv is empty: its first line must name the columns"),
        (b"\n\r\n", r"t\.csv is empty"),
        (
            b"s,x\n1,2\n\n3\n",
            r"t\.csv, line 4: the row has 1 of 2 fields: complete the row, and quote",
        ),
        (b's,x\n"1\n2",3\n1,2,3\n', r"t\.csv, line 4: the row has 3 of 2 fields"),
        (b"s,x\n1,2\n3,\xe9\n", r"t\.csv is not UTF-8 text \(byte 0xe9 in line 3\): pass its"),
        (b"s,\xe9\n1,2\n", r"column 'x' is missing from t\.csv, which has 's', '\\udce9' \(pass"),
        # Each of these would swallow rows.
        (
            b's,x\n1,"2\n3,4\n',
            r"t\.csv, line 2: a quote is not closed: close each quote directly",
        ),
        (b's,x\n1,"2\n3,4\n5,"6\n', r"t\.csv, line 2: a quote is not closed"),
        (b's,x\n1,"2\n3,4', r"t\.csv, line 2: a quote is not closed"),
        (b's,x,"y\n1,2,3\n', r"t\.csv, line 1: a quote is not closed"),
    ],
)
def test_what_is_wrong_and_where_is_said(content: bytes, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read(content, ["s", "x"])


@pytest.mark.parametrize(
    ("options", "content"),
    [
        ({}, "s;x;y\n1;0,5;1\n2;3;4\n"),
        ({"separator": "\t"}, "s\tx\ty\n1\t0.5\t1\n2\t3\t4\n"),
        ({"separator": "tab"}, "s\tx\ty\n1\t0.5\t1\n2\t3\t4\n"),
        ({"separator": " "}, "s x y\n1 .5 1\n2 3. 4\n"),
        ({"decimal": ","}, "s|x|y\n1|0,500|1\n2|3|4\n"),
        ({"decimal": ","}, 's,x,y\n1,"0,500",1\n2,3,4\n'),
    ],
)
def test_dialects_are_seen_or_named(options: dict[str, str], content: str, tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text(content, encoding="utf-8")
    table = read_table(tmp_path / "t.csv", **options)
    scenes = Scenes.from_frame(table, scene="s", attributes={"location": ["x", "y"]})

    assert scenes.matrix.tolist() == [[0.5, 1], [3, 4]]


def test_the_decimal_mark_is_for_numbers_only() -> None:
    table = read_table(io.StringIO("s;x\n1,5;1,250\n1.5;2\n"), decimal=",")
    scenes = Scenes.from_frame(table, scene="s", attributes={"x": "x"})

    assert scenes.scene_ids.tolist() == ["1,5", "1.5"]
    assert scenes.matrix.tolist() == [[1.25], [2]]


def test_a_header_that_is_not_utf8_is_refused_when_its_columns_are_read() -> None:
    with pytest.raises(InputError, match=r"t\.csv is not UTF-8 text \(byte 0xe9 in line 1\): pass its"):
        read(b"s,x\xe9\n1,2\n", ["s", "x\udce9"])
