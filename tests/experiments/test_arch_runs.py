"""Runs of the arch, which practises in one environment and is tested in another."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiments.run_folders import contents
from relforest.experiments.learned_policies import learned_policy
from relforest.experiments.run_config import RunConfig
from relforest.experiments.runs import learn_runs
from relforest.experiments.tasks import MethodName
from relforest.playing import record_episodes
from relforest.rl.experience_files import read_experience
from relforest.rl.fitted.settings import ForestSettings, QSettings
from relforest.rl.settings import RPISettings
from relforest.runs.store import RunStore
from relforest.worlds.blocks.env import arch_env

SETTINGS: dict[MethodName, dict[str, Any]] = {
    "smrf-q": {"q": QSettings(portion=4, forests=ForestSettings(counts=3, trees=2))},
    "smrf-rpi": {"rpi": RPISettings()},
}


def config(method: MethodName) -> RunConfig:
    settings = SETTINGS[method]
    return RunConfig("arch-done", episodes=4, iterations=2, test_episodes=2, method=method, **settings)


@pytest.mark.parametrize("method", ["smrf-q", "smrf-rpi"])
def test_an_interrupted_run_has_the_bytes_of_an_uninterrupted_one(
    method: MethodName, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    learn_runs(config(method), whole)
    written = RunStore.write

    def write_once(self: RunStore[Any], *arguments: Any) -> None:
        if arguments[0].iteration == 2:
            raise KeyboardInterrupt
        written(self, *arguments)

    monkeypatch.setattr(RunStore, "write", write_once)
    with pytest.raises(KeyboardInterrupt):
        learn_runs(config(method), parts)
    monkeypatch.setattr(RunStore, "write", written)
    learn_runs(config(method), parts)
    assert contents(parts, pictures=False) == contents(whole, pictures=False)


def test_experience_holds_what_the_search_found_and_plays_on(tmp_path: Path) -> None:
    learn_runs(config("smrf-q"), tmp_path)
    env = arch_env()
    first, second = read_experience(tmp_path, 2, env.schema, env.action_types)
    # 3 rotations, 15 moves and done at most, and one more where the trainer takes its own.
    offered = np.diff(first.candidates)
    assert offered.max() <= 3 + 15 + 1 + 1
    assert np.diff(second.candidates).max() > 20
    (recording,) = record_episodes(env, learned_policy(tmp_path, env), seed=1)
    for choice in recording.choices:
        assert choice.values is not None
        assert choice.values[choice.chosen] == max(choice.values)
