from __future__ import annotations

from decimal import Decimal
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.scenes import Attribute, Scenes, scene_values
from relforest.scenes.parquet import to_table
from relforest.support.errors import InputError
from strategies import assert_same_scenes, scenes_batches

LIBRARIES = {"pandas": pd.DataFrame, "polars": pl.DataFrame, "pyarrow": pa.table}
CONVERTERS = {"pandas": pa.Table.to_pandas, "polars": pl.from_arrow, "pyarrow": lambda table: table}

# Scene 7 has two scattered players, 9 one, and 8 none; player a of scene 7 looks 4 rad = 4 - 2 pi round.
PASSES: dict[str, list[Any]] = {
    "pass": [7, 9, 7, 8],
    "player": ["a", "b", "b", None],
    "x": [1.0, 2.0, None, None],
    "y": [1.5, 2.5, 3.5, None],
    "theta": [4.0, 0.0, 0.5, None],
    "passer": ["b", None, "b", None],
}
KEYWORDS: dict[str, Any] = {
    "scene": "pass",
    "object": "player",
    "attributes": {"location": ["x", "y"], "orientation": "theta"},
    "arguments": ["passer"],
}


def read(columns: dict[str, Any] | None = None, **keywords: Any) -> Scenes:
    """Read the passes with some columns and keywords changed."""
    return Scenes.from_frame(pd.DataFrame(PASSES | (columns or {})), **(KEYWORDS | keywords))


@pytest.mark.parametrize("library", LIBRARIES)
def test_a_long_table_becomes_scenes(library: str) -> None:
    scenes = Scenes.from_frame(LIBRARIES[library](PASSES), **KEYWORDS)

    assert scenes.schema.names == ("location", "orientation")
    assert scenes.schema.parameters == ("passer",)
    assert scenes.scene_ids.tolist() == [7, 9, 8]
    assert scenes.counts.tolist() == [2, 1, 0]
    assert scenes.object_ids.tolist() == ["a", "b", "b"]
    np.testing.assert_allclose(scenes.matrix, [[1, 1.5, 4 - 2 * np.pi], [np.nan, 3.5, 0.5], [2, 2.5, 0]])
    assert scenes.arguments.tolist() == [[1], [-1], [-1]]


@pytest.mark.parametrize("library", LIBRARIES)
def test_integer_ids_survive_the_floats_that_nulls_make(library: str) -> None:
    columns = {"player": [10, 11, 11, None], "passer": [11, None, 11, None]}
    scenes = Scenes.from_frame(LIBRARIES[library](PASSES | columns), **KEYWORDS)

    assert scenes.object_ids.tolist() == [10, 11, 11]
    assert scenes.object_ids.dtype == np.int64
    assert scenes.arguments.tolist() == [[1], [-1], [-1]]


def test_objects_without_ids_are_numbered_within_their_scene() -> None:
    frame = pd.DataFrame({"pass": [7, 9, 7], "x": [1.0, 2.0, 3.0]})
    scenes = Scenes.from_frame(frame, scene="pass", attributes={"abscissa": "x"})

    assert scenes.object_ids.tolist() == [0, 1, 0]
    assert scenes.matrix[:, 0].tolist() == [1.0, 3.0, 2.0]


def test_a_plain_name_gets_the_defaults_and_an_attribute_is_kept_as_it_is() -> None:
    heading = Attribute("heading", kind="angle", operations=["difference"])
    scenes = read(attributes={"location": ["x", "y"], heading: "theta", "x again": ("x",)})

    assert scenes.schema.attributes == (Attribute("location", 2), heading, Attribute("x again"))
    np.testing.assert_allclose(scenes.values["heading"][0], [4 - 2 * np.pi])


@pytest.mark.parametrize(
    "values",
    [
        pd.array([1, 2, None, None], dtype="Int64"),
        np.array([1, 2, np.nan, np.nan], dtype=np.float32),
        np.array([1, 2.0, None, None], dtype=object),
        np.array([Decimal(1), 2, None, np.nan], dtype=object),
        pd.Categorical([1, 2, None, None]),
    ],
)
def test_numbers_may_come_in_many_types(values: Any) -> None:
    np.testing.assert_array_equal(read({"x": values}).values["location"][:, 0], [1, np.nan, 2])


