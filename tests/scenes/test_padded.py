from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given

from relforest.scenes import Attribute, Scenes, Schema
from relforest.support.errors import InputError
from strategies import assert_same_scenes, scenes_batches

PLANE = Schema([Attribute("location", 2), Attribute("weight")], ["passer"])


def observation(**changes: Any) -> dict[str, Any]:
    """Two scenes of three slots: objects in slots 0 and 2 of the first, none in the second."""
    arrays = {
        "location": np.arange(12.0).reshape(2, 3, 2),
        "weight": np.array([[1.0, np.inf, 3.0], [9.0, 9.0, 9.0]]),
        "mask": np.array([[1, 0, 1], [0, 0, 0]], dtype=np.int8),
        "arguments": np.array([[2], [-1]]),
    }
    return arrays | changes


def test_masked_slots_are_left_out() -> None:
    scenes = Scenes.from_padded(observation(), schema=PLANE)

    assert scenes.counts.tolist() == [2, 0]
    assert scenes.matrix.tolist() == [[0, 1, 1], [4, 5, 3]]
    assert scenes.object_ids.tolist() == [0, 2]
    assert scenes.arguments.tolist() == [[1], [-1]]


def test_a_single_observation_is_one_scene() -> None:
    single = {name: array[0] for name, array in observation().items()}
    scenes = Scenes.from_padded(single, schema=PLANE)

    assert_same_scenes(scenes, Scenes.from_padded(observation(), schema=PLANE)[0])


def test_the_schema_follows_from_the_arrays_unless_given() -> None:
    arrays = observation()
    present, moved = arrays.pop("mask"), arrays.pop("arguments")
    scenes = Scenes.from_padded(arrays | {"present": present}, mask="present")

    assert scenes.schema == Schema([Attribute("location", 2), Attribute("weight")])
    named = Scenes.from_padded(arrays | {"mask": present, "moved": moved}, schema=PLANE, arguments="moved")
    assert named.arguments.tolist() == [[1], [-1]]


def pad(scenes: Scenes) -> dict[str, Any]:
    """Put the objects of each scene into its first slots, rubbish into the others."""
    n_slots = int(scenes.counts.max(initial=0)) + 1
    arrays = {
        attribute.name: np.full((len(scenes), n_slots, attribute.dim), -777.0)
        for attribute in scenes.schema.attributes
    }
    arguments = np.full(scenes.arguments.shape, -1)
    related = {name: np.zeros((len(scenes), n_slots, n_slots), dtype=np.int8) for name in scenes.relations}
    for position, count in enumerate(scenes.counts):
        rows = scenes.objects(position).tolist()
        for name, pairs in scenes.relations.items():
            for one, other in pairs.tolist():
                if one in rows and other in rows:
                    related[name][position, rows.index(one), rows.index(other)] = 1
            related[name][position, count:] = 1
        for name, values in scenes.values.items():
            arrays[name][position, :count] = values[rows]
        bound = scenes.arguments[position].tolist()
        arguments[position] = [-1 if row < 0 else rows.index(row) for row in bound]
    arrays |= related
    return {**arrays, "mask": np.arange(n_slots) < scenes.counts[:, np.newaxis], "arguments": arguments}


@given(scenes=scenes_batches(max_relations=2))
def test_padded_arrays_give_the_same_scenes_back(scenes: Scenes) -> None:
    found = Scenes.from_padded(pad(scenes), schema=scenes.schema)

    assert found.counts.tolist() == scenes.counts.tolist()
    for position in range(len(scenes)):
        wanted = scenes.objects(position).tolist()
        rows = found.objects(position)
        np.testing.assert_array_equal(found.matrix[rows], scenes.matrix[wanted])
        slots = [-1 if row < 0 else wanted.index(row) for row in scenes.arguments[position]]
        bound = found.arguments[position]
        assert np.where(bound < 0, -1, bound - found.starts[position]).tolist() == slots
        for name, pairs in scenes.relations.items():
            here = [pair for pair in found.relations[name].tolist() if set(pair) <= set(rows.tolist())]
            there = [
                [wanted.index(row) for row in pair] for pair in pairs.tolist() if set(pair) <= set(wanted)
            ]
            assert sorted(here) == sorted([[int(rows[place]) for place in pair] for pair in there])


@pytest.mark.parametrize(
    ("arrays", "schema", "message"),
    [
        (
            {"location": np.zeros((2, 3, 2))},
            None,
            "array 'mask' is missing from 'location': name it with mask=",
        ),
        (observation(mask=np.full((2, 3), 2)), PLANE, "mask 'mask' must be 0 or 1 for each slot"),
        (observation(mask=np.ones((2, 3, 1))), PLANE, r"mask .* got shape \(2, 3, 1\)"),
        (observation(), None, "'arguments' binds arguments of unknown names: pass schema="),
        (observation(weight=np.full((2, 3), "x")), PLANE, "array 'weight' must contain numbers"),
        (observation(weight=np.zeros((2, 4))), PLANE, r"'weight' .* 2 scenes of 3 slots, got shape \(2, 4\)"),
        (observation(weight=np.zeros(3)), PLANE, r"'weight' .* got shape \(3,\)"),
        (
            observation(color=np.zeros((2, 3))),
            PLANE,
            "'color' is not in the schema, which has 'location', 'w",
        ),
        (observation(weight=np.zeros((2, 3, 4))), PLANE, "'weight' has 4 components, but the dim is 1"),
        ({"mask": [[1]], "weight": [[1]]}, PLANE, "array of attribute 'location' is missing"),
        (
            {name: array for name, array in observation().items() if name != "arguments"},
            PLANE,
            "schema has the arguments passer, but array 'arguments' is missing",
        ),
        (observation(arguments=np.array([[2]])), PLANE, r"a slot number .* \(2, 1\), got int64 \(1, 1\)"),
        (observation(arguments=np.zeros((2, 1))), PLANE, "a slot number for each argument.* got float64"),
        (
            observation(arguments=np.array([[1], [-1]])),
            PLANE,
            "argument 'passer' of scene 0 is slot 1, which",
        ),
        (observation(arguments=np.array([[0], [3]])), PLANE, "argument 'passer' of scene 1 is slot 3"),
        (observation(arguments=np.array([[-2], [-1]])), PLANE, "argument 'passer' of scene 0 is slot -2"),
        (observation(location=np.full((2, 3, 2), np.inf)), PLANE, "infinite location"),
    ],
)
def test_arrays_that_are_no_observation_are_refused(
    arrays: dict[str, Any], schema: Schema | None, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        Scenes.from_padded(arrays, schema=schema)
