from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from experiments.run_folders import contents, write_run_of_questions, write_run_of_trees
from relforest.experiments import sarsa
from relforest.experiments.learned_policies import TeamPolicy, learned_policy
from relforest.experiments.run_config import RunConfig
from relforest.experiments.runs import learn_runs
from relforest.experiments.sarsa import trained_team
from relforest.experiments.tasks import MethodName
from relforest.playing import record_episodes
from relforest.rl.fitted.settings import Source
from relforest.rl.frozen import ForestFeatures
from relforest.runs import store
from relforest.runs.store import iterations_of, metrics_of
from relforest.support.errors import InputError, ModelFormatError, RunFolderError
from relforest.worlds.keepaway.env import KeepawayEnv

SMALL = RunConfig("keepaway", episodes=1, iterations=1, test_episodes=1, method="cmac-sarsa")
NAMES = {"run.json", "checkpoint.json", "metrics.jsonl", "policy-map.png", "reward.png"}


class KilledError(BaseException):
    """Stands for the end of the process."""


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("finished")
    learn_runs(SMALL, out)
    return out


def test_a_run_folder_holds_metrics_agents_and_pictures(finished: Path) -> None:
    names = set(contents(finished))
    models = {name for name in names if name.startswith("model-")}

    assert names - models == NAMES
    assert {name.split("/")[0] for name in models} == {"model-0001"}
    rows = [json.loads(line) for line in (finished / "metrics.jsonl").read_text().splitlines()]
    assert list(metrics_of(finished)) == rows
    assert [row["iteration"] for row in rows] == [0, 1]
    assert rows[0]["train_reward"] is None
    assert all(row["test_reward"] > 0 for row in rows)
    assert len(trained_team(finished)) == 3


@pytest.mark.parametrize("method", ["cmac-sarsa-shared", "rbf-sarsa"])
def test_more_iterations_extend_a_run_to_the_one_that_had_them_at_once(
    tmp_path: Path, method: MethodName
) -> None:
    longer = replace(SMALL, iterations=2, method=method)
    learn_runs(longer, tmp_path / "at-once")
    learn_runs(replace(longer, iterations=1), tmp_path / "extended")
    learn_runs(longer, tmp_path / "extended")

    assert contents(tmp_path / "extended") == contents(tmp_path / "at-once")
    one, other, _ = trained_team(tmp_path / "extended")
    assert (one.weights is other.weights) == (method == "cmac-sarsa-shared")
    assert one.features.to_dict()["kind"] == ("bells" if method == "rbf-sarsa" else "tiles")


@pytest.mark.parametrize("moment", ["write_npz", "write_json", "write_text"])
def test_a_run_killed_while_it_writes_goes_on_to_the_same_end(
    tmp_path: Path, finished: Path, monkeypatch: pytest.MonkeyPatch, moment: str
) -> None:
    calls = 0
    original = getattr(store, moment)

    def dies(*arguments: Any) -> Any:
        nonlocal calls
        calls += 1
        # The first time is before learning.
        if calls == 2:
            raise KilledError
        return original(*arguments)

    with monkeypatch.context() as patch:
        patch.setattr(store, moment, dies)
        with pytest.raises(KilledError):
            learn_runs(SMALL, tmp_path)
    learn_runs(SMALL, tmp_path)

    assert contents(tmp_path) == contents(finished)


def test_a_finished_run_is_left_unchanged(finished: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sarsa, "play_episodes_with", None)
    before = contents(finished)
    learn_runs(SMALL, finished)

    assert contents(finished) == before


def test_several_runs_have_folders_of_their_own(tmp_path: Path) -> None:
    reports: list[tuple[int, int]] = []
    two = replace(SMALL, runs=2)
    folders = learn_runs(
        two, tmp_path, on_iteration=lambda run, row, _: reports.append((run, row["iteration"]))
    )

    assert [folder.name for folder in folders] == ["run-00", "run-01"]
    assert reports == [(0, 0), (0, 1), (1, 0), (1, 1)]
    assert metrics_of(folders[0]) != metrics_of(folders[1])


def test_another_method_is_refused(finished: Path) -> None:
    with pytest.raises(RunFolderError, match=r"method \('cmac-sarsa' there, 'cmac-sarsa-shared' here\)"):
        learn_runs(replace(SMALL, method="cmac-sarsa-shared"), finished)


@pytest.mark.parametrize(
    "content", ["{}", "[", '{"format": "relforest-checkpoint", "version": 1, "metrics": []}']
)
def test_a_damaged_checkpoint_is_named(tmp_path: Path, content: str) -> None:
    (tmp_path / "checkpoint.json").write_text(content)

    assert iterations_of(tmp_path) == -1
    with pytest.raises(ModelFormatError, match=r"checkpoint\.json"):
        metrics_of(tmp_path)


def test_a_folder_without_a_run_is_named(tmp_path: Path) -> None:
    with pytest.raises(ModelFormatError, match=r"checkpoint\.json"):
        trained_team(tmp_path)


def test_sarsa_learns_weights_for_the_trees_of_another_run_and_no_longer_needs_it(tmp_path: Path) -> None:
    write_run_of_trees(tmp_path / "trees")
    config = replace(SMALL, iterations=2, method="sarsa-on-smrf", source=Source(tmp_path / "trees"))
    learn_runs(config, tmp_path / "at-once")
    learn_runs(replace(config, iterations=1), tmp_path / "run")
    tree = (tmp_path / "trees" / "trees" / "0001-pass-1.json").read_bytes()
    shutil.rmtree(tmp_path / "trees")
    learn_runs(config, tmp_path / "run")

    assert contents(tmp_path / "run") == contents(tmp_path / "at-once")
    team = trained_team(tmp_path / "run")
    assert isinstance(team[0].features, ForestFeatures)
    assert (tmp_path / "run" / "trees" / "0001-pass-1.json").read_bytes() == tree
    assert len({agent.weights.tobytes() for agent in team}) > 1
    env = KeepawayEnv(max_cycles=20)
    policy = learned_policy(tmp_path / "run", env)
    assert isinstance(policy, TeamPolicy)
    for choice in record_episodes(env, policy)[0].choices:
        assert choice.values is not None
        assert choice.values[choice.chosen] == max(choice.values)


def test_trees_must_come_from_a_run_of_smrf_rpi_in_keepaway(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="needs the trees of a run of smrf-rpi: pass it as source"):
        replace(SMALL, method="sarsa-on-smrf")
    learn_runs(RunConfig("corridor", episodes=1, iterations=1, test_episodes=1), tmp_path / "corridor")
    learn_runs(replace(SMALL, method="smrf-rpi"), tmp_path / "few")
    write_run_of_questions(tmp_path / "questions")
    for name, message in (
        ("questions", "is no run of smrf-rpi"),
        ("corridor", "was not learned in keepaway"),
        ("few", "has no trees: let it learn first"),
    ):
        config = replace(SMALL, method="sarsa-on-smrf", source=Source(tmp_path / name))
        with pytest.raises(InputError, match=message):
            learn_runs(config, tmp_path / "out" / name)
