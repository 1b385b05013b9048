from __future__ import annotations

import json
from contextlib import suppress
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

from relforest.scenes import Attribute, Scenes, Schema, iter_scene_batches
from relforest.scenes.parquet import sealed, to_table, write_table
from relforest.support.errors import InputError, ModelFormatError
from strategies import assert_same_scenes, scenes_batches

# Every example overwrites the same file.
same_folder = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])


def two_scenes(**changes: Any) -> Scenes:
    """Scenes {p, q} and {q}, sharing q; the first binds q."""
    parts: dict[str, Any] = {
        "schema": Schema([Attribute("location", 2), Attribute("weight")], ["passer"]),
        "matrix": np.array([[1.0, 2.0, np.nan], [3.0, 4.0, 5.0]]),
        "rows": np.array([0, 1, 1]),
        "starts": np.array([0, 2]),
        "counts": np.array([2, 1]),
        "arguments": np.array([[1], [-1]]),
        "scene_ids": np.array([7, 9]),
        "object_ids": np.array(["p", "q"], dtype=object),
    }
    return Scenes(**(parts | changes))


@same_folder
@given(scenes=scenes_batches(max_relations=2))
def test_a_file_gives_the_same_scenes_back(scenes: Scenes, tmp_path: Path) -> None:
    path = tmp_path / "scenes.parquet"
    scenes.to_parquet(path)

    assert_same_scenes(Scenes.from_parquet(path), scenes)


@same_folder
@given(scenes=scenes_batches(max_relations=2), data=st.data())
def test_repeated_scenes_and_shared_objects_survive(
    scenes: Scenes, data: st.DataObject, tmp_path: Path
) -> None:
    path = tmp_path / "scenes.parquet"
    taken = scenes.take(data.draw(st.lists(st.integers(0, len(scenes) - 1), max_size=6)))
    taken.to_parquet(path)

    assert_same_scenes(Scenes.from_parquet(path), taken, same_rows=len(taken) > 0)


def test_compact_scenes_come_back_array_by_array(tmp_path: Path) -> None:
    scenes = two_scenes()
    scenes.to_parquet(tmp_path / "scenes.parquet")

    for found, expected in zip(
        Scenes.from_parquet(tmp_path / "scenes.parquet").parts, scenes.parts, strict=True
    ):
        np.testing.assert_array_equal(found, expected)


def test_the_file_is_a_long_table_for_other_tools(tmp_path: Path) -> None:
    two_scenes().to_parquet(tmp_path / "scenes.parquet")
    table = pl.read_parquet(tmp_path / "scenes.parquet")

    assert table.drop("scene_number", "object_row").rows() == [
        (7, "p", 1.0, 2.0, pytest.approx(np.nan, nan_ok=True), "q"),
        (7, "q", 3.0, 4.0, 5.0, "q"),
        (9, "q", 3.0, 4.0, 5.0, None),
    ]
    assert table.columns[:6] == ["scene", "object", "location_0", "location_1", "weight", "passer"]


def test_names_that_meet_are_kept_apart(tmp_path: Path) -> None:
    schema = Schema([Attribute("a", 2), Attribute("a_0"), Attribute("scene")], ["a_0"])
    matrix = np.arange(4.0)[np.newaxis]
    scenes = Scenes(schema, matrix, *map(np.array, ([0], [0], [1], [[0]])))
    scenes.to_parquet(tmp_path / "scenes.parquet")

    assert to_table(scenes.parts).column_names[2:7] == ["a_0", "a_1", "a_0_", "scene_", "a_0__"]
    assert_same_scenes(Scenes.from_parquet(tmp_path / "scenes.parquet"), scenes)


def test_any_long_table_can_be_read_with_keywords(tmp_path: Path) -> None:
    pd.DataFrame({"s": [1, 1], "o": ["a", "b"], "x": [0.5, 1.5]}).to_parquet(tmp_path / "other.parquet")
    scenes = Scenes.from_parquet(tmp_path / "other.parquet", scene="s", object="o", attributes={"x": "x"})

    assert scenes.object_ids.tolist() == ["a", "b"]
    assert scenes.matrix.tolist() == [[0.5], [1.5]]


def test_keywords_read_our_own_files_as_plain_tables(tmp_path: Path) -> None:
    two_scenes().to_parquet(tmp_path / "scenes.parquet")
    scenes = Scenes.from_parquet(
        tmp_path / "scenes.parquet", scene="scene", object="object", attributes={"weight": "weight"}
    )

    np.testing.assert_array_equal(scenes.matrix, [[np.nan], [5], [5]])


