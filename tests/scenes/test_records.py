from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given

from relforest.scenes import Attribute, Scenes, Schema
from relforest.support.errors import InputError
from strategies import assert_same_scenes, scenes_batches

RECORDS: list[dict[str, Any]] = [
    {
        "id": "first",
        "objects": [
            {"id": "a", "location": [1.0, 2.0], "orientation": 4.0},
            {"id": "b", "location": [3, None]},
        ],
        "arguments": {"passer": "b"},
    },
    {"id": "second", "objects": []},
    {"id": "third", "objects": [{"id": "a", "location": None, "weight": 2}], "arguments": {"passer": None}},
]


def test_dictionaries_become_scenes() -> None:
    scenes = Scenes.from_dicts(RECORDS)

    assert scenes.schema == Schema(
        [Attribute("location", 2), Attribute("orientation"), Attribute("weight")], ["passer"]
    )
    assert scenes.scene_ids.tolist() == ["first", "second", "third"]
    assert scenes.counts.tolist() == [2, 0, 1]
    np.testing.assert_allclose(
        scenes.matrix,
        [[1, 2, 4 - 2 * np.pi, np.nan], [3, np.nan, np.nan, np.nan], [np.nan, np.nan, np.nan, 2]],
    )
    assert scenes.arguments.tolist() == [[1], [-1], [-1]]


def test_ids_may_be_left_out_and_arguments_are_positions_then() -> None:
    objects = [{"x": 1.0}, {"x": np.array([2.0])}, {"x": np.float32(3)}]
    scenes = Scenes.from_dicts([{"objects": objects, "arguments": {"moved": 2}}, {"objects": objects[:1]}])

    assert scenes.scene_ids.tolist() == [0, 1]
    assert scenes.object_ids.tolist() == [0, 1, 2, 0]
    assert scenes.matrix[:, 0].tolist() == [1, 2, 3, 1]
    assert scenes.arguments.tolist() == [[2], [-1]]


def test_a_given_schema_decides_attributes_and_arguments() -> None:
    schema = Schema([Attribute("weight"), Attribute("location", 2)], ["receiver", "passer"])
    scenes = Scenes.from_dicts([{"objects": [{"location": (1, 2)}], "arguments": {"passer": 0}}], schema)

    np.testing.assert_array_equal(scenes.matrix, [[np.nan, 1, 2]])
    assert scenes.arguments.tolist() == [[-1, 0]]


def test_written_dictionaries_are_plain_json() -> None:
    expected = [
        {
            "id": "first",
            "objects": [
                {"id": "a", "location": [1.0, 2.0], "orientation": 4.0 - 2 * np.pi},
                {"id": "b", "location": [3.0, None]},
            ],
            "arguments": {"passer": "b"},
        },
        {"id": "second", "objects": [], "arguments": {"passer": None}},
        {"id": "third", "objects": [{"id": "a", "weight": 2.0}], "arguments": {"passer": None}},
    ]

    assert json.loads(json.dumps(Scenes.from_dicts(RECORDS).to_dicts())) == expected


@given(scenes=scenes_batches(max_relations=2))
def test_dictionaries_give_the_same_scenes_back(scenes: Scenes) -> None:
    documents = json.loads(json.dumps(scenes.to_dicts()))

    assert_same_scenes(Scenes.from_dicts(documents, scenes.schema), scenes, same_rows=False)


def scene(*objects: Any, **more: Any) -> dict[str, Any]:
    return {"objects": list(objects)} | more


@pytest.mark.parametrize(
    ("records", "message"),
    [
        ([], "list of scenes is empty"),
        (3, "expected a list with one dictionary per scene, got int"),
        ({"objects": []}, "expected a list with one dictionary per scene, got dict"),
        (["scene"], "scene number 0 must be a dictionary with a list of 'objects', got 'scene'"),
        ([scene({"x": 1}), {"id": 3}], "scene number 1 must be a dictionary with a list of 'objects'"),
        ([scene({"x": 1}, label=1)], "scene number 0 has the key 'label': known are id, objects, arguments"),
        ([scene(3)], "scene 0 has the object 3: an object is a dictionary of attributes"),
        ([scene({"x": 1}, id=1), scene()], "some scenes have an 'id' and some do not"),
        ([scene({"x": 1, "id": 1}, {"x": 1})], "some objects have an 'id' and some do not"),
        ([scene({"x": 1}, id=1), scene(id="a")], "scene ids mix integers and strings"),
        ([scene({"x": 1, "id": [1]})], r"object ids must be integers or strings, got \[1\]"),
        ([scene({"x": 1, "id": "a"}, {"x": 1, "id": "a"}, id="s")], "object 'a' occurs twice in scene 's'"),
        ([scene({"x": 1}, {"x": [1, 2]})], "scene 0, object 1: 'x' has 2 components, but its dim is 1"),
        ([scene({"x": []})], "scene 0, object 0: 'x' has 0 components, but its dim is 1"),
        ([scene({"x": [1, 2], "id": 7}, {"x": 1, "id": 9}, id=5)], "scene 5, object 9: 'x' has 1 comp"),
        ([scene({"x": "far"})], "scene 0, object 0: 'x' is 'far', which is not a number"),
        ([scene({"x": [1, [2]]})], r"scene 0, object 0: 'x' is \[2\], which is not a number"),
        ([scene({"x": [1, -np.inf]})], "scene 0, object 0: 'x' is infinite: use None"),
        (
            [scene({"x": None})],
            "attribute 'x' is undefined in all scenes, so its dim is unknown: pass schema=",
        ),
        ([scene()], "the objects lack attributes, so the schema is unknown: pass schema="),
        ([scene({"x": 1}, arguments=["a"])], "arguments of scene 0 must map names to object ids"),
        ([scene({"x": 1}, arguments={"p": 1})], r"argument 'p' of scene 0 is 1, .* \(it has 0\)"),
        ([scene({"x": 1}, arguments={"p": False})], "argument 'p' of scene 0 is False"),
        ([scene({"x": 1}, arguments={"p": [0]})], r"argument 'p' of scene 0 is \[0\]"),
        ([scene({"x": 1}), scene(arguments={"p": 0})], r"argument 'p' of scene 1 is 0, .* \(it has none\)"),
    ],
)
def test_dictionaries_that_are_no_scenes_are_refused(records: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Scenes.from_dicts(records)


@pytest.mark.parametrize(
    ("record", "message"),
    [
        (scene({"colour": 1}), "scene 0, object 0 has the unknown attribute 'colour': the schema has 'x'"),
        (scene(arguments={"q": None}), "scene 0 has the unknown argument 'q': the schema has 'p'"),
    ],
)
def test_names_outside_a_given_schema_are_refused(record: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Scenes.from_dicts([record], Schema([Attribute("x")], ["p"]))
