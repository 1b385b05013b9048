from __future__ import annotations

import io
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


@pytest.mark.parametrize("name", ["passes.csv", "passes.CSV", "passes.parquet", "passes.pq"])
def test_a_table_is_read_by_its_suffix(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    if path.suffix.lower() == ".csv":
        path.write_text(PASSES, encoding="utf-8")
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

    assert scenes.scene_ids.tolist() == [7, 9, 8]
    assert scenes.object_ids.tolist() == ["a", "b", "b"]
    np.testing.assert_array_equal(scenes.matrix, [[1.5, 0.25], [np.nan, 1.0], [2.0, np.nan]])
    assert scenes.arguments.tolist() == [[1], [-1], [-1]]
    assert scene_values(table, "completed", scene="pass").tolist() == ["yes", "no", "no"]


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("passes.xlsx", "a", r"the suffix '\.xlsx': only \.csv, \.parquet and \.pq files can be read"),
        ("passes", "a", "the suffix ''"),
        ("passes.csv", "a,b\n1,2\n1,2,3\n", r"passes\.csv is not a readable CSV file"),
        ("passes.csv", "", "not a readable CSV file"),
        ("passes.parquet", "a,b\n", "not a readable Parquet file"),
        ("passes.csv", None, "there is no file"),
        ("passes.pq", None, "there is no file"),
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
