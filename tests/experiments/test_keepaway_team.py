from __future__ import annotations

import numpy as np
import pytest

from relforest.experiments.keepaway_team import benchmark_team, frozen, play_episodes_with
from relforest.rl.peers import SarsaSettings
from relforest.support.errors import InputError
from relforest.support.rng import seed_sequence
from relforest.worlds.keepaway.play.durations import play_episodes
from relforest.worlds.keepaway.server.options import KeepawayOptions

RULES = KeepawayOptions(max_cycles=30)
SEED = seed_sequence(5)


def test_every_keeper_has_an_agent_with_the_tiles_of_the_benchmark() -> None:
    team = benchmark_team(KeepawayOptions(keepers=4, takers=3, size=25.0))

    assert len(team) == 4
    # 19 state variables with 32 tilings each.
    assert team[0].features.n_active == 608


def test_agents_learn_from_their_own_experience_or_from_all() -> None:
    alone, together = (benchmark_team(RULES, shared=shared, random_state=0) for shared in (False, True))
    for team in (alone, together):
        play_episodes_with(team, RULES, 3, SEED)

    assert not np.array_equal(alone[0].weights, alone[1].weights)
    assert together[0].weights is together[1].weights
    assert together[0].weights.any()


def test_the_reward_is_the_time_since_the_keeper_last_had_the_ball() -> None:
    # With alpha 1 and one visit of a state, its value becomes the reward; held balls pay 1 each cycle.
    settings = SarsaSettings(alpha=1.0, epsilon=0.0)
    team = benchmark_team(RULES, settings, random_state=0)
    (duration,) = play_episodes_with(team, RULES, 1, SEED)

    paid = [agent.weights.max() * agent.features.n_active for agent in team]
    assert duration <= RULES.max_cycles
    assert 0 < max(paid) <= duration * settings.alpha * 32


def test_an_episode_that_is_cut_off_is_learned_from_as_well() -> None:
    rules = KeepawayOptions(max_cycles=9)
    team = benchmark_team(rules, random_state=0)

    assert play_episodes_with(team, rules, 2, SEED).tolist() == [9, 9]
    assert any(agent.weights.any() for agent in team)


def test_frozen_agents_change_nothing_and_play_what_they_know() -> None:
    team = benchmark_team(RULES, random_state=0)
    play_episodes_with(team, RULES, 3, SEED)
    before = [agent.weights.copy() for agent in team]
    first = play_episodes_with(frozen(team, 1), RULES, 3, SEED)

    np.testing.assert_array_equal(first, play_episodes_with(frozen(team, 1), RULES, 3, SEED))
    for agent, weights in zip(team, before, strict=True):
        np.testing.assert_array_equal(agent.weights, weights)


def test_the_same_seeds_give_the_same_agents() -> None:
    one, other = (benchmark_team(RULES, random_state=3) for _ in range(2))

    np.testing.assert_array_equal(
        play_episodes_with(one, RULES, 4, SEED), play_episodes_with(other, RULES, 4, SEED)
    )
    np.testing.assert_array_equal(one[2].weights, other[2].weights)


def test_an_untrained_team_plays_like_the_random_policy() -> None:
    rules = KeepawayOptions(max_cycles=25)
    team = frozen(benchmark_team(rules, random_state=0))
    ours = play_episodes_with(team, rules, 12, SEED)
    theirs = play_episodes("random", rules, 12, 1).durations

    # Nobody loses the ball before a taker has come near.
    assert ours.min() > 10
    assert theirs.min() > 10


def test_bad_numbers_are_named() -> None:
    team = benchmark_team(RULES)
    with pytest.raises(InputError, match="4 keepers need as many agents, got 3"):
        play_episodes_with(team, KeepawayOptions(keepers=4), 1, SEED)
    with pytest.raises(InputError, match="episodes must be an integer of at least 1, got 0"):
        play_episodes_with(team, RULES, 0, SEED)