def test_booleans_are_zero_and_one_and_big_integers_are_rounded() -> None:
    frame = pl.DataFrame({"s": [1, 1], "b": [True, None], "i": [2**60 + 1, 1], "d": [Decimal("0.5"), None]})
    scenes = Scenes.from_frame(frame, scene="s", attributes={"all": ["b", "i", "d"]})

    np.testing.assert_array_equal(scenes.matrix, [[1, 2.0**60, 0.5], [np.nan, 1, np.nan]])


def test_columns_of_nothing_but_nulls_are_undefined() -> None:
    frame = pl.DataFrame({"s": ["u", "u"], "o": [1, 2], "x": [None, None], "p": [None, None]})
    scenes = Scenes.from_frame(frame, scene="s", object="o", attributes={"x": "x"}, arguments=["p"])

    assert np.isnan(scenes.matrix).all()
    assert scenes.arguments.tolist() == [[-1]]


@pytest.mark.parametrize("dtype", ["category", "string", object])
def test_strings_may_come_in_many_types(dtype: Any) -> None:
    frame = (
        pd.DataFrame(PASSES).astype({"player": dtype, "passer": dtype, "pass": str}).astype({"pass": dtype})
    )
    scenes = Scenes.from_frame(frame, **KEYWORDS)

    assert scenes.scene_ids.tolist() == ["7", "9", "8"]
    assert scenes.object_ids.tolist() == ["a", "b", "b"]
    assert scenes.arguments.tolist() == [[1], [-1], [-1]]


def test_integers_in_an_argument_column_find_string_ids() -> None:
    # As a CSV reader leaves them when no argument happens to be "p".
    columns = {"player": ["7", "p", "p", None], "passer": pd.array([7, None, 7, None], dtype="Int64")}

    assert read(columns).arguments.tolist() == [[0], [-1], [-1]]


def test_string_arguments_find_integer_ids_written_alike() -> None:
    columns = {"player": [7, 8, 9, None], "passer": ["9", None, "9", None]}
    assert read(columns).arguments.tolist() == [[1], [-1], [-1]]

    with pytest.raises(InputError, match=r"argument 'passer' of scene 7 is '09', .* \(it has 7, 9\)"):
        read(columns | {"passer": ["09", None, "09", None]})


@pytest.mark.parametrize(
    ("players", "passer"),
    [(["7", "8", "9"], "9.0"), (["7.0", "8.0", "9.0"], "9"), ([7, 8, 9], "9.0")],
)
def test_a_fraction_of_zero_that_stands_everywhere_does_not_matter(players: list[Any], passer: str) -> None:
    # As pandas writes integers among which one is missing.
    columns = {"pass": [7, 7, 7, 8], "player": [*players, None], "passer": [*[passer] * 3, None]}
    assert read(columns).arguments.tolist() == [[2], [-1]]


def test_a_fraction_of_zero_that_stands_somewhere_does() -> None:
    columns = {"pass": [7, 7, 7, 8], "player": ["9", "9.0", "8", None], "passer": [*["9.0"] * 3, None]}
    assert read(columns).arguments.tolist() == [[1], [-1]]


def test_row_order_decides_only_the_order_of_scenes_and_objects() -> None:
    frame = pd.DataFrame(PASSES)
    scenes = Scenes.from_frame(frame.iloc[::-1], **KEYWORDS)

    assert scenes.scene_ids.tolist() == [8, 7, 9]
    assert scenes.object_ids[scenes.objects(1)].tolist() == ["b", "a"]
    assert scenes.object_ids[scenes.arguments[1]].tolist() == ["b"]


def as_sets(scenes: Scenes) -> dict[Any, tuple[Any, ...]]:
    """Return objects and arguments of each scene without any order."""
    result = {}
    for position, name in enumerate(scenes.scene_ids.tolist()):
        rows = scenes.objects(position)
        objects = {(scenes.object_ids[row], scenes.matrix[row].tobytes()) for row in rows}
        bound = [None if row < 0 else scenes.object_ids[row] for row in scenes.arguments[position]]
        result[name] = (frozenset(objects), *bound)
    return result


