from __future__ import annotations

import datetime as dt
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pyarrow import parquet

from relforest.scenes import Scenes, read_table
from relforest.scenes.columns import open_frame
from relforest.scenes.id_columns import id_column
from relforest.support.errors import InputError

# Neighbours that are one float.
BIG = 2**53 + 2
NEXT = 2**53 + 3


def ids_of(values: Any, datatype: Any = None) -> list[Any]:
    table = pa.table({"id": pa.array(values, datatype)})
    return id_column(open_frame(table, ["id"]), "id").to_pylist()  # type: ignore[no-any-return]


@pytest.mark.parametrize(
    ("values", "datatype", "expected"),
    [
        (["07", "7", " 7", "7e0", "NA", "null", ""], None, ["07", "7", " 7", "7e0", "NA", "null", ""]),
        ([BIG, NEXT, None], None, [BIG, NEXT, None]),
        ([2**63, 1], pa.uint64(), ["9223372036854775808", "1"]),
        ([2.0, None, -3.0], None, [2, None, -3]),
        ([2.0**53 - 1], None, [2**53 - 1]),
        ([Decimal(10**20), Decimal(7)], None, ["100000000000000000000", "7"]),
        ([Decimal(10), None], None, [10, None]),
        ([b"\xc3\xa9", b"e"], None, ["é", "e"]),
        ([dt.date(2024, 2, 29), None], None, ["2024-02-29", None]),
        ([dt.date(2024, 2, 29)], pa.date64(), ["2024-02-29"]),
        ([dt.time(9, 30), dt.time(9, 30, 0, 250_000)], None, ["09:30:00", "09:30:00.25"]),
        (
            [dt.datetime(2024, 1, 1), dt.datetime(2024, 1, 1, 0, 0, 0, 10)],  # noqa: DTZ001
            None,
            ["2024-01-01T00:00:00", "2024-01-01T00:00:00.00001"],
        ),
        ([0, 1], pa.timestamp("ns", "UTC"), ["1970-01-01T00:00:00Z", "1970-01-01T00:00:00.000000001Z"]),
        # The clock goes back: an hour apart, but the same time of day.
        (
            [1_729_989_000, 1_729_992_600],
            pa.timestamp("s", "Europe/Berlin"),
            ["2024-10-27T02:30:00+02:00", "2024-10-27T02:30:00+01:00"],
        ),
    ],
)
def test_ids_are_read_as_they_are_written(values: Any, datatype: Any, expected: list[Any]) -> None:
    assert ids_of(values, datatype) == expected


@pytest.mark.parametrize(
    ("values", "datatype", "message"),
    [
        (
            [float(BIG)],
            pa.float64(),
            r"contains the float 9007199254740994 in row 0, .* have lost digits: read",
        ),
        ([1.0, 2.0**53], pa.float64(), "exact only below 9007199254740992"),
        ([1.0, -(2.0**24)], pa.float32(), "contains the float -16777216 in row 1, .* only below 16777216"),
        ([np.float16(2048)], pa.float16(), "exact only below 2048"),
        ([np.inf], pa.float64(), "contains the float inf"),
        (
            [1.5],
            pa.float64(),
            "contains 1.5 in row 0, but ids are whole numbers or strings: convert the column",
        ),
        (
            [b"\xff"],
            pa.binary(),
            "contains binary values that cannot be converted to text: convert the column to strings",
        ),
        ([0], pa.timestamp("s", "Nowhere/Else"), "cannot be converted to text"),
        ([[1]], None, "contains list.*, but ids are integers, strings, dates or times"),
    ],
)
def test_ids_that_are_not_certain_are_refused(values: Any, datatype: Any, message: str) -> None:
    with pytest.raises(InputError, match=f"column 'id' .*{message}|column 'id' {message}"):
        ids_of(values, datatype)


@pytest.mark.parametrize("library", [pd.DataFrame, pl.DataFrame, pa.table])
def test_big_integers_stay_apart_in_every_library(library: Any) -> None:
    frame = library({"s": [BIG, NEXT, BIG], "o": [NEXT, BIG, BIG], "x": [0.0, 1.0, 2.0]})
    scenes = Scenes.from_frame(frame, scene="s", object="o", attributes={"x": "x"})

    assert scenes.scene_ids.tolist() == [BIG, NEXT]
    assert scenes.object_ids.tolist() == [NEXT, BIG, BIG]


def test_an_argument_is_not_bound_to_a_neighbour() -> None:
    frame = pd.DataFrame({"s": [1, 1, 2], "o": [BIG, NEXT, 5], "x": [0.0, 1.0, 2.0], "p": [NEXT, NEXT, None]})
    keywords: dict[str, Any] = {"scene": "s", "object": "o", "attributes": {"x": "x"}, "arguments": ["p"]}

    with pytest.raises(InputError, match="column 'p' contains the float 9007199254740996 in row 0"):
        Scenes.from_frame(frame, **keywords)
    exact = pd.DataFrame({"p": pd.array([NEXT, NEXT, None], dtype="Int64")})
    scenes = Scenes.from_frame(frame.assign(p=exact["p"]), **keywords)
    assert scenes.arguments.tolist() == [[1], [-1]]


TEXTS = st.text(st.characters(codec="utf-8", exclude_characters='\0\r\n,;|\t"'), min_size=1, max_size=4)
LIKE_NUMBERS = st.sampled_from(
    ["0", "00", "+0", "-0", "0.0", "0e0", "1e3", "1000", "NaN", "nan", "true", " "]
)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(ids=st.lists(TEXTS | LIKE_NUMBERS, min_size=1, max_size=8, unique=True))
def test_text_comes_back_from_files(ids: list[str], tmp_path: Path) -> None:
    lines = [f"{name},{position}" for position, name in enumerate(ids)]
    (tmp_path / "t.csv").write_text("\n".join(["s,x", *lines]) + "\n", encoding="utf-8", newline="")
    parquet.write_table(pa.table({"s": ids, "x": range(len(ids))}), tmp_path / "t.parquet")
    for name in ("t.csv", "t.parquet"):
        scenes = Scenes.from_frame(read_table(tmp_path / name), scene="s", attributes={"x": "x"})
        assert scenes.scene_ids.tolist() == ids
        scenes.to_parquet(tmp_path / "own.parquet")
        assert Scenes.from_parquet(tmp_path / "own.parquet") == scenes
