from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
from gymnasium.error import ResetNeeded

from relforest.support.errors import InputError
from relforest.worlds.keepaway.env import KeepawayEnv

pytest.importorskip("pettingzoo", reason="the extra pettingzoo is not installed")

with warnings.catch_warnings():
    # With pygame installed, importing it makes games in a way that is deprecated.
    warnings.simplefilter("ignore", DeprecationWarning)
    from pettingzoo.test import parallel_api_test

from relforest.worlds.keepaway.parallel import KeepawayParallelEnv

WAIT = 3


def decider(observations: dict[str, Any]) -> str:
    """Return the one agent that may do anything but wait."""
    (agent,) = (name for name, seen in observations.items() if seen["action_mask"][0])
    return agent


@pytest.mark.parametrize("options", [{}, {"keepers": 4, "takers": 3, "size": 25.0, "max_cycles": 50}])
def test_pettingzoos_own_check_passes_without_a_warning(options: dict[str, Any]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parallel_api_test(KeepawayParallelEnv(**options), num_cycles=60)


def test_it_is_the_same_game_as_the_single_environment() -> None:
    env, single = KeepawayParallelEnv(), KeepawayEnv()
    observations, infos = env.reset(seed=3)
    expected, info = single.reset(seed=3)
    rng = np.random.default_rng(0)
    while env.agents:
        agent = decider(observations)
        assert agent == f"keeper_{info['actor']}"
        action = int(rng.integers(3))
        observations, rewards, terminations, truncations, infos = env.step({agent: action})
        expected, reward, terminated, truncated, info = single.step(action)
        for name in env.possible_agents:
            np.testing.assert_array_equal(observations[name]["observation"]["location"], expected["location"])
            assert (rewards[name], terminations[name], truncations[name]) == (reward, terminated, truncated)
            assert infos[name]["time"] == info["time"]
    assert info["end"] in {"out", "taken"}


def test_masks_let_one_keeper_decide_and_the_others_wait() -> None:
    env = KeepawayParallelEnv()
    observations, infos = env.reset(seed=0)
    masks = {agent: seen["action_mask"].tolist() for agent, seen in observations.items()}
    assert sorted(masks.values()) == [[0, 0, 0, 1], [0, 0, 0, 1], [1, 1, 1, 0]]
    assert masks[f"keeper_{infos['keeper_0']['actor']}"] == [1, 1, 1, 0]


def test_what_a_keeper_collects_between_two_decisions_is_the_time_between_them() -> None:
    env = KeepawayParallelEnv()
    rng = np.random.default_rng(2)
    checked = 0
    for seed in range(3):
        observations, infos = env.reset(seed=seed)
        collected: dict[str, float] = {}
        began: dict[str, int] = {}
        while env.agents:
            agent = decider(observations)
            time = infos[agent]["time"]
            if agent in began:
                assert collected[agent] == time - began[agent]
                checked += 1
            collected[agent], began[agent] = 0.0, time
            observations, rewards, *_, infos = env.step({agent: rng.integers(3)})
            collected = {name: total + rewards[name] for name, total in collected.items()}
        assert all(collected[name] == infos[name]["time"] - time for name, time in began.items())
    assert checked > 5


def test_a_truncated_game_leaves_nothing_to_do() -> None:
    env = KeepawayParallelEnv(max_cycles=15)
    observations, _ = env.reset(seed=0)
    truncations: dict[str, bool] = {}
    while env.agents:
        observations, _, _, truncations, _ = env.step({decider(observations): 0})
    assert truncations == dict.fromkeys(env.possible_agents, True)
    assert [seen["action_mask"].tolist() for seen in observations.values()] == [[0, 0, 0, 1]] * 3


def test_agents_do_not_share_arrays_that_they_could_change() -> None:
    env = KeepawayParallelEnv()
    observations, _ = env.reset(seed=0)
    observations["keeper_0"]["observation"]["location"][:] = 0.0
    assert observations["keeper_1"]["observation"]["location"].any()


def test_the_state_is_that_of_all_players_and_the_ball() -> None:
    env = KeepawayParallelEnv(render_mode="rgb_array")
    env.reset(seed=0)
    # Five numbers for each of five players, four for the ball.
    assert env.state().shape == (29,)
    assert env.render().ndim == 3


@pytest.mark.parametrize(
    ("own", "other", "message"),
    [
        (0, 0, r"keeper_\d can only wait \(3\) while keeper_\d decides, got 0"),
        (WAIT, WAIT, r"keeper_\d must decide: pass its action, from 0 to 2"),
        (None, WAIT, r"must be an integer from 0 to 3 \(.*; the last one: wait\), got None"),
        (4, WAIT, r"must be an integer from 0 to 3 \(.*\), got 4"),
        (float("nan"), WAIT, r"must be an integer from 0 to 3 \(.*\), got nan"),
    ],
)
def test_unavailable_actions_are_errors(own: Any, other: Any, message: str) -> None:
    env = KeepawayParallelEnv()
    observations, _ = env.reset(seed=0)
    agent = decider(observations)
    actions = {name: own if name == agent else other for name in env.agents}
    with pytest.raises(InputError, match=message):
        env.step(actions)
    env.step({agent: 0})


def test_wrong_use_is_an_error() -> None:
    env = KeepawayParallelEnv()
    with pytest.raises(ResetNeeded, match="call reset"):
        env.step({})
    env.reset(seed=0)
    with pytest.raises(InputError, match=r"keeper_\d must decide"):
        env.step({})
    with pytest.raises(
        InputError, match=r"actions must belong to keeper_0, keeper_1, keeper_2, got .'taker_0'"
    ):
        env.step({"taker_0": 0})
    with pytest.raises(InputError, match="keepers must be an integer from 2 to 32"):
        KeepawayParallelEnv(keepers=1)
