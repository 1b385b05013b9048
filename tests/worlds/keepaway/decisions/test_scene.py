from __future__ import annotations

import math

import numpy as np
import pytest

from relforest.scenes import Scenes
from relforest.smdp import Action, check_decision
from relforest.worlds.keepaway.decisions.scene import (
    ACTION_TYPES,
    NOBODY,
    SCHEMA,
    attributes_of,
    blank_scenes,
    decision,
    decisions,
    describe,
    location_of,
    objects,
)


def test_the_schema_is_that_of_the_benchmark() -> None:
    assert [(attribute.name, attribute.dim, attribute.kind) for attribute in SCHEMA.attributes] == [
        ("location", 2, "euclidean"),
        ("orientation", 1, "angle"),
        ("color", 3, "euclidean"),
    ]
    assert SCHEMA.parameters == ()
    assert [(action_type.name, action_type.parameters) for action_type in ACTION_TYPES] == [
        ("hold", ("holder",)),
        ("pass", ("holder", "receiver")),
    ]


def test_keepers_are_yellow_and_takers_cyan() -> None:
    assert objects(2, 1)[:, 3:].tolist() == [[1, 1, 0], [1, 1, 0], [0, 1, 1]]


def test_players_are_described_in_metres_and_radians() -> None:
    matrix = objects(2, 1)
    colors = matrix[:, 3:].copy()
    players = np.array([(1.0, 2.0, 0.1, 0.2, 90.0), (-3.0, 0.5, 0, 0, -180.0), (0.0, 0.0, 0, 0, 180.0)])
    describe(players, matrix)
    assert matrix[:, :2].tolist() == [[1.0, 2.0], [-3.0, 0.5], [0.0, 0.0]]
    assert matrix[:, 2].tolist() == [math.pi / 2, math.pi, math.pi]
    assert matrix[:, 3:].tolist() == colors.tolist()


def test_locations_are_a_view_and_observations_are_new_arrays() -> None:
    matrix = objects(2, 1)
    location_of(matrix)[0] = 5.0
    seen = attributes_of(matrix)
    assert [(name, array.shape) for name, array in seen.items()] == [
        ("location", (3, 2)),
        ("orientation", (3, 1)),
        ("color", (3, 3)),
    ]
    assert seen["location"][0].tolist() == [5.0, 5.0]
    seen["location"][0] = 0.0
    assert matrix[0, 0] == 5.0


def test_blank_scenes_take_the_objects_of_a_batch() -> None:
    matrices = np.stack([objects(2, 1), objects(2, 1) + 1.0])
    scenes = blank_scenes(2, 2, 1).with_matrix(matrices.reshape(6, 6))
    assert isinstance(scenes, Scenes)
    assert len(scenes) == 2
    np.testing.assert_array_equal(scenes.matrix[scenes.objects(1)], matrices[1])
    assert scenes.object_ids[scenes.objects(1)].tolist() == ["keeper_0", "keeper_1", "taker_0"]


def test_a_decision_is_to_hold_or_to_pass_to_each_teammate() -> None:
    found = decision(objects(3, 2), 1, np.array([2, 0]))
    check_decision(found, SCHEMA, ACTION_TYPES)
    assert [found.action(i) for i in range(3)] == [Action(0, (1,)), Action(1, (1, 2)), Action(1, (1, 0))]
    assert found.indices.tolist() == [0, 1, 2]


def test_two_keepers_have_one_pass() -> None:
    found = decision(objects(2, 1), 0, np.array([1]))
    check_decision(found, SCHEMA, ACTION_TYPES)
    assert [found.action(i) for i in range(2)] == [Action(0, (0,)), Action(1, (0, 1))]


def test_decisions_of_several_games_are_those_of_each() -> None:
    matrices = np.stack([objects(3, 2) + i for i in range(3)])
    actors, receivers = np.array([1, NOBODY, 2]), np.array([[2, 0], [0, 0], [0, 1]])
    found = decisions(matrices, actors, receivers)
    assert found.n_actions.tolist() == [3, 0, 3]
    for each, *state in zip(found, matrices, actors, receivers, strict=True):
        check_decision(each, SCHEMA, ACTION_TYPES)
        alone = decision(*state)
        for name in ("objects", "types", "arguments", "indices"):
            np.testing.assert_array_equal(getattr(each, name), getattr(alone, name))


def test_nobody_has_no_action() -> None:
    found = decision(objects(3, 2), NOBODY, np.array([2, 0]))
    check_decision(found, SCHEMA, ACTION_TYPES)
    assert len(found) == 0
    with pytest.raises(ValueError, match="one of the 0 available actions"):
        found.action(0)
