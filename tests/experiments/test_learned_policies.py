from __future__ import annotations

from pathlib import Path

import gymnasium
import numpy as np
import pytest

from experiments.run_folders import write_run_of_sarsa
from relforest.experiments.keepaway_team import benchmark_team, play_episodes_with
from relforest.experiments.learned_policies import AgentPolicy, TeamPolicy, learned_policy
from relforest.playing import record_episodes
from relforest.rl.rpi import SMRFRPI
from relforest.support.errors import InputError
from relforest.support.rng import seed_sequence
from relforest.worlds.blocks.env import high_towers_env
from relforest.worlds.corridor.env import CorridorEnv
from relforest.worlds.keepaway.env import KeepawayEnv
from relforest.worlds.keepaway.server.options import KeepawayOptions

RULES = KeepawayOptions(max_cycles=15)


def test_a_team_decides_by_the_values_of_each_keepers_own_agent(tmp_path: Path) -> None:
    team = benchmark_team(RULES, random_state=0)
    play_episodes_with(team, RULES, 2, seed_sequence(0))
    write_run_of_sarsa(tmp_path, team, RULES)
    env = KeepawayEnv(max_cycles=15)
    policy = learned_policy(tmp_path, env)
    assert isinstance(policy, TeamPolicy)
    choices = record_episodes(env, policy)[0].choices

    assert len(choices) > 0
    for choice in choices:
        assert choice.values is not None
        assert choice.values[choice.chosen] == max(choice.values)


def test_what_smrf_rpi_learned_plays_with_other_numbers_of_players(tmp_path: Path) -> None:
    env = gymnasium.make("relforest/Keepaway-v0", max_cycles=15)
    SMRFRPI(env, random_state=0, checkpoint=tmp_path).learn(1, 2, test_episodes=1)
    larger = KeepawayEnv(keepers=4, takers=3, size=25.0, max_cycles=12)
    policy = learned_policy(tmp_path, larger)
    assert isinstance(policy, AgentPolicy)
    (recording,) = record_episodes(larger, policy)

    for choice in recording.choices:
        assert choice.values is not None
        assert len(choice.values) == 4
        assert np.isfinite(choice.values).all()
    with pytest.raises(InputError, match="use a world with the same attributes"):
        learned_policy(tmp_path, CorridorEnv())


def test_what_was_learned_about_blocks_plays_with_blocks(tmp_path: Path) -> None:
    env = high_towers_env(n_blocks=2, max_actions=2)
    SMRFRPI(env, random_state=0, checkpoint=tmp_path).learn(1, 2, test_episodes=1)
    larger = high_towers_env(n_blocks=3, max_actions=2)
    (recording,) = record_episodes(larger, learned_policy(tmp_path, larger))

    assert all(choice.values is not None for choice in recording.choices)


def test_a_folder_of_something_else_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is not a run"):
        learned_policy(tmp_path, KeepawayEnv())
    write_run_of_sarsa(tmp_path, benchmark_team(RULES), RULES)
    with pytest.raises(InputError, match="a team of 3 keepers, not 4"):
        learned_policy(tmp_path, KeepawayEnv(keepers=4, takers=3))
    with pytest.raises(InputError, match="learned against 2 takers, not 3: choose --takers"):
        learned_policy(tmp_path, KeepawayEnv(takers=3))
    with pytest.raises(InputError, match="learned by Sarsa, which plays keepaway only"):
        learned_policy(tmp_path, CorridorEnv())


def test_of_several_runs_one_must_be_chosen(tmp_path: Path) -> None:
    (tmp_path / "run-00").mkdir()
    with pytest.raises(InputError, match="contains several runs: give the folder of one"):
        learned_policy(tmp_path, KeepawayEnv())
