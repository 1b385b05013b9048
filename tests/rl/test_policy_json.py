from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from relforest.rl.learner import Knowledge, RPILearner
from relforest.rl.policy_json import POLICY, slugs, tree_name
from relforest.rl.saved_policy import read_policy
from relforest.rl.settings import RPISettings
from relforest.rl.value import ValueFunction
from relforest.runs.learner import Run
from relforest.runs.store import CHECKPOINT, RunStore
from relforest.smdp import ActionType
from relforest.support.errors import ModelFormatError
from rl.small_worlds import ACTION_TYPES, PICK_SCHEMA, SCHEMA, Picking, beside, near

NAMES = (("0001-wait-1.json",), ("0001-pick-1.json", "0002-pick-1.json"))


def a_policy() -> ValueFunction:
    forests = ((near(SCHEMA),), (near(PICK_SCHEMA), beside()))
    weights = (np.arange(7) / 3, np.arange(20) / 7)
    return ValueFunction(SCHEMA, ACTION_TYPES, "densities+bits", forests, weights)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    learner = RPILearner(Picking(), RPISettings(), np.random.SeedSequence(0), 1, 1)
    row = {"iteration": 0, "test_reward": 1.0, "train_reward": None, "trees": 3, "leaves": 6}
    RunStore(tmp_path, learner).write(Run(Knowledge(a_policy(), NAMES, ()), (row,)))
    return tmp_path


def edit(folder: Path, **changes: Any) -> None:
    document = json.loads((folder / CHECKPOINT).read_text("utf-8"))
    document["policy"] |= changes
    (folder / CHECKPOINT).write_text(json.dumps(document), "utf-8")


def actions_of(folder: Path) -> list[dict[str, Any]]:
    actions: list[dict[str, Any]] = json.loads((folder / POLICY).read_text("utf-8"))["actions"]
    return actions


def test_a_policy_survives_its_files(folder: Path) -> None:
    found, expected = read_policy(folder), a_policy()
    assert isinstance(found, ValueFunction)
    assert (found.schema, found.action_types, found.features) == (SCHEMA, ACTION_TYPES, "densities+bits")
    for ours, theirs in zip(found.weights, expected.weights, strict=True):
        np.testing.assert_array_equal(ours, theirs)
    for mine, yours in zip(found.forests, expected.forests, strict=True):
        assert [tree.to_dict() for tree in mine] == [tree.to_dict() for tree in yours]


def test_the_policy_is_readable(folder: Path) -> None:
    assert actions_of(folder)[1] == {
        "name": "pick",
        "parameters": ["thing"],
        "weights": "pick",
        "trees": ["0001-pick-1.json", "0002-pick-1.json"],
    }


@pytest.mark.parametrize("name", [CHECKPOINT, "trees/0001-pick-1.json"])
@pytest.mark.parametrize("content", [None, b"", b"\xff\xfe{}", b'{"format": "x"}', b"[[[["])
def test_missing_and_damaged_files_are_named(folder: Path, name: str, content: bytes | None) -> None:
    path = folder / name
    path.unlink()
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(ModelFormatError, match=path.name):
        read_policy(folder)


def test_trees_that_are_none_are_named(folder: Path) -> None:
    path = folder / "trees" / "0002-pick-1.json"
    path.write_text(json.dumps(json.loads(path.read_text("utf-8")) | {"nodes": []}), "utf-8")
    with pytest.raises(ModelFormatError, match=r"0002-pick-1\.json is not a valid tree"):
        read_policy(folder)


@pytest.mark.parametrize(
    "changes",
    [
        {"schema": {}},
        {"features": "leaves"},
        {"features": ["bits"]},
        {"actions": 3},
        {"actions": [1]},
        {"actions": None},
        {"actions": [{"name": "wait", "parameters": [], "weights": "wait", "trees": []}] * 1001},
        {"schema": {"attributes": [{}] * 1001, "parameters": []}},
    ],
)
def test_hostile_descriptions_are_refused(folder: Path, changes: dict[str, Any]) -> None:
    edit(folder, **changes)
    with pytest.raises(ModelFormatError):
        read_policy(folder)


@pytest.mark.parametrize(
    "changes",
    [
        {"trees": ["../trees/0001-wait-1.json"]},
        {"trees": ["/etc/passwd"]},
        {"trees": [".json"]},
        {"trees": [7]},
        {"trees": ["0001-pick-1.json"]},
        {"trees": "0001-wait-1.json"},
        {"trees": [f"{'x' * 300}.json"]},
        {"trees": []},
        {"trees": 3},
        {"name": ""},
        {"name": 3},
        {"parameters": ["thing"]},
        {"parameters": None},
        {"weights": "pick"},
        {"weights": "nowhere"},
    ],
)
def test_hostile_actions_are_refused(folder: Path, changes: dict[str, Any]) -> None:
    actions = actions_of(folder)
    actions[0] |= changes
    edit(folder, actions=actions)
    with pytest.raises(ModelFormatError):
        read_policy(folder)


def test_a_tree_that_is_listed_often_is_refused(folder: Path) -> None:
    actions = actions_of(folder)
    actions[0] |= {"trees": actions[0]["trees"] * 1000}
    edit(folder, actions=actions)
    with pytest.raises(ModelFormatError, match=r"it lists the tree '0001-wait-1\.json' 1000 times"):
        read_policy(folder)


def test_file_names_are_safe_and_different() -> None:
    action_types = [
        ActionType(name) for name in ("left", "go to/there", "go to.there", "Left", "iteration", "..")
    ]
    found = slugs(action_types)
    assert found[1:3] == ("go_to_there-1", "go_to_there-2")
    assert {found[0], found[3]} == {"left-0", "Left-3"}
    assert found[4:] == ("iteration-4", "_")
    assert tree_name(3, "left", 1) == "0003-left-1.json"