def keywords_for(scenes: Scenes) -> dict[str, Any]:
    """Return the keywords that read the long table of scenes."""
    names = iter(to_table(scenes.parts).column_names)
    scene, object_name = next(names), next(names)
    attributes = {
        attribute: [next(names) for _ in range(attribute.dim)] for attribute in scenes.schema.attributes
    }
    arguments = [next(names) for _ in scenes.schema.parameters]
    relations = {relation: next(names) for relation in scenes.schema.relations}
    ids = {"scene": scene, "object": object_name, "arguments": arguments}
    return ids | {"attributes": attributes, "relations": relations}


@pytest.mark.parametrize("library", CONVERTERS)
@given(scenes=scenes_batches(shared=False, max_relations=2))
def test_frames_of_every_library_give_the_same_scenes_back(library: str, scenes: Scenes) -> None:
    frame = CONVERTERS[library](to_table(scenes.parts))

    assert_same_scenes(Scenes.from_frame(frame, **keywords_for(scenes)), scenes)


@given(scenes=scenes_batches(max_relations=2), data=st.data())
def test_shuffled_rows_give_the_same_sets_of_objects(scenes: Scenes, data: st.DataObject) -> None:
    table = to_table(scenes.parts)
    order = data.draw(st.permutations(range(len(table))))
    shuffled = Scenes.from_frame(table.take(pa.array(order)), **keywords_for(scenes))

    assert as_sets(shuffled) == as_sets(scenes)


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (
            {"x": ["1", "2", "3m", None]},
            "column 'x' contains '3m' in scene 7, object 'b', which is not a nu",
        ),
        (
            {"x": [None, "far", 3.0, None]},
            r"column 'x' contains 'far' in scene 9, object 'b', which is not a num",
        ),
        ({"x": [1.0, 2.0, [3.0], None]}, r"column 'x' contains \[3.0\] in scene 7, object 'b'"),
        ({"x": [1.0, -np.inf, 3.0, None]}, "column 'x' is infinite in scene 9, object 'b': use null or NaN"),
        ({"theta": [1.0, 1.0, np.inf, None]}, "column 'theta' is infinite in scene 7, object 'b'"),
        ({"pass": [7, 9, None, 8]}, r"row 2 lacks a scene id \(column 'pass'\)"),
        (
            {"pass": [7, 9.5, 7, 8]},
            "column 'pass' contains 9.5 in row 1, but ids are whole numbers or strings",
        ),
        ({"pass": [7, "9", 7, 8]}, "column 'pass' mixes types"),
        (
            {"pass": [True, False, True, False]},
            "'pass' contains bool, but ids are integers, strings, dates or",
        ),
        (
            {"player": pd.to_timedelta([1, 2, 3, 4])},
            "'player' contains duration.*convert the column to strings",
        ),
        ({"player": ["a", "b", "a", None]}, "object 'a' occurs twice in scene 7"),
        ({"player": ["a", None, "b", None]}, r"row 1 of scene 9 lacks an object id: give the object an id"),
        ({"pass": [7, 9, 7, 7]}, "row 3 of scene 7 lacks an object id"),
        ({"passer": ["b", None, "a", None]}, "'passer' has the values 'b' and 'a' in scene 7"),
        ({"passer": ["b", None, None, None]}, "'passer' has the values 'b' and None in scene 7"),
        ({"passer": ["c", None, "c", None]}, r"'passer' of scene 7 is 'c', .* \(it has 'a', 'b'\)"),
        ({"passer": [None, "a", None, None]}, r"'passer' of scene 9 is 'a', .* \(it has 'b'\)"),
        ({"passer": [None, None, None, "a"]}, r"'passer' of scene 8 is 'a', .* \(it has none\)"),
        (
            {"player": [1, 2, 2, None]},
            "argument 'passer' of scene 7 is 'b', .*it has 1, 2",
        ),
    ],
)
def test_values_that_cannot_be_used_are_named(columns: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        read(columns)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"scene": "match"}, "column 'match' is missing from the table, which has 'pass', 'player', 'x'"),
        ({"object": "name"}, "column 'name' is missing from"),
        ({"attributes": {"location": ["x", "z"]}}, "column 'z' is missing from"),
        ({"arguments": ["receiver"]}, "column 'receiver' is missing from"),
        ({"arguments": "passer"}, r"arguments must be a sequence of column names.* write \['passer'\]"),
        ({"arguments": ["passer", "passer"]}, "two arguments are named 'passer'"),
        ({"object": None}, "arguments contain object ids: name the column of object ids with object="),
        ({"scene": 3}, "column names must be strings, got 3"),
        ({"attributes": {}}, "must map at least one attribute to its columns"),
        ({"attributes": ["x"]}, r"must map at least one attribute to its columns, .* got \['x'\]"),
        ({"attributes": {"location": []}}, "attribute 'location' is not mapped to a column"),
        ({"attributes": {"location": None}}, "attribute 'location' is not mapped to a column"),
        ({"attributes": {Attribute("x"): "x", "x": "y"}}, "two attributes are named 'x'"),
        ({"attributes": {Attribute("x", 2): "x"}}, "'x' has dim 2, but is mapped to 1 column"),
        ({"attributes": {3: "x"}}, "attribute names must be non-empty printable strings, got 3"),
    ],
)
def test_keywords_that_do_not_fit_the_table_are_named(keywords: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        read(**keywords)


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        (pd.DataFrame(PASSES).head(0), "table has no rows"),
        (pl.DataFrame(PASSES).lazy(), "in memory, got polars.*LazyFrame"),
        ([1, 2], "expected a pandas, polars or pyarrow table"),
        (None, "got builtins.NoneType"),
        (
            pd.DataFrame([[1, 2.0]], columns=["x", "x"]),
            "column 'pass' is missing from the table, which has 'x', 'x'",
        ),
        (pd.DataFrame([[1] * 7], columns=[*PASSES, "x"]), "2 columns of the table are named 'x'"),
        (pl.DataFrame({"x": []}), "column 'pass' is missing from the table, which has 'x'"),
        (pa.table({"x": []}), "column 'pass' is missing from the table, which has 'x'"),
    ],
)
def test_things_that_are_no_table_of_scenes_are_refused(frame: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Scenes.from_frame(frame, **KEYWORDS)


def test_a_value_in_a_scene_without_object_ids_is_named_by_its_row() -> None:
    with pytest.raises(InputError, match=r"column 'x' is infinite in row 1 \(scene 9\)"):
        read({"x": [1.0, np.inf, 1.0, 1.0]}, object=None, arguments=[])


def test_a_long_list_of_objects_is_cut_in_messages() -> None:
    frame = pd.DataFrame({"s": [1] * 11, "o": range(11), "x": [0.0] * 11, "p": [99] * 11})
    with pytest.raises(InputError, match=r"\(it has 0, 1, 2, 3, 4, 5, 6, 7 and 3 more\)"):
        Scenes.from_frame(frame, scene="s", object="o", attributes={"x": "x"}, arguments=["p"])


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize(
    ("labels", "expected"),
    [
        ([1, 0, 1, 1], [1, 0, 1]),
        ([True, False, True, True], [True, False, True]),
        (["yes", "no", "yes", "yes"], ["yes", "no", "yes"]),
        (["1", "0", "1", "1"], [1, 0, 1]),
        (["1", "01", "1", "1"], ["1", "01", "1"]),
        ([0.5, 1.5, 0.5, 2.5], [0.5, 1.5, 2.5]),
    ],
)
def test_a_value_per_scene_stands_in_the_order_of_the_scenes(
    library: str, labels: list[Any], expected: list[Any]
) -> None:
    frame = LIBRARIES[library](PASSES | {"label": labels})

    assert scene_values(frame, "label", scene="pass").tolist() == expected


@pytest.mark.parametrize(
    ("labels", "message"),
    [
        ([1, 0, 0, 1], "'label' has the values 1 and 0 in scene 7: it must be the same in all rows"),
        ([1, None, 1, 1], "column 'label' lacks a value in scene 9"),
        (["yes", 1, "yes", "yes"], "column 'label' contains mixed types"),
        (pd.to_datetime(["2020"] * 4), "'label' contains timestamp.* must contain numbers, booleans or str"),
    ],
)
def test_a_value_that_is_not_one_per_scene_is_named(labels: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        scene_values(pd.DataFrame(PASSES | {"label": labels}), "label", scene="pass")
