from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pyarrow import parquet

import relforest as rf
from relforest.scenes import Scenes, iter_scene_batches
from relforest.scenes.parquet import sealed, to_table, write_table
from relforest.scenes.scene_stream import scene_stream
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.progress import Stage, listening
from strategies import scenes_batches

COLUMNS: Any = {
    "scene": "s",
    "object": "o",
    "attributes": {"place": ["x", "y"]},
    "arguments": ["agent"],
}
# Every example overwrites the same files.
same_folder = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])


def long_table(counts: Sequence[int], *, ids: Sequence[Any] | None = None) -> pa.Table:
    """Scenes of some objects, 0 = a scene without objects; the last object is the agent."""
    names = range(5, 5 + len(counts)) if ids is None else ids
    rows = []
    for number, (name, count) in enumerate(zip(names, counts, strict=True)):
        agent = f"o{count - 1}" if count else None
        rows += [
            {
                "s": name,
                "o": f"o{i}",
                "x": i + 0.5,
                "y": -float(number),
                "agent": agent,
                "good": number % 2 == 0,
            }
            for i in range(count)
        ]
        if not count:
            rows.append({"s": name, "o": None, "x": None, "y": None, "agent": None, "good": number % 2 == 0})
    return pa.Table.from_pylist(rows)


def write_parts(folder: Path, table: pa.Table, cuts: Sequence[int], **options: Any) -> Path:
    """Write a table as a folder of files, cut before the given rows."""
    folder.mkdir(exist_ok=True)
    for old in folder.iterdir():
        old.unlink()
    bounds = [0, *cuts, len(table)]
    for number, (begin, end) in enumerate(pairwise(bounds)):
        parquet.write_table(table.slice(begin, end - begin), folder / f"part-{number}.parquet", **options)
    return folder


def dicts(batches: Sequence[Scenes]) -> list[dict[str, Any]]:
    return [record for batch in batches for record in batch.to_dicts()]


@same_folder
@given(
    counts=st.lists(st.integers(0, 4), min_size=1, max_size=7),
    cuts=st.lists(st.integers(0, 12), max_size=3),
    batch_size=st.integers(1, 9),
    group=st.integers(1, 5),
)
def test_batches_hold_the_scenes_of_the_whole_table_in_order(
    counts: list[int], cuts: list[int], batch_size: int, group: int, tmp_path: Path
) -> None:
    table = long_table(counts)
    cuts = sorted(min(cut, len(table)) for cut in cuts)
    folder = write_parts(tmp_path / "parts", table, cuts, row_group_size=group)
    expected = Scenes.from_frame(table, **COLUMNS)
    assert len(list(iter_scene_batches(folder, **COLUMNS))) <= 2 * len(cuts) + 1
    batches = list(iter_scene_batches(folder, label="good", batch_size=batch_size, **COLUMNS))

    assert dicts([scenes for scenes, _ in batches]) == expected.to_dicts()
    assert np.concatenate([labels for _, labels in batches]).tolist() == [
        i % 2 == 0 for i in range(len(counts))
    ]
    assert scene_stream(folder, **COLUMNS).count() == len(counts)


def test_a_batch_ends_with_the_last_scene_that_its_rows_complete(tmp_path: Path) -> None:
    parquet.write_table(long_table([2, 3, 1, 5]), tmp_path / "t.parquet")
    sizes = [
        len(scenes.matrix)
        for scenes in rf.iter_scene_batches(tmp_path / "t.parquet", batch_size=4, **COLUMNS)
    ]

    # After 4 rows only the first scene is complete, after 8 the second and the third.
    assert sizes == [2, 4, 5]


def test_scenes_belong_to_the_file_in_which_they_begin(tmp_path: Path) -> None:
    folder = write_parts(tmp_path / "parts", long_table([3, 3, 1]), [1, 2, 4])
    batches = list(scene_stream(folder, **COLUMNS).batches())

    assert [(batch.file, batch.scenes.scene_ids.tolist()) for batch in batches] == [
        (0, [5]),
        (2, [6]),
        (3, [7]),
    ]


