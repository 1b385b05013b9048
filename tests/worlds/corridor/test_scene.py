from __future__ import annotations

from dataclasses import fields

import numpy as np

from relforest.scenes import Scenes
from relforest.smdp import Action, check_decision
from relforest.worlds.corridor.dynamics import ACTION_TYPES
from relforest.worlds.corridor.scene import SCHEMA, decision, scene
from relforest.worlds.corridor.state import CorridorState


def test_the_schema_is_one_location() -> None:
    assert [(attribute.name, attribute.dim, attribute.kind) for attribute in SCHEMA.attributes] == [
        ("location", 1, "euclidean")
    ]
    assert SCHEMA.parameters == ()


def test_the_scene_holds_the_agent() -> None:
    scenes = scene(CorridorState(0.25, 3))
    assert isinstance(scenes, Scenes)
    assert len(scenes) == 1
    assert scenes.schema == SCHEMA
    assert scenes.object_ids.tolist() == ["agent"]
    assert scenes.objects(0).tolist() == [0]
    np.testing.assert_array_equal(scenes.values["location"], [[0.25]])


def test_the_scene_is_the_one_that_the_checked_constructor_makes() -> None:
    made = scene(CorridorState(0.25))
    checked = Scenes(
        SCHEMA,
        np.array([[0.25]]),
        np.array([0]),
        np.array([0]),
        np.array([1]),
        object_ids=np.array(["agent"]),
    )
    for field in fields(Scenes):
        ours, theirs = getattr(made, field.name), getattr(checked, field.name)
        assert type(ours) is type(theirs)
        if isinstance(ours, np.ndarray):
            np.testing.assert_array_equal(ours, theirs)
            assert ours.dtype == theirs.dtype
            assert not ours.flags.writeable


def test_scenes_of_two_states_are_independent() -> None:
    first, second = scene(CorridorState(0.25)), scene(CorridorState(0.75))
    assert first.matrix[0, 0] == 0.25
    assert second.matrix[0, 0] == 0.75


def test_both_actions_are_always_available() -> None:
    for x in (0.0, 0.5, 1.0):
        choices = decision(CorridorState(x))
        check_decision(choices, SCHEMA, ACTION_TYPES)
        assert [choices.action(position) for position in range(len(choices))] == [Action(0), Action(1)]
        assert choices.indices.tolist() == [0, 1]
        assert choices.objects.tolist() == [[x]]