def test_an_interrupted_or_failed_write_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "scenes.parquet"
    two_scenes().to_parquet(path)
    before = path.read_bytes()

    with pytest.raises(InputError):
        two_scenes(object_ids=np.array(["p", "p"], dtype=object)).to_parquet(path)
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["scenes.parquet"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"object_ids": np.array(["p", "p"], dtype=object)}, "object 'p' occurs twice in scene 7"),
        (
            {"object_ids": np.array(["p", 3], dtype=object)},
            "object_ids mix integers and strings",
        ),
        ({"scene_ids": np.array([None, 3], dtype=object)}, "scene_ids must be integers or strings, got None"),
    ],
)
def test_scenes_whose_ids_do_not_identify_cannot_be_written(
    changes: dict[str, Any], message: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=message):
        two_scenes(**changes).to_parquet(tmp_path / "scenes.parquet")


@pytest.mark.parametrize(
    "keywords", [{}, {"scene": "s"}, {"attributes": {"x": "x"}}, {"arguments": ["p"]}, {"object": "o"}]
)
def test_a_foreign_file_needs_keywords(keywords: dict[str, Any], tmp_path: Path) -> None:
    parquet.write_table(pa.table({"s": [1], "x": [1.0]}), tmp_path / "other.parquet")

    with pytest.raises(InputError, match="name its columns with scene= and attributes="):
        Scenes.from_parquet(tmp_path / "other.parquet", **keywords)


def test_missing_and_damaged_files_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"file .*none\.parquet does not exist"):
        Scenes.from_parquet(tmp_path / "none.parquet")
    (tmp_path / "bad.parquet").write_bytes(b"PAR1 but nothing else")
    with pytest.raises(InputError, match=r"bad\.parquet is not a readable Parquet file"):
        Scenes.from_parquet(tmp_path / "bad.parquet")
    two_scenes().to_parquet(tmp_path / "cut.parquet")
    whole = (tmp_path / "cut.parquet").read_bytes()
    (tmp_path / "cut.parquet").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(InputError, match=r"cut\.parquet is not a readable Parquet file"):
        Scenes.from_parquet(tmp_path / "cut.parquet")


def with_metadata(text: bytes) -> Any:
    return to_table(two_scenes().parts).replace_schema_metadata({b"relforest": text})


def with_document(**changes: Any) -> Any:
    document = json.loads(to_table(two_scenes().parts).schema.metadata[b"relforest"])
    return with_metadata(json.dumps(document | changes).encode())


def with_column(name: str, values: list[Any]) -> Any:
    table = to_table(two_scenes().parts)
    return table.set_column(table.column_names.index(name), name, pa.array(values))


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (with_metadata(b"{"), "unreadable metadata"),
        (with_metadata(b"\xff"), "unreadable metadata"),
        (with_metadata(b"[" * 100_000), "unreadable metadata"),
        (with_metadata(b"3"), "is not a relforest-scenes document"),
        (with_document(format="other"), "its format is 'other'"),
        (with_document(version=3), "written by a newer relforest"),
        (with_document(schema=None), "not a schema"),
        (with_document(columns=["scene"]), "its columns are not those of its schema"),
        (with_document(columns=None), "its columns are not those of its schema"),
        (with_column("scene_number", [0, 0, 2]), "not numbered in order"),
        (with_column("scene_number", [1, 1, 2]), "not numbered in order"),
        (with_column("scene_number", [0, 1, 0]), "not numbered in order"),
        (with_column("scene_number", [0, 0, None]), "not numbered in order"),
        (with_column("scene_number", ["a", "b", "c"]), "is damaged"),
        (with_column("object_row", [0, 2, 2]), "not numbered in order"),
        (with_column("object_row", [0, None, 1]), "not numbered in order"),
        (with_column("object_row", [0, 2**62, 1]), "not numbered in order"),
        (with_column("scene_number", [0, 0, 2**62]), "not numbered in order"),
        (with_column("scene", [7, 7, None]), "a scene lacks an id"),
        (with_column("object", ["p", None, "q"]), "not numbered in order"),
        (with_column("object", ["q", "q", "q"]), "occurs twice"),
        (with_column("passer", ["z", "z", None]), "'passer' of scene 7 is 'z'"),
        (
            with_column("weight", ["a", "b", "c"]),
            "column 'weight' contains 'a' in row 0, which is not a number",
        ),
        (with_column("weight", [1.0, np.inf, 1.0]), "column 'weight' is infinite in row 1"),
    ],
)
def test_our_own_files_are_checked_when_they_come_back(table: Any, message: str, tmp_path: Path) -> None:
    write_table(tmp_path / "scenes.parquet", table)

    with pytest.raises(ModelFormatError, match=message):
        Scenes.from_parquet(tmp_path / "scenes.parquet")
    with suppress(InputError, ModelFormatError):
        list(iter_scene_batches(tmp_path / "scenes.parquet"))


