from __future__ import annotations

from pathlib import Path

import gymnasium
import numpy as np
import pytest

from experiments.run_folders import write_run_of_sarsa
from relforest.experiments.keepaway_policies import AgentDecider, TeamDecider, learned_policy
from relforest.experiments.keepaway_team import benchmark_team, play_episodes_with
from relforest.rl.rpi import SMRFRPI
from relforest.support.errors import InputError
from relforest.support.rng import seed_sequence
from relforest.worlds.keepaway.options import KeepawayOptions
from relforest.worlds.keepaway.recorder import record_episodes

RULES = KeepawayOptions(max_cycles=15)


def test_a_team_decides_by_the_values_of_each_keepers_own_agent(tmp_path: Path) -> None:
    team = benchmark_team(RULES, random_state=0)
    play_episodes_with(team, RULES, 2, seed_sequence(0))
    write_run_of_sarsa(tmp_path, team, RULES)
    policy = learned_policy(tmp_path, 3, 2)
    assert isinstance(policy, TeamDecider)
    decisions = record_episodes(policy, RULES, 1, 0)[0].decisions

    assert len(decisions.times) > 0
    best = decisions.values[np.arange(len(decisions.times)), decisions.actions]
    np.testing.assert_array_equal(best, decisions.values.max(axis=1))


def test_what_smrf_rpi_learned_plays_with_other_numbers_of_players(tmp_path: Path) -> None:
    env = gymnasium.make("relforest/Keepaway-v0", max_cycles=15)
    SMRFRPI(env, random_state=0, checkpoint=tmp_path).learn(1, 2, test_episodes=1)
    policy = learned_policy(tmp_path, 4, 3)
    assert isinstance(policy, AgentDecider)
    (recording,) = record_episodes(policy, KeepawayOptions(4, 3, 25.0, max_cycles=12), 1, 0)

    assert recording.decisions.values.shape[1] == 4
    assert np.isfinite(recording.decisions.values).all()


def test_a_folder_of_something_else_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is not a run of keepaway"):
        learned_policy(tmp_path, 3, 2)
    write_run_of_sarsa(tmp_path, benchmark_team(RULES), RULES)
    with pytest.raises(InputError, match="a team of 3 keepers, not 4"):
        learned_policy(tmp_path, 4, 3)
    with pytest.raises(InputError, match="learned against 2 takers, not 3: choose --takers"):
        learned_policy(tmp_path, 3, 3)


def test_of_several_runs_one_must_be_chosen(tmp_path: Path) -> None:
    (tmp_path / "run-00").mkdir()
    with pytest.raises(InputError, match="contains several runs: give the folder of one"):
        learned_policy(tmp_path, 3, 2)
