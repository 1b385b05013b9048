from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

from relforest.reports import run_report
from relforest.reports.run_report import averages_table, metrics_table, trees_in_words
from relforest.rl.rpi import SMRFRPI
from relforest.rl.value import ValueFunction
from relforest.scenes import Attribute, Schema
from relforest.smdp import ActionType
from relforest.support.errors import ModelFormatError
from relforest.worlds import environment_id
from small_trees import near_tree

ROWS: list[dict[str, Any]] = [
    {"iteration": 0, "test_reward": 2.5, "train_reward": None, "trees": 0, "leaves": 0},
    {"iteration": 1, "test_reward": 8.25, "train_reward": 2.0, "trees": 2, "leaves": 10},
]


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    env = gymnasium.make(environment_id("corridor"), disable_env_checker=True)
    SMRFRPI(env, random_state=0, checkpoint=folder).learn(1, 4, test_episodes=2)
    return folder


def test_metrics_are_a_table() -> None:
    assert metrics_table(ROWS).splitlines() == [
        "iteration  test reward  train reward  trees  leaves",
        "        0        2.500             -      0       0",
        "        1        8.250         2.000      2      10",
    ]


def test_averages_are_over_runs() -> None:
    other = [{**row, "test_reward": row["test_reward"] + 2} for row in ROWS]

    # 2.5 and 4.5: mean 3.5, standard deviation sqrt(2).
    assert averages_table([ROWS, other]).splitlines() == [
        "iteration    test reward   train reward          trees          leaves",
        "        0  3.500 (1.414)              -  0.000 (0.000)   0.000 (0.000)",
        "        1  9.250 (1.414)  2.000 (0.000)  2.000 (0.000)  10.000 (0.000)",
    ]


def test_a_run_is_told_by_its_numbers_and_trees(run_folder: Path) -> None:
    text = run_report(run_folder)
    last = json.loads((run_folder / "metrics.jsonl").read_text("utf-8").splitlines()[-1])

    assert text.startswith("iteration  test reward")
    assert f"{last['test_reward']:.3f}" in text
    assert text.count("SMRF tree with") == last["trees"]
    assert "left: " in text
    assert "right: " in text


def test_an_action_without_trees_is_named_with_its_parameters() -> None:
    value = ValueFunction.zero(
        Schema([Attribute("location", 2)]), (ActionType("put", ("block", "place")),), "bits"
    )

    assert trees_in_words(value) == "put(block, place): no trees"


def test_trees_of_a_policy_come_without_advice_for_classifiers() -> None:
    schema = Schema([Attribute("location", 2)])
    # Every leaf predicts positive, which is no fault of a tree that serves as features.
    tree = near_tree(schema, probabilities=(0.9, 0.8, 0.7))
    value = ValueFunction(schema, (ActionType("left"),), "probability", ((tree,),), (np.zeros(2),))

    assert "relforest fit" in str(tree)
    assert "B is within 3 of A" in trees_in_words(value)
    assert "relforest fit" not in trees_in_words(value)


def test_damaged_folders_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelFormatError, match="cannot be read"):
        run_report(tmp_path)
    damaged = {"format": "relforest-checkpoint", "version": 1, "metrics": 3}
    (tmp_path / "checkpoint.json").write_text(json.dumps(damaged))
    with pytest.raises(ModelFormatError, match="is damaged: the list of metrics is missing"):
        run_report(tmp_path)