def test_columns_may_be_added_to_our_own_files(tmp_path: Path) -> None:
    path = tmp_path / "scenes.parquet"
    two_scenes().to_parquet(path)
    parquet.write_table(parquet.read_table(path).append_column("label", pa.array([1, 1, 0])), path)

    assert_same_scenes(Scenes.from_parquet(path), two_scenes())


def test_files_without_digests_are_read(tmp_path: Path) -> None:
    write_table(tmp_path / "scenes.parquet", to_table(two_scenes().parts))

    assert_same_scenes(Scenes.from_parquet(tmp_path / "scenes.parquet"), two_scenes())


@pytest.mark.parametrize(("column", "values"), [("weight", [None, 5.5, 5.0]), ("object", ["p", "r", "r"])])
def test_a_change_of_values_is_noticed(column: str, values: list[Any], tmp_path: Path) -> None:
    path = tmp_path / "scenes.parquet"
    table = sealed(to_table(two_scenes().parts))
    place = table.column_names.index(column)
    write_table(path, table.set_column(place, table.field(place), pa.array(values, table.field(place).type)))
    keywords: dict[str, Any] = {"scene": "scene", "object": "object", "attributes": {"weight": "weight"}}

    for named in ({}, keywords):
        with pytest.raises(ModelFormatError, match=f"is damaged, or column '{column}' was changed af"):
            Scenes.from_parquet(path, **named)
    # What is not read does not matter.
    keywords = {"scene": "scene", "attributes": {"location_0": "location_0"}}
    assert len(Scenes.from_parquet(path, **keywords)) == 2
    parquet.write_table(parquet.read_table(path).replace_schema_metadata(), path)
    assert len(Scenes.from_parquet(path, **keywords)) == 2


@pytest.mark.parametrize("digests", [3, {}, {"": "0"}])
def test_a_change_of_digests_is_noticed(digests: Any, tmp_path: Path) -> None:
    write_table(tmp_path / "scenes.parquet", with_document(digests=digests))

    with pytest.raises(ModelFormatError, match="its metadata was changed"):
        Scenes.from_parquet(tmp_path / "scenes.parquet")


@pytest.mark.parametrize("text", [False, True])
def test_a_changed_byte_is_not_read_as_other_data(text: bool, tmp_path: Path) -> None:  # noqa: FBT001
    path = tmp_path / "scenes.parquet"
    scenes = two_scenes() if text else two_scenes(object_ids=np.array([300, 4]))
    scenes.to_parquet(path)
    data = path.read_bytes()
    outcomes = {"refused": 0, "same": 0}
    for place in range(0, len(data), 3):
        path.write_bytes(data[:place] + bytes([data[place] ^ (1 << place % 8)]) + data[place + 1 :])
        try:
            assert Scenes.from_parquet(path) == scenes
        except (InputError, ModelFormatError):
            outcomes["refused"] += 1
        else:
            outcomes["same"] += 1

    assert min(outcomes.values()) > 100


@pytest.mark.parametrize("path", ["", "a\0b.parquet", "{folder}", "{file}/scenes.parquet"])
def test_a_path_that_cannot_be_written_is_named(path: str, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    path = path.format(folder=tmp_path, file=tmp_path / "file")

    with pytest.raises(InputError, match=r"cannot write to '|path to write to is empty|not a valid path"):
        two_scenes().to_parquet(path)
    assert [each.name for each in tmp_path.iterdir()] == ["file"]


def test_half_a_character_cannot_be_written(tmp_path: Path) -> None:
    ids = np.array(["p", "\ud800"], dtype=object)
    with pytest.raises(InputError, match=r"object_ids hold '\\ud800', which cannot be written as text"):
        two_scenes(object_ids=ids).to_parquet(tmp_path / "scenes.parquet")
