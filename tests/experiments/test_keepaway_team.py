from __future__ import annotations

from typing import final

import numpy as np
import pytest

from relforest.experiments.keepaway_team import benchmark_team, play_episodes_with, renewed
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


def test_bells_are_spread_as_wide_as_tiles() -> None:
    features = benchmark_team(RULES, kind="bells")[0].features

    assert features.to_dict()["kind"] == "bells"
    # Eight of them reach a state, over two of the benchmark's tiles.
    assert features.n_active == 13 * 8
    assert features.to_dict()["widths"][:2] == [4.0, 4.0]


def test_agents_learn_from_their_own_experience_or_from_all() -> None:
    alone, together = (benchmark_team(RULES, shared=shared, random_state=0) for shared in (False, True))
    for team in (alone, together):
        play_episodes_with(team, RULES, 3, SEED)

    assert not np.array_equal(alone[0].weights, alone[1].weights)
    assert together[0].weights is together[1].weights
    assert together[0].weights.any()


@final
class Recorder:
    """An agent that holds the ball, or passes it to the first teammate, and remembers what it was told."""

    features = None

    def __init__(self, action: int) -> None:
        self.action = action
        self.paid: list[tuple[str, float, float]] = []

    def start(self, _variables: object) -> int:
        self.paid.append(("start", 0.0, 0.0))
        return self.action

    def step(self, reward: float, duration: float, _variables: object) -> int:
        self.paid.append(("step", reward, duration))
        return self.action

    def end(self, reward: float) -> None:
        self.paid.append(("end", reward, reward))


def recorded(action: int, rules: KeepawayOptions, episodes: int) -> tuple[list[Recorder], list[int]]:
    team = [Recorder(action) for _ in range(rules.keepers)]
    durations = play_episodes_with(team, rules, episodes, SEED)  # type: ignore[arg-type]
    return team, durations.tolist()


def test_a_keeper_that_holds_the_ball_is_paid_for_every_cycle_until_it_loses_it() -> None:
    team, (duration,) = recorded(0, KeepawayOptions(max_cycles=200), 1)
    (holder,) = (agent for agent in team if len(agent.paid) > 2)

    assert [name for name, _, _ in holder.paid] == ["start", *["step"] * (len(holder.paid) - 2), "end"]
    assert all(reward == time for _, reward, time in holder.paid)
    # Nothing is paid for the cycles before its first decision.
    assert duration - 10 < sum(reward for _, reward, _ in holder.paid) <= duration
    assert {reward for name, reward, _ in holder.paid[:-1] if name == "step"} == {1.0}
    assert all(len(agent.paid) <= 2 for agent in team if agent is not holder)


def test_an_episode_that_is_cut_off_ends_with_a_step_and_pays_all_who_decided() -> None:
    rules = KeepawayOptions(max_cycles=9)
    team, durations = recorded(0, rules, 2)
    paid = [entry for agent in team for entry in agent.paid]

    assert durations == [9, 9]
    assert "end" not in {name for name, _, _ in paid}
    starts = sum(name == "start" for name, _, _ in paid)
    assert starts >= 2
    # Between an agent's first decision and the end lies what it is paid in all.
    for agent in team:
        assert sum(reward for _, reward, _ in agent.paid) <= 9 * sum(
            name == "start" for name, _, _ in agent.paid
        )


def test_frozen_agents_change_nothing_and_play_what_they_know() -> None:
    team = benchmark_team(RULES, random_state=0)
    play_episodes_with(team, RULES, 3, SEED)
    before = [agent.weights.copy() for agent in team]
    first = play_episodes_with(renewed(team, 1, learn=False), RULES, 3, SEED)

    np.testing.assert_array_equal(first, play_episodes_with(renewed(team, 1, learn=False), RULES, 3, SEED))
    for agent, weights in zip(team, before, strict=True):
        np.testing.assert_array_equal(agent.weights, weights)


def test_the_same_seeds_give_the_same_agents() -> None:
    one, other = (benchmark_team(RULES, random_state=3) for _ in range(2))

    np.testing.assert_array_equal(
        play_episodes_with(one, RULES, 4, SEED), play_episodes_with(other, RULES, 4, SEED)
    )
    np.testing.assert_array_equal(one[2].weights, other[2].weights)


def test_a_team_that_knows_nothing_plays_as_long_as_random_keepers() -> None:
    rules = KeepawayOptions()
    ours = play_episodes_with(renewed(benchmark_team(rules, random_state=0), 0, learn=False), rules, 30, SEED)
    theirs = play_episodes("random", rules, 30, SEED).durations
    error = float(np.sqrt(ours.var(ddof=1) / 30 + theirs.var(ddof=1) / 30))

    # All values are equal, so that every action is a best one.
    assert abs(ours.mean() - theirs.mean()) < 3 * error


def test_bad_numbers_are_named() -> None:
    team = benchmark_team(RULES)
    with pytest.raises(InputError, match="4 keepers need as many agents, got 3"):
        play_episodes_with(team, KeepawayOptions(keepers=4), 1, SEED)
    with pytest.raises(InputError, match="episodes must be an integer of at least 1, got 0"):
        play_episodes_with(team, RULES, 0, SEED)
