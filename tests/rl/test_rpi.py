from __future__ import annotations

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

from interpreted import compiled_only
from relforest.rl.rpi import SMRFRPI
from relforest.rl.settings import LSPISettings, RPISettings
from relforest.runs.learner import METRIC_NAMES
from relforest.support.errors import InputError, ModelFormatError, RunFolderError
from relforest.support.locks import FolderLock
from relforest.support.progress import Stage, listening
from relforest.worlds.corridor.env import CorridorEnv
from rl.small_worlds import Picking, Reaching

pytestmark = compiled_only

QUICK = RPISettings(trees_per_label=1, max_rounds=2, max_scenes=40)


def agent(**options: Any) -> SMRFRPI:
    chosen: dict[str, Any] = {"settings": QUICK, "random_state": 0}
    return SMRFRPI(CorridorEnv(), **(chosen | options))


@pytest.fixture(scope="module")
def learned() -> SMRFRPI:
    return agent().learn(2, 6)


def same(one: SMRFRPI, other: SMRFRPI) -> bool:
    weights = [np.concatenate(each.value_.weights).tolist() for each in (one, other)]
    trees = [[tree.to_dict() for trees in each.value_.forests for tree in trees] for each in (one, other)]
    return one.metrics_ == other.metrics_ and weights[0] == weights[1] and trees[0] == trees[1]


def test_metrics_have_a_row_before_learning_and_one_per_iteration(learned: SMRFRPI) -> None:
    rows = learned.metrics_
    assert [tuple(row) for row in rows] == [METRIC_NAMES] * 3
    assert [row["iteration"] for row in rows] == [0, 1, 2]
    assert (rows[0]["train_reward"], rows[0]["trees"], rows[0]["leaves"]) == (None, 0, 0)
    assert rows[-1]["trees"] == learned.value_.n_trees
    assert rows[-1]["leaves"] == learned.value_.n_leaves
    assert [batch.n_episodes for batch in learned.experience_] == [6, 6]
    assert rows[2]["train_reward"] == learned.experience_[1].episode_rewards.mean()


def test_learning_beats_chance(learned: SMRFRPI) -> None:
    # Random actions collect 2.6 of about 8.7 per episode.
    assert learned.metrics_[-1]["test_reward"] > 5.0


def test_actions_with_private_objects_are_learned() -> None:
    learner = SMRFRPI(Reaching(), settings=QUICK, random_state=0).learn(2, 30, test_episodes=100)
    rows = learner.metrics_
    # A random place is near another thing in a third of the cases; there are 6 to choose from.
    assert rows[-1]["trees"] > 0
    assert rows[-1]["test_reward"] > 1.5 * rows[0]["test_reward"]


def test_arches_are_learned_from_and_a_run_goes_on(tmp_path: Path) -> None:
    chosen: dict[str, Any] = {"settings": QUICK, "random_state": 0}
    env = gymnasium.make("relforest/Arch-v0")
    whole = SMRFRPI(env, **chosen).learn(2, 4)
    # Moves aim at private objects: as many as there are moves on offer, beside three blocks.
    batch = whole.experience_[0]
    assert (np.diff(batch.objects) - batch.private).tolist() == [3] * batch.n_states
    assert batch.private.min() > 3
    SMRFRPI(env, checkpoint=tmp_path, **chosen).learn(1, 4)
    assert same(SMRFRPI(env, checkpoint=tmp_path, **chosen).learn(2, 4), whole)


def test_metrics_cannot_be_changed_from_outside(learned: SMRFRPI) -> None:
    learned.metrics_[0]["test_reward"] = 99.0
    assert learned.metrics_[0]["test_reward"] != 99.0


def test_learning_goes_on_where_it_stopped(learned: SMRFRPI) -> None:
    assert same(agent().learn(1, 6).learn(2, 6), learned)


def test_asking_for_no_more_changes_nothing(learned: SMRFRPI) -> None:
    before = learned.metrics_
    learned.learn(1, 6)
    assert learned.metrics_ == before


def test_the_seed_decides_everything(learned: SMRFRPI) -> None:
    assert same(agent(random_state=np.random.SeedSequence(0), n_jobs=-1).learn(2, 6), learned)
    assert not same(agent(random_state=1).learn(2, 6), learned)


def test_test_episodes_do_not_disturb_learning(learned: SMRFRPI) -> None:
    other = agent().learn(2, 6, test_episodes=1)
    assert [row["train_reward"] for row in other.metrics_] == [
        row["train_reward"] for row in learned.metrics_
    ]


def test_callers_hear_of_every_iteration() -> None:
    heard: list[tuple[dict[str, Any], dict[str, float]]] = []
    found = agent().learn(1, 3, on_iteration=lambda row, seconds: heard.append((row, seconds)))
    assert [row for row, _ in heard] == found.metrics_
    assert {name for _, seconds in heard for name in seconds} == {"learning", "testing"}