def test_sources_are_files_folders_or_patterns(tmp_path: Path) -> None:
    folder = write_parts(tmp_path / "parts", long_table([1, 1, 1]), [1, 2])
    (folder / "_SUCCESS").touch()
    found = {
        str(source): [scenes.scene_ids.tolist() for scenes in iter_scene_batches(source, **COLUMNS)]
        for source in (folder / "part-1.parquet", folder, f"{tmp_path}/*/part-[02].parquet")
    }

    assert list(found.values()) == [[[6]], [[5], [6], [7]], [[5], [7]]]


@same_folder
@given(scenes=scenes_batches(max_relations=2), batch_size=st.integers(1, 5), data=st.data())
def test_our_own_files_come_back_without_keywords(
    scenes: Scenes, batch_size: int, data: st.DataObject, tmp_path: Path
) -> None:
    # Scenes may repeat, with the same id.
    scenes = scenes.take(data.draw(st.lists(st.integers(0, len(scenes) - 1), min_size=1, max_size=6)))
    for name in ("a", "b"):
        scenes.to_parquet(tmp_path / "own" / f"{name}.parquet")
    batches = list(iter_scene_batches(tmp_path / "own", batch_size=batch_size))

    assert {batch.schema for batch in batches} == {scenes.schema}
    assert dicts(batches) == 2 * scenes.to_dicts()


@pytest.mark.parametrize(
    ("column", "values", "message"),
    [
        ("weight", [None, 5.5, 5.0], "column 'weight' was changed after Scenes.to_parquet wrote it"),
        ("scene_number", [0, 1, 1], "column 'scene_number' was changed after"),
    ],
)
def test_our_own_files_are_checked_before_their_scenes_are_used(
    column: str, values: list[Any], message: str, tmp_path: Path
) -> None:
    schema = rf.Schema([rf.Attribute("weight")])
    scenes = Scenes(schema, np.arange(3.0)[:, np.newaxis], *map(np.array, ([0, 1, 2], [0, 2], [2, 1])))
    table = sealed(to_table(scenes.parts))
    place = table.column_names.index(column)
    changed = table.set_column(place, table.field(place), pa.array(values, table.field(place).type))
    write_table(tmp_path / "t.parquet", changed)

    with pytest.raises(ModelFormatError, match=message):
        next(iter_scene_batches(tmp_path / "t.parquet", batch_size=1))
    # Without digests, the numbering is still checked.
    document = to_table(scenes.parts).schema.metadata
    write_table(tmp_path / "t.parquet", table.slice(2).replace_schema_metadata(document))
    with pytest.raises(
        ModelFormatError, match=r"t\.parquet is damaged: its scenes are not numbered in order"
    ):
        list(iter_scene_batches(tmp_path / "t.parquet"))


def test_files_of_ours_with_other_schemas_do_not_go_together(tmp_path: Path) -> None:
    for kind in ("angle", "euclidean"):
        schema = rf.Schema([rf.Attribute("way", 1, kind)])
        scenes = Scenes(schema, np.zeros((1, 1)), *map(np.array, ([0], [0], [1])))
        scenes.to_parquet(tmp_path / "own" / f"{kind}.parquet")

    with pytest.raises(InputError, match="hold scenes of different schemas: read them one by one"):
        iter_scene_batches(tmp_path / "own")


@pytest.mark.parametrize("ids", [[1, 2, 1], ["a", "b", "a"]])
@pytest.mark.parametrize("batch_size", [1, 100])
def test_a_scene_that_comes_back_is_named(ids: list[Any], batch_size: int, tmp_path: Path) -> None:
    folder = write_parts(tmp_path / "parts", long_table([2, 1, 1], ids=ids), [3])

    with pytest.raises(
        InputError, match=f"scene {ids[0]!r} comes back in .*part-1.* sort by the scene column"
    ):
        list(iter_scene_batches(folder, batch_size=batch_size, **COLUMNS))


def test_ids_beyond_64_bits_are_text_in_every_batch(tmp_path: Path) -> None:
    table = long_table([1, 1]).set_column(0, "s", pa.array([7, 2**64 - 1], pa.uint64()))
    parquet.write_table(table, tmp_path / "t.parquet")
    batches = iter_scene_batches(tmp_path / "t.parquet", batch_size=1, **COLUMNS)

    assert [scenes.scene_ids.tolist() for scenes in batches] == [["7"], [str(2**64 - 1)]]


