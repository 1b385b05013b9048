from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from experiments.run_folders import contents
from interpreted import compiled_only
from relforest.experiments import methods, vectors
from relforest.experiments.learned_policies import learned_policy
from relforest.experiments.learning import settings
from relforest.experiments.learning.run import unavailable
from relforest.experiments.run_config import RunConfig
from relforest.experiments.runs import learn_runs
from relforest.experiments.tasks import MethodName, task_named
from relforest.experiments.vectors import vector_learner
from relforest.playing import record_episodes
from relforest.rl.vectors import NetworkQ
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.rng import seed_sequence
from relforest.worlds.corridor.env import CorridorEnv
from relforest.worlds.keepaway.env import KeepawayEnv

SMALL = RunConfig("keepaway", episodes=3, iterations=2, test_episodes=1, method="linear-q")
ON_VARIABLES: list[MethodName] = ["linear-q", "lspi", "trees-q", "boosting-q"]
ON_OBJECTS: list[MethodName] = ["dqn", "deep-sets-q"]


@compiled_only
@pytest.mark.parametrize("method", [*ON_VARIABLES, *ON_OBJECTS])
def test_a_run_is_resumed_drawn_and_played(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, method: MethodName
) -> None:
    if method in ON_OBJECTS:
        pytest.importorskip("torch")
        monkeypatch.setattr(vectors, "NetworkQ", partial(NetworkQ, sweeps=1, steps=5))
    config = replace(SMALL, method=method)
    learn_runs(config, tmp_path / "whole", n_jobs=2)
    learn_runs(replace(config, iterations=1), tmp_path / "parts")
    learn_runs(config, tmp_path / "parts")
    assert contents(tmp_path / "parts") == contents(tmp_path / "whole")
    assert (tmp_path / "whole" / "policy-map.png").exists()

    env = KeepawayEnv(max_cycles=15)
    choices = record_episodes(env, learned_policy(tmp_path / "whole", env))[0].choices
    assert len(choices) > 0
    for choice in choices:
        assert choice.values is not None
        assert choice.values[choice.chosen] == max(choice.values)


@compiled_only
def test_worlds_and_folders_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    learn_runs(replace(SMALL, iterations=1), tmp_path)
    with pytest.raises(InputError, match="learned by 3 keepers against 2 takers, not by 4 against 3: choose"):
        learned_policy(tmp_path, KeepawayEnv(keepers=4, takers=3))
    with pytest.raises(InputError, match="those of keepaway, not of CorridorEnv: play keepaway"):
        learned_policy(tmp_path, CorridorEnv())
    with pytest.raises(InputError, match="those of keepaway, not of CorridorEnv"):
        vector_learner("linear-q", task_named("corridor").make(), seed_sequence(0), (1, 1))
    (tmp_path / "values" / "iteration-0001.npz").write_bytes(b"")
    with pytest.raises(ModelFormatError, match="iteration-0001"):
        learned_policy(tmp_path, KeepawayEnv())
    with pytest.raises(InputError, match="the method for corridor must be one of"):
        RunConfig("corridor", method="trees-q")


def test_networks_need_pytorch(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(methods, "find_spec", lambda _name: None)
    with pytest.raises(InputError, match=r"dqn learns with torch, .* extra 'relforest\[bench\]'"):
        replace(SMALL, method="dqn")
    left_out = unavailable(settings.SETTINGS[settings.KEEPAWAY])
    assert {absence.missing for absence in left_out.values()} == set(ON_OBJECTS)
    assert all("install the extra" in absence.reason for absence in left_out.values())
    monkeypatch.undo()
    assert not set(unavailable(settings.SETTINGS[settings.TOWERS]))