def test_evaluation_is_greedy_and_repeatable(learned: SMRFRPI) -> None:
    first, second = (learned.evaluate(gymnasium.make("relforest/Corridor-v0"), 20, seed=3) for _ in range(2))
    assert first.rewards.tolist() == second.rewards.tolist()
    assert first.durations.tolist() == [10.0] * 20
    assert first.rewards.mean() > 5.0
    assert learned.evaluate(CorridorEnv(), 20).rewards.shape == (20,)


def test_a_relational_agent_acts_among_more_objects_than_it_was_trained_with() -> None:
    picker = SMRFRPI(Picking(things=3), settings=QUICK, random_state=0).learn(1, 25, test_episodes=5)
    assert picker.value_.n_trees > 0
    assert picker.evaluate(Picking(things=6), 5, seed=0).rewards.shape == (5,)


def test_another_world_is_refused(learned: SMRFRPI) -> None:
    with pytest.raises(InputError, match="action types"):
        learned.evaluate(Picking())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0, 5), "iterations must be an integer of at least 1"),
        ((1, 0), "episodes must be an integer of at least 1"),
        ((1, -3), "episodes must be"),
        ((1.5, 5), "iterations must be"),
    ],
)
def test_counts_are_checked(arguments: tuple[Any, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        agent().learn(*arguments)
    with pytest.raises(InputError, match="test_episodes must be"):
        agent().learn(1, 5, test_episodes=0)


def test_options_are_checked() -> None:
    with pytest.raises(InputError, match=r"settings must be RPISettings\(\.\.\.\)"):
        agent(settings=LSPISettings())
    with pytest.raises(InputError, match="SMRF-RPI cannot learn"):
        SMRFRPI(gymnasium.make("CartPole-v1"))
    with pytest.raises(InputError, match="n_jobs"):
        agent(n_jobs=0)
    with pytest.raises(InputError, match="random_state"):
        agent(random_state=-1)


def test_an_agent_survives_its_folder(learned: SMRFRPI, tmp_path: Path) -> None:
    learned.save(tmp_path)
    loaded = SMRFRPI.load(tmp_path, CorridorEnv())
    assert same(loaded, learned)
    assert loaded.settings == QUICK
    one, other = (each.evaluate(CorridorEnv(), 10, seed=5).rewards for each in (loaded, learned))
    assert one.tolist() == other.tolist()


def test_a_loaded_agent_learns_on_as_the_saved_one_would(learned: SMRFRPI, tmp_path: Path) -> None:
    first = agent().learn(1, 6)
    first.save(tmp_path)
    assert same(SMRFRPI.load(tmp_path, CorridorEnv()).learn(2, 6), learned)
    # Saving a later stage of the same run to the same folder is fine, an earlier one is not.
    learned.save(tmp_path)
    assert same(SMRFRPI.load(tmp_path, CorridorEnv()), learned)
    with pytest.raises(RunFolderError, match="at iteration 2, later than the agent's 1"):
        first.save(tmp_path)


def test_saving_needs_something_learned_and_a_folder_of_its_own(learned: SMRFRPI, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="call learn first"):
        agent().save(tmp_path)
    learned.save(tmp_path)
    with pytest.raises(
        RunFolderError, match=r"a different configuration: random_state\.entropy \(0 there, 1 here\)"
    ):
        agent(random_state=1).learn(1, 6).save(tmp_path)
    with FolderLock(tmp_path), pytest.raises(RunFolderError, match="in use"):
        learned.save(tmp_path)


def test_loading_checks_files_and_world(learned: SMRFRPI, tmp_path: Path) -> None:
    with pytest.raises(ModelFormatError, match=r"checkpoint\.json"):
        SMRFRPI.load(tmp_path / "nothing", CorridorEnv())
    learned.save(tmp_path)
    with pytest.raises(InputError, match="action types"):
        SMRFRPI.load(tmp_path, Picking())
    (tmp_path / "checkpoint.json").write_text("{", "utf-8")
    with pytest.raises(ModelFormatError, match=r"checkpoint\.json"):
        SMRFRPI.load(tmp_path, CorridorEnv())


def test_every_part_of_an_iteration_is_reported_and_changes_nothing(learned: SMRFRPI) -> None:
    heard: list[Stage] = []
    with listening(heard.append):
        again = agent(n_jobs=2).learn(2, 6)
    parts = {stage.within[:3] for stage in heard}

    assert same(again, learned)
    assert Stage("episodes", 5, 6, ("iteration 0", "testing")) in heard
    assert Stage("episodes", 5, 6, ("iteration 2", "training")) in heard
    assert Stage("policy iteration", 0, 50, ("iteration 1",)) in heard
    assert ("iteration 1", "round 1", "tree 1 of 4") in parts


def test_a_verbose_agent_prints_to_standard_error(capsys: pytest.CaptureFixture[str]) -> None:
    agent(verbose=True).learn(1, 6)
    printed = capsys.readouterr()

    assert printed.out == ""
    assert printed.err.startswith("iteration 0, testing, episodes: 0 of 6\n")
    with pytest.raises(InputError, match="verbose must be True or False, got 2"):
        agent(verbose=2)
