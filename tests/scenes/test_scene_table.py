from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given

from cli.command_lines import N_SCENES, passes, write
from relforest.scenes import Attribute, Scenes, Schema, scene_values
from relforest.scenes.frames import FrameLayout
from relforest.scenes.parquet import sealed, to_table
from relforest.scenes.scene_table import SceneTable, check_schema, read_scenes
from relforest.support.errors import InputError, ModelFormatError
from strategies import assert_same_scenes, scenes_batches

COLUMNS = FrameLayout("pass", "player", ((Attribute("extent"), ("x",)),), ("passer",))


def own_file(path: Path, scenes: Scenes, **columns: object) -> Path:
    """Write scenes as `Scenes.to_parquet` does, with further columns."""
    table = to_table(scenes.parts)
    for name, values in columns.items():
        table = table.append_column(name, pa.array(values))
    return write(table, path)


def values_of(source: SceneTable, column: str) -> list[object]:
    found: list[object] = scene_values(source.table, column, scene=source.scene_key).tolist()
    return found


def small_scenes() -> Scenes:
    """Two scenes of the same id, with 2 objects and 1 object; an argument in the first."""
    schema = Schema([Attribute("location", 2), Attribute("orientation")], ["passer"])
    return Scenes(
        schema,
        np.arange(9.0).reshape(3, 3) / 10,
        np.arange(3),
        np.array([0, 2]),
        np.array([2, 1]),
        np.array([[1], [-1]]),
        np.array([7, 7]),
        np.array(["a", "b", "c"], dtype=object),
    )


@pytest.mark.parametrize("suffix", ["parquet", "csv"])
def test_long_tables_are_read_by_their_columns(tmp_path: Path, suffix: str) -> None:
    source = read_scenes(
        write(passes(), tmp_path / f"passes.{suffix}"), COLUMNS, remedy="", label="completed"
    )

    assert len(source.scenes) == N_SCENES
    assert source.scenes.schema.parameters == ("passer",)
    assert source.layout == COLUMNS
    assert values_of(source, "completed") == [True, False] * (N_SCENES // 2)


def test_long_tables_need_columns(tmp_path: Path) -> None:
    path = write(passes(), tmp_path / "passes.csv")
    with pytest.raises(
        InputError, match=r"passes\.csv was not written by Scenes\.to_parquet: do this \(it has 'pass'"
    ):
        read_scenes(path, None, remedy="do this")


def test_own_files_need_none_even_with_further_columns(tmp_path: Path) -> None:
    scenes = small_scenes()
    path = own_file(tmp_path / "own.parquet", scenes, completed=[True, True, False])
    source = read_scenes(path, None, remedy="", label="completed")

    assert_same_scenes(source.scenes, scenes)
    # The ids are equal, but the labels are still told apart.
    assert values_of(source, "completed") == [True, False]
    assert source.layout == FrameLayout(
        "scene",
        "object",
        (
            (Attribute("location", 2), ("location_0", "location_1")),
            (Attribute("orientation"), ("orientation",)),
        ),
        ("passer",),
    )


@given(scenes_batches(max_relations=2))
def test_own_files_come_back_as_they_were(tmp_path_factory: pytest.TempPathFactory, scenes: Scenes) -> None:
    path = tmp_path_factory.mktemp("own") / "own.parquet"
    scenes.to_parquet(path)

    assert_same_scenes(read_scenes(path, None, remedy="").scenes, scenes)


def test_the_columns_of_an_own_file_lead_to_the_same_scenes(tmp_path: Path) -> None:
    path = own_file(tmp_path / "own.parquet", small_scenes())
    columns = read_scenes(path, None, remedy="").layout

    assert_same_scenes(read_scenes(path, columns, remedy="").scenes, small_scenes())


def test_an_own_file_can_be_read_by_other_columns(tmp_path: Path) -> None:
    path = own_file(tmp_path / "own.parquet", small_scenes().take([0]), weight=[1.0, 2.0])
    other = FrameLayout("scene", "object", ((Attribute("weight"), ("weight",)),))

    assert read_scenes(path, other, remedy="").scenes.values["weight"].tolist() == [[1.0], [2.0]]


def test_a_damaged_own_file_is_refused_or_read_by_its_columns(tmp_path: Path) -> None:
    table = to_table(small_scenes().take([0]).parts).drop_columns(["object_row"])
    path = write(table, tmp_path / "own.parquet")

    with pytest.raises(ModelFormatError, match="its columns are not those of its schema"):
        read_scenes(path, None, remedy="")
    columns = FrameLayout("scene", "object", ((Attribute("orientation"), ("orientation",)),))
    assert len(read_scenes(path, columns, remedy="").scenes) == 1


@pytest.mark.parametrize("metadata", [b"no json", b"[]", b"{}", b'{"columns": 3}', b'{"columns": [1, 2]}'])
def test_hostile_metadata_is_refused(tmp_path: Path, metadata: bytes) -> None:
    table = to_table(small_scenes().parts).replace_schema_metadata({b"relforest": metadata})
    path = write(table, tmp_path / "own.parquet")

    with pytest.raises(ModelFormatError, match=r"own\.parquet"):
        read_scenes(path, None, remedy="")


def test_metadata_may_name_columns_that_are_not_there(tmp_path: Path) -> None:
    table = to_table(small_scenes().parts)
    document = json.loads(table.schema.metadata[b"relforest"])
    document["columns"][0] = "elsewhere"
    table = table.replace_schema_metadata({b"relforest": json.dumps(document).encode()})

    with pytest.raises(ModelFormatError, match="is damaged"):
        read_scenes(write(table, tmp_path / "own.parquet"), None, remedy="")


def test_scenes_of_another_kind_are_described() -> None:
    schema = Schema([Attribute("weight", 3)])
    with pytest.raises(
        InputError,
        match=r"f.csv contains scenes with the attributes location \(2-D\), orientation \(angle\) and the "
        r"arguments passer, but the model needs scenes with the attributes weight \(3-D\) and the arguments "
        r"\(none\)",
    ):
        check_schema(Path("f.csv"), small_scenes(), schema)
    check_schema(Path("f.csv"), small_scenes(), small_scenes().schema)


def test_a_changed_own_file_is_refused_by_any_columns(tmp_path: Path) -> None:
    table = sealed(to_table(small_scenes().take([0]).parts))
    other = pa.array([0.5, 0.5])
    path = write(table.set_column(4, "orientation", other), tmp_path / "own.parquet")
    columns = FrameLayout("scene", "object", ((Attribute("orientation"), ("orientation",)),))

    for chosen in (None, columns):
        with pytest.raises(ModelFormatError, match="column 'orientation' was changed after"):
            read_scenes(path, chosen, remedy="")


def test_columns_that_are_not_used_do_not_matter(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_bytes(b"pass,player,x,passer,note,note,y\n1,a,1,a,\xff,,no\n1,b,2,a,,\xfe,no\n2,a,1,,,,yes\n")
    source = read_scenes(path, COLUMNS, remedy="", label="y")

    assert source.scenes.arguments.tolist() == [[0], [-1]]
    assert values_of(source, "y") == ["no", "yes"]
    with pytest.raises(InputError, match=r"column 'z' is missing from .*t\.csv, which has 'pass', 'player'"):
        read_scenes(path, COLUMNS, remedy="", label="z")
