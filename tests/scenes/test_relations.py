"""Given relations between objects: every way to name them, and what becomes of them with the scenes."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest

from relforest.scenes import Attribute, Relation, Scenes, Schema, iter_scene_batches, sample_scenes
from relforest.scenes.parquet import to_table, write_table
from relforest.scenes.sampling import _together
from relforest.scenes.scene_table import read_scenes
from relforest.support.errors import InputError, ModelFormatError
from strategies import assert_same_scenes

PASSES = Relation("passes to", directed=True)
PAIRS = [(7, "a", "b"), (7, "b", "c"), (9, "a", "b")]


def frame(**columns: Any) -> pd.DataFrame:
    """Scene 7 of a, b and c, scene 8 of nothing, scene 9 of a and b."""
    table = {
        "scene": [7, 7, 9, 8, 7, 9],
        "object": ["b", "a", "b", None, "c", "a"],
        "x": [2.0, 1, 4, None, 3, 5],
    }
    return pd.DataFrame(table | columns)


def scenes_with(relations: dict[Any, object], **columns: Any) -> Scenes:
    return Scenes.from_frame(
        frame(**columns), scene="scene", object="object", attributes={"x": "x"}, relations=relations
    )


def related(scenes: Scenes, name: str) -> list[tuple[object, str, str]]:
    """Scene, object and related object of all pairs, sorted."""
    return sorted(
        (scenes.scene_ids[scene], scenes.object_ids[one], scenes.object_ids[other])
        for scene in range(len(scenes))
        for one, other in scenes.relations[name].tolist()
        if {one, other} <= set(scenes.objects(scene).tolist())
    )


def both(pairs: list[tuple[int, str, str]]) -> list[tuple[int, str, str]]:
    return sorted([*pairs, *((scene, other, one) for scene, one, other in pairs)])


@pytest.mark.parametrize(
    "pairs",
    [
        PAIRS,
        both(PAIRS),
        np.array(PAIRS, dtype=object),
        pd.DataFrame(PAIRS),
        pl.DataFrame(PAIRS, orient="row"),
        pa.table({"s": [7, 7, 9], "one": ["a", "c", "b"], "other": ["b", "b", "a"]}),
    ],
    ids=["list", "both orders", "array", "pandas", "polars", "pyarrow"],
)
def test_pairs_may_be_lists_and_tables(pairs: object) -> None:
    if isinstance(pairs, pd.DataFrame):
        pairs.columns = pd.Index(["s", "one", "other"])
    scenes = scenes_with({"touches": pairs})

    assert scenes.schema.relations == (Relation("touches"),)
    assert related(scenes, "touches") == both(PAIRS)
    assert_same_scenes(scenes, scenes_with({}).with_relations({"touches": pairs}))


@pytest.mark.parametrize(
    "column",
    [
        ["a;c", "b", "a", None, "b", "b"],
        ["c ; a", "", "", None, "", "b;"],
        [["a", "c"], ["b"], ["a"], None, ["b"], ["b"]],
        [["a", "c"], [], [], [], [], ["b"]],
    ],
    ids=["text", "half of it as text", "lists", "half of it as lists"],
)
def test_a_column_names_what_each_object_is_related_to(column: list[Any]) -> None:
    assert related(scenes_with({"touches": "near"}, near=column), "touches") == both(PAIRS)


def test_a_direction_is_kept_as_given() -> None:
    scenes = scenes_with({PASSES: "to", "touches": PAIRS}, to=[None, "b;c", None, None, "a", "b"])

    assert related(scenes, "passes to") == [(7, "a", "b"), (7, "a", "c"), (7, "c", "a"), (9, "a", "b")]
    assert scenes.schema.relations == (PASSES, Relation("touches"))
    assert scenes.schema.in_words == "attributes x (1); relations passes to (directed), touches"
    assert Schema.from_dict(scenes.schema.to_dict()) == scenes.schema


def test_ids_that_are_numbers_may_be_text_in_a_column() -> None:
    table = {"scene": [0, 0, 1], "object": [1, 2, 7], "x": [0.0, 1.0, 2.0]}
    for near in (["2", "1", ""], [2.0, None, None]):
        scenes = Scenes.from_frame(
            pd.DataFrame(table | {"near": near}),
            scene="scene",
            object="object",
            attributes={"x": "x"},
            relations={"touches": "near"},
        )
        assert scenes.relations["touches"].tolist() == [[0, 1], [1, 0]]


def test_pairs_go_with_the_objects(tmp_path: Path) -> None:
    scenes = scenes_with({"touches": PAIRS, PASSES: [(9, "b", "a")]})
    last = scenes.take([scenes.scene_ids.tolist().index(9)])

    assert related(last, "touches") == both(PAIRS[2:])
    assert last.compact().relations["touches"].tolist() == [[0, 1], [1, 0]]
    assert last.compact().relations["passes to"].tolist() == [[0, 1]]
    assert copy.deepcopy(last) == last
    assert scenes != scenes_with({"touches": PAIRS[1:], PASSES: [(9, "b", "a")]})
    derived = scenes.derive(Attribute("y"), lambda x: 2 * x, of="x").with_mean_object()
    assert related(derived, "touches") == both(PAIRS)
    assert Scenes.from_dicts(scenes.to_dicts(), scenes.schema).to_dicts() == scenes.to_dicts()
    scenes.to_parquet(tmp_path / "scenes.parquet")
    ((sampled, _),) = sample_scenes(tmp_path / "scenes.parquet", 1, 3, 0)
    assert_same_scenes(sampled, scenes)
    layout = read_scenes(tmp_path / "scenes.parquet", None, remedy="").layout
    assert layout.relations == ((Relation("touches"), "touches"), (PASSES, "passes to"))


def test_pairs_of_many_batches_come_together() -> None:
    many = [
        Scenes.from_dicts(
            [{"objects": [{"x": 0.0}, {"x": 1.0}], "relations": {"touches": [[0, 1]], "sees": [[1, 0]]}}]
        )
        for _ in range(3)
    ]
    together = _together(many)

    assert together.relations["touches"].tolist() == [[0, 1], [1, 0], [2, 3], [3, 2], [4, 5], [5, 4]]
    assert together.relations["sees"].tolist() == together.relations["touches"].tolist()


@pytest.mark.parametrize("batch_rows", [1, 2, 100])
def test_files_are_read_in_pieces(batch_rows: int, tmp_path: Path) -> None:
    whole = scenes_with({"touches": PAIRS, PASSES: [(9, "b", "a")]})
    whole.to_parquet(tmp_path / "own.parquet")
    foreign = frame(near=["a;c", "b", "a", None, "b", "b"]).sort_values("scene")
    foreign.to_parquet(tmp_path / "foreign.parquet")
    columns: Any = {
        "scene": "scene",
        "object": "object",
        "attributes": {"x": "x"},
        "relations": {"touches": "near"},
    }

    own = list(iter_scene_batches(tmp_path / "own.parquet", batch_size=batch_rows))
    read = list(iter_scene_batches(tmp_path / "foreign.parquet", batch_size=batch_rows, **columns))

    assert [pair for batch in own for pair in related(batch, "touches")] == both(PAIRS)
    assert [pair for batch in own for pair in related(batch, "passes to")] == [(9, "b", "a")]
    assert [pair for batch in read for pair in related(batch, "touches")] == both(PAIRS)
    assert_same_scenes(Scenes.from_parquet(tmp_path / "own.parquet"), whole)
    assert related(Scenes.from_parquet(tmp_path / "foreign.parquet", **columns), "touches") == both(PAIRS)


def test_a_changed_column_of_our_own_file_is_noticed(tmp_path: Path) -> None:
    scenes = scenes_with({"touches": PAIRS})
    scenes.to_parquet(tmp_path / "scenes.parquet")
    table = pa.parquet.read_table(tmp_path / "scenes.parquet")
    place = table.column_names.index("touches")
    lists = table["touches"].to_pylist()

    for wrong, message in (
        ([lists[1], lists[0], *lists[2:]], "column 'touches' was changed"),
        ([["z"], *lists[1:]], "column 'touches' was changed"),
    ):
        other = table.set_column(place, "touches", pa.array(wrong, table["touches"].type))
        write_table(tmp_path / "changed.parquet", other)
        with pytest.raises(ModelFormatError, match=message):
            Scenes.from_parquet(tmp_path / "changed.parquet")
    unsealed = to_table(scenes.parts).set_column(place, "touches", pa.array([["z"], *lists[1:]]))
    write_table(tmp_path / "changed.parquet", unsealed)
    with pytest.raises(
        ModelFormatError, match="is damaged: column 'touches' names 'z' in row 0, which is not"
    ):
        Scenes.from_parquet(tmp_path / "changed.parquet")


@pytest.mark.parametrize(
    ("relations", "columns", "message"),
    [
        (
            {"touches": [(7, "a", "a")]},
            {},
            "relation 'touches' of scene 7 names object 'a' and object 'a', the",
        ),
        ({"touches": [PAIRS[0], PAIRS[0]]}, {}, "names object 'a' and object 'b' twice: name each pair once"),
        ({"touches": [*PAIRS, (7, "b", "a")]}, {}, "names some pairs in both orders, but that of object"),
        ({PASSES: [(7, "b", "a"), (7, "b", "a")]}, {}, "names object 'b' and object 'a' twice"),
        (
            {"touches": [(7, "a", "z")]},
            {},
            "names 'z', which is not an object of scene 7 .it has 'b', 'a', 'c'",
        ),
        ({"touches": [(9, "a", "c")]}, {}, "names 'c', which is not an object of scene 9 .it has 'b', 'a'"),
        ({"touches": [(7, "a", None)]}, {}, "names None, which is not an object of scene 7"),
        ({"touches": [(3, "a", "b")]}, {}, "names the scene 3, which does not exist: name pairs by the ids"),
        ({"touches": [("a", "b")]}, {}, r"has the pair \('a', 'b'\): write \(scene, object, object\)"),
        ({"touches": [7]}, {}, "has the pair 7: write"),
        ({"touches": [(7, "a", 1.5)]}, {}, "column 'related object' contains 1.5 in row 0"),
        (
            {"touches": [(7, "a", "b"), ("x", "a", "b")]},
            {},
            "ids in the pairs of relation 'touches' mix types",
        ),
        (
            {"touches": 5},
            {},
            "pairs of relation 'touches' must be a list or table of .scene, object, object., got",
        ),
        ({"touches": pd.DataFrame({"a": [1], "b": [2]})}, {}, "must have three columns, .* it has a, b"),
        ([("touches", PAIRS)], {}, "relations must map names to pairs"),
        ({"x": PAIRS}, {}, "an attribute and a relation are named 'x': rename one"),
        ({"": PAIRS}, {}, "relation names must be non-empty"),
        (
            {"touches": PAIRS, Relation("touches", directed=True): PAIRS},
            {},
            "two relations are named 'touches'",
        ),
        ({3: PAIRS}, {}, "relation names must be non-empty printable strings, got 3"),
        ({"touches": "near"}, {}, "column 'near' is missing from the table"),
        (
            {"touches": "near"},
            {"near": ["z"] + [None] * 5},
            "column 'near' names 'z' in row 0, which is not an",
        ),
        ({"touches": "near"}, {"near": [None, None, "c", None, None, None]}, "is not an object of scene 9"),
        ({"touches": "near"}, {"near": [None, None, None, "a", None, None]}, "names 'a' in row 3, which is"),
        ({"touches": "near"}, {"near": ["b"] + [None] * 5}, "names object 'b' and object 'b', the same one"),
        ({"touches": "near"}, {"near": ["a;a"] + [None] * 5}, "names object 'b' and object 'a' twice"),
        (
            {"touches": "near"},
            {"near": ["a,c"] + [None] * 5},
            "names 'a,c' in row 0, .* separate them with ';'",
        ),
        ({"touches": "near"}, {"near": [[1.5]] + [None] * 5}, "column 'near' contains 1.5"),
    ],
)
def test_what_is_wrong_is_named(relations: Any, columns: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        scenes_with(relations, **columns)


def test_files_take_columns_and_columns_need_object_ids(tmp_path: Path) -> None:
    scenes_with({}).to_parquet(tmp_path / "scenes.parquet")
    with pytest.raises(InputError, match="relations of files are columns: name them"):
        Scenes.from_parquet(tmp_path / "scenes.parquet", relations={"touches": PAIRS})  # type: ignore[dict-item]
    with pytest.raises(InputError, match="relations contain object ids: name the column"):
        Scenes.from_frame(frame(), scene="scene", attributes={"x": "x"}, relations={"touches": "object"})
    with pytest.raises(InputError, match=r"a list or table of \(scene, object, object\), got str"):
        scenes_with({}).with_relations({"touches": "object"})
    with pytest.raises(InputError, match="two scenes have the same one: give them different ids"):
        scenes_with({}).take([0, 0]).with_relations({"touches": PAIRS})


@pytest.mark.parametrize(
    ("relations", "message"),
    [
        (
            {"touches": [["a", "z"]]},
            r"scene 7: 'touches' has \['a', 'z'\], which is not two objects of that sc",
        ),
        ({"touches": [["a"]]}, r"'touches' has \['a'\], which is not two"),
        ({"touches": ["ab"]}, "'touches' has 'ab', which is not two"),
        ({"touches": [[["a"], "b"]]}, "which is not two objects"),
        ({"touches": 3}, "scene 7: 'touches' must be a list of pairs of ids, got 3"),
        ({"touches": [["a", "a"]]}, "the same one: name two objects"),
        ([["a", "b"]], "the relations of scene 7 must map names to pairs of object ids"),
        ({"sees": [["a", "b"]]}, "scene 7 has the unknown relation 'sees': the schema has 'touches'"),
    ],
)
def test_records_are_checked(relations: Any, message: str) -> None:
    objects = [{"id": "a", "x": 0.0}, {"id": "b", "x": 1.0}]
    schema = Schema([Attribute("x")], relations=["touches"])
    with pytest.raises(InputError, match=message):
        Scenes.from_dicts([{"id": 7, "objects": objects, "relations": relations}], schema)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"touches": None}, "the array of relation 'touches' is missing from the observation"),
        (
            {"touches": np.zeros((2, 2))},
            r"the array 'touches' of a relation must be 0 or 1 for each two slots",
        ),
        ({"touches": np.full((1, 2, 2), 2)}, r"must be 0 or 1 .* got int64 \(1, 2, 2\)"),
        ({"touches": np.eye(2, dtype=np.int64)[None]}, "object 0 and object 0, the same one"),
    ],
)
def test_padded_relations_are_checked(changes: dict[str, Any], message: str) -> None:
    schema = Schema([Attribute("x")], relations=["touches"])
    arrays = {"mask": np.ones((1, 2), dtype=np.int8), "x": np.zeros((1, 2)), **changes}
    with pytest.raises(InputError, match=message):
        Scenes.from_padded({name: each for name, each in arrays.items() if each is not None}, schema=schema)


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ({"relations": {}}, "the relations of a schema must be a list"),
        ({"relations": [{"name": "touches"}]}, "not a relation"),
        ({"relations": [{"name": "", "directed": False}]}, "relation names must be non-empty"),
        (
            {"relations": [{"name": "touches", "directed": 1}]},
            "directed of relation 'touches' must be True or",
        ),
        ({"relations": [{"name": "x", "directed": False}]}, "an attribute and a relation are named 'x'"),
    ],
)
def test_documents_of_relations_are_checked(document: dict[str, Any], message: str) -> None:
    schema = Schema([Attribute("x")])
    assert "relations" not in schema.to_dict()
    with pytest.raises(ModelFormatError, match=message):
        Schema.from_dict(schema.to_dict() | document)
