from __future__ import annotations

import gzip
import io
import os
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from relforest.scenes import Scenes, read_table, scene_values
from relforest.support.errors import InputError

PASSES = """pass,player,x,theta,passer,completed
7,a,1.5,0.25,b,yes
9,b,2,NaN,,no
7,b,,1,b,yes
8,,,,,no
"""


@pytest.mark.parametrize(
    "name", ["passes.csv", "passes.CSV", "passes.tsv", "passes.csv.gz", "passes.parquet", "passes.pq"]
)
def test_a_table_is_read_by_its_suffix(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    if path.suffix.lower() in (".csv", ".gz", ".tsv"):
        text = (PASSES.replace(",", "\t") if path.suffix == ".tsv" else PASSES).encode()
        path.write_bytes(gzip.compress(text) if path.suffix == ".gz" else text)
    else:
        pd.read_csv(io.StringIO(PASSES)).to_parquet(path)
    table = read_table(path)
    scenes = Scenes.from_frame(
        table,
        scene="pass",
        object="player",
        attributes={"x": "x", "orientation": "theta"},
        arguments=["passer"],
    )

    assert list(map(str, scenes.scene_ids)) == ["7", "9", "8"]
    assert scenes.object_ids.tolist() == ["a", "b", "b"]
    np.testing.assert_array_equal(scenes.matrix, [[1.5, 0.25], [np.nan, 1.0], [2.0, np.nan]])
    assert scenes.arguments.tolist() == [[1], [-1], [-1]]
    assert scene_values(table, "completed", scene="pass").tolist() == ["yes", "no", "no"]


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("passes.xlsx", "a", r"the suffix '\.xlsx': only \.csv, \.tsv, \.parquet, \.pq files can"),
        ("passes", "a", "the suffix ''"),
        ("passes.zip", "a", r"the suffix '\.zip'"),
        ("passes.xlsx.gz", "a", r"the suffix '\.gz'"),
        (
            "passes.csv",
            "a,b\n1,2\n1,2,3\n",
            r"passes\.csv, line 3: the row has 3 of 2 fields: complete the row",
        ),
        ("passes.csv", "", "is empty: its first line must name the columns"),
        ("passes.parquet", "a,b\n", "not a readable Parquet file"),
        ("passes.csv", None, "does not exist: check the path"),
        ("passes.pq", None, "does not exist: check the path"),
    ],
)
def test_files_that_cannot_be_read_are_named(
    name: str, content: str | None, message: str, tmp_path: Path
) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_text(content, encoding="utf-8")

    with pytest.raises(InputError, match=message):
        read_table(path)


def test_columns_are_chosen_by_name(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("s;x;note;note\n1;2;3;4\n")

    assert read_table(tmp_path / "t.csv").column_names == ["s", "x"]
    assert read_table(tmp_path / "t.csv", columns=("x", "s", "x")).to_pydict() == {"x": ["2"], "s": ["1"]}
    with pytest.raises(InputError, match=r"columns must be a sequence of names, got a string: write \['x'\]"):
        read_table(tmp_path / "t.csv", columns="x")


def test_tables_are_read_from_open_files() -> None:
    assert read_table(io.StringIO(PASSES), columns=["player"]).column(0).to_pylist() == ["a", "b", "b", None]
    with pytest.raises(InputError, match="the open BytesIO is not UTF-8 text"):
        read_table(io.BytesIO(b"a\n\xff\n"))


def test_special_files_are_refused(tmp_path: Path) -> None:
    for name in ("pipe.csv", "pipe.parquet"):
        os.mkfifo(tmp_path / name)
        with pytest.raises(InputError, match=f"{name} cannot be read: it is not a regular file"):
            read_table(tmp_path / name)