@pytest.mark.parametrize(
    ("files", "changes", "message"),
    [
        ({}, {}, "folder .* contains no Parquet files"),
        ({"a.parquet": long_table([1]).slice(1)}, {}, "has no rows: at least one scene is needed"),
        ({"a.parquet": long_table([1]), "b.csv": None}, {}, r"contains 'b\.csv': only folders of Parquet"),
        ({"a.parquet": long_table([1]), "b.parquet": None}, {}, r"b\.parquet is not a readable Parquet file"),
        (
            {"a.parquet": long_table([1]), "b.parquet": long_table([1]).drop_columns(["x"])},
            {},
            r"b\.parquet and .*a\.parquet differ in the column 'x'",
        ),
        (
            {"a.parquet": long_table([1]), "b.parquet": long_table([1], ids=["u"])},
            {},
            r"column 's' contains large_string in .*b\.parquet, but int64",
        ),
        ({"a.parquet": long_table([1])}, {"scene": "t"}, r"column 't' is missing from .*a\.parquet"),
        ({"a.parquet": long_table([1])}, {"label": "l"}, r"column 'l' is missing from .*a\.parquet"),
        ({"a.parquet": long_table([1])}, {"scene": None}, "name its columns with scene= and attributes="),
        ({"a.parquet": long_table([1])}, {"batch_size": 0}, "batch_size must be"),
    ],
)
def test_bad_sources_are_refused_before_anything_is_read(
    files: dict[str, pa.Table | None], changes: dict[str, Any], message: str, tmp_path: Path
) -> None:
    for name, table in files.items():
        if table is None:
            (tmp_path / name).touch()
        else:
            parquet.write_table(table, tmp_path / name)

    with pytest.raises(InputError, match=message):
        iter_scene_batches(tmp_path, **(COLUMNS | changes))


def test_categories_are_the_same_in_all_batches(tmp_path: Path) -> None:
    table = long_table([1, 1]).append_column("team", pa.array(["b", "a"]))
    parquet.write_table(table, tmp_path / "t.parquet")
    listed = rf.Attribute("team", kind="category", categories=["a", "b"])
    columns = COLUMNS | {"attributes": {listed: "team"}}
    batches = list(iter_scene_batches(tmp_path / "t.parquet", batch_size=1, **columns))

    assert [scenes.matrix.tolist() for scenes in batches] == [[[1.0]], [[0.0]]]
    assert {scenes.schema for scenes in batches} == {rf.Schema([listed], ["agent"])}
    columns["attributes"] = {rf.Attribute("team", kind="category"): "team"}
    with pytest.raises(InputError, match="categories of 'team' must be known before all rows are read"):
        iter_scene_batches(tmp_path / "t.parquet", **columns)


def test_a_pattern_must_match(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"pattern .*\*\.parquet contains no Parquet files"):
        iter_scene_batches(tmp_path / "*.parquet", **COLUMNS)
    with pytest.raises(InputError, match=r"file .*none\.parquet does not exist"):
        iter_scene_batches(tmp_path / "none.parquet", **COLUMNS)


@pytest.mark.parametrize(
    ("column", "values", "message"),
    [
        ("s", [5, 5, 6, None], r"row 1 lacks a scene id \(column 's'\) \(in .*t.parquet; .* its row 2\)"),
        ("x", [0.5, 1.5, np.inf, 0.5], r"'x' is infinite in scene 6, .*; rows are counted from its row 2\)"),
        ("good", [True, False, True, True], "'good' has the values True and False in scene 5"),
    ],
)
def test_bad_rows_are_located(column: str, values: list[Any], message: str, tmp_path: Path) -> None:
    table = long_table([2, 1, 1])
    table = table.set_column(table.column_names.index(column), column, pa.array(values))
    parquet.write_table(table, tmp_path / "t.parquet")

    with pytest.raises(InputError, match=message):
        list(iter_scene_batches(tmp_path / "t.parquet", label="good", batch_size=2, **COLUMNS))


def test_progress_is_reported_in_rows(tmp_path: Path) -> None:
    parquet.write_table(long_table([2, 1]), tmp_path / "t.parquet")
    heard: list[Stage] = []
    with listening(heard.append):
        list(iter_scene_batches(tmp_path / "t.parquet", batch_size=2, **COLUMNS))

    assert [str(stage) for stage in heard] == ["rows read: 2 of 3", "rows read: 3 of 3"]
