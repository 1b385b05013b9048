from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
import pytest

from relforest.rl import rollout as rollout_module
from relforest.rl.experience import COLUMNS, Experience
from relforest.rl.policy import Policy, RandomPolicy
from relforest.rl.rollout import rollout, world_of
from relforest.scenes.arrays import IntArray
from relforest.smdp import Decision, Decisions, Lockstep, Outcomes
from relforest.support.errors import InputError
from relforest.support.progress import Stage, listening
from rl.small_worlds import Limited, Picking

SEED = np.random.SeedSequence(7)


@dataclass(frozen=True, slots=True)
class Last:
    """Take the last action offered: the last thing, or wait if there is none."""

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        del rng
        return len(decision) - 1


def assert_equal(found: Experience, expected: Experience) -> None:
    for name in COLUMNS:
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), err_msg=name)


def test_an_episode_step_by_step() -> None:
    found = rollout(Picking(things=3), Last(), 1, SEED)
    # 3 things, then 2, 1, 0: four states, the last one terminal; every state offers waiting too.
    assert np.diff(found.objects).tolist() == [3, 2, 1, 0]
    assert np.diff(found.candidates).tolist() == [4, 3, 2, 1]
    assert found.states.tolist() == [0, 1, 2]
    assert found.next_states.tolist() == [1, 2, 3]
    assert found.actions.tolist() == [3, 6, 8]
    assert found.durations.tolist() == [2.0, 2.0, 2.0]
    assert found.terminal.tolist() == [False, False, True]
    assert found.truncated.tolist() == [False, False, False]
    # The reward of an action is discounted by 0.5; the episode's total is not.
    paid = (found.matrix[[2, 4, 5], 0] < 0.5).astype(float)
    assert found.rewards.tolist() == (0.5 * paid).tolist()
    assert found.episode_rewards.tolist() == [paid.sum()]
    assert found.episode_durations.tolist() == [6.0]


def test_a_limit_of_time_is_no_terminal_state() -> None:
    found = rollout(Picking(things=9), RandomPolicy(), 1, SEED)
    assert len(found) == 4
    assert found.truncated.tolist() == [False, False, False, True]
    assert not found.terminal.any()


def test_experience_says_how_many_actions_remain() -> None:
    assert rollout(Picking(things=9), Last(), 1, SEED).remaining.tolist() == [-1] * 5
    assert rollout(Limited(things=9), Last(), 2, SEED).remaining.tolist() == [4, 3, 2, 1, 0] * 2
    assert rollout(Limited(things=2), Last(), 1, SEED).remaining.tolist() == [4, 3, 0]


def test_the_same_seed_gives_the_same_experience() -> None:
    assert_equal(rollout(Picking(), RandomPolicy(), 5, SEED), rollout(Picking(), RandomPolicy(), 5, SEED))


def test_another_seed_gives_another_world() -> None:
    first, second = (rollout(Picking(), RandomPolicy(), 2, np.random.SeedSequence(s)) for s in (0, 1))
    assert not np.array_equal(first.matrix[:3], second.matrix[:3])


def test_the_policy_cannot_disturb_the_world() -> None:
    # The first state is the same whatever the policy draws.
    one, other = rollout(Picking(), Last(), 3, SEED), rollout(Picking(), RandomPolicy(), 3, SEED)
    assert one.matrix[:3].tolist() == other.matrix[:3].tolist()


def test_wrapped_environments_are_fine() -> None:
    env = gymnasium.make("relforest/Corridor-v0")
    found = rollout(env, RandomPolicy(), 2, SEED)
    assert (len(found), found.n_states, found.n_episodes) == (20, 22, 2)


@pytest.mark.parametrize("episodes", [0, -1, 2.5])
def test_counts_of_episodes_are_checked(episodes: Any) -> None:
    with pytest.raises(InputError, match="episodes must be an integer of at least 1"):
        rollout(Picking(), Last(), episodes, SEED)


def test_an_environment_must_hold_a_world() -> None:
    with pytest.raises(InputError, match="SMRF-RPI cannot learn CartPoleEnv"):
        world_of(gymnasium.make("CartPole-v1"))


class Stuck(Picking):
    def decision(self) -> Decision:
        return Decision(
            np.empty((0, 1)), np.empty(0, np.int64), np.empty((0, 1), np.int64), np.empty(0, np.int64)
        )


class Reporting(Picking):
    """Reports after every step what it is told to report."""

    def __init__(self, **info: float) -> None:
        super().__init__()
        self.info = info

    def step(self, action: np.int64 | int) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        return *super().step(action)[:4], dict(self.info)


def test_a_step_may_take_no_time() -> None:
    found = rollout(Reporting(duration=0.0), Last(), 1, SEED)
    assert found.durations.tolist() == [0.0, 0.0, 0.0]
    assert found.episode_durations.tolist() == [0.0]


class Late(Picking):
    """Three units of time, and a reward of 7, pass before the first decision."""

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        return super().reset(seed=seed, options=options)[0], {"duration_before": 3.0, "reward_before": 7.0}


def test_what_passes_before_the_first_decision_counts_for_the_episode_alone() -> None:
    late, found = (rollout(world, Last(), 2, SEED) for world in (Late(), Picking()))
    assert late.episode_rewards.tolist() == (found.episode_rewards + 7.0).tolist()
    assert late.episode_durations.tolist() == (found.episode_durations + 3.0).tolist()
    assert late.rewards.tolist() == found.rewards.tolist()
    assert late.durations.tolist() == found.durations.tolist()


def test_worlds_that_break_the_conventions_are_named() -> None:
    with pytest.raises(InputError, match="Stuck offers no action"):
        rollout(Stuck(), Last(), 1, SEED)


@pytest.mark.parametrize(
    ("info", "found"), [({"duration": -1.0}, "-1.0"), ({"duration": np.inf}, "inf"), ({}, "nan")]
)
def test_durations_are_finite_and_not_negative(info: dict[str, float], found: str) -> None:
    message = rf'Reporting must report a finite info\["duration"\] of at least 0 after a step, got {found}'
    with pytest.raises(InputError, match=message):
        rollout(Reporting(**info), Last(), 1, SEED)


class Games:
    """Several games of picking; the number of things differs."""

    def __init__(self, seeds: Sequence[int]) -> None:
        self.worlds = [Several(things=6) for _ in seeds]
        self.before = np.zeros((2, len(seeds)))
        for world, seed in zip(self.worlds, seeds, strict=True):
            world.reset(seed=seed)

    def decisions(self, episodes: IntArray) -> Decisions:
        return Decisions.of([self.worlds[i].decision() for i in episodes])

    def step(self, episodes: IntArray, actions: IntArray) -> Outcomes:
        taken = [self.worlds[i].step(action) for i, action in zip(episodes, actions, strict=True)]
        rows = [(r, info["discounted_reward"], info["duration"], t, cut) for _, r, t, cut, info in taken]
        rewards, discounted, durations, terminal, truncated = map(np.array, zip(*rows, strict=True))
        return Outcomes(rewards, discounted, durations, terminal, truncated)


class Several(Picking):
    """Offers lockstep, unless somebody watches."""

    watched = False

    @property
    def lockstep(self) -> Callable[[Sequence[int]], Lockstep] | None:
        return None if self.watched else self.begin

    def begin(self, seeds: Sequence[int]) -> Lockstep:
        self.begun = len(seeds)
        return Games(seeds)

    def reset(self, **options: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        found = super().reset(**options)
        self.things = self.things[: 1 + int(6 * self.things[0])]
        return found


@dataclass(frozen=True, slots=True)
class OneByOne:
    """Hides that a policy can choose for many episodes at once."""

    policy: Policy

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        return self.policy.choose(decision, rng)


def test_episodes_played_together_are_those_played_one_after_the_other(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    env = Several(things=6)
    expected = rollout(env, OneByOne(RandomPolicy()), 20, SEED)
    assert not hasattr(env, "begun")
    assert_equal(rollout(env, RandomPolicy(), 20, SEED), expected)
    assert env.begun == 20
    assert 0 < expected.truncated.sum() < 20
    monkeypatch.setattr(rollout_module, "MOST_TOGETHER", 8)
    assert_equal(rollout(env, RandomPolicy(), 20, SEED), expected)
    assert env.begun == 4


def test_wrappers_see_every_step() -> None:
    env = Several(things=6)
    expected = rollout(env, RandomPolicy(), 3, SEED)
    del env.begun
    ordered: Any = gymnasium.wrappers.OrderEnforcing(env)
    wrapped: Any = gymnasium.wrappers.RecordEpisodeStatistics(ordered)
    assert_equal(rollout(wrapped, RandomPolicy(), 3, SEED), expected)
    assert len(wrapped.return_queue) == 3
    env.watched = True
    assert_equal(rollout(env, RandomPolicy(), 3, SEED), expected)
    assert not hasattr(env, "begun")
    env.watched = False
    rollout(ordered, RandomPolicy(), 3, SEED)
    assert env.begun == 3


@pytest.mark.parametrize("policy", [RandomPolicy(), OneByOne(RandomPolicy())])
def test_finished_episodes_are_reported(policy: Policy) -> None:
    heard: list[Stage] = []
    with listening(heard.append):
        rollout(Several(things=6), policy, 9, SEED)
    done = [stage.done for stage in heard if stage.name == "episodes" and stage.done is not None]
    assert done[0] == 0
    assert done == sorted(done)
    assert (done[-1], heard[-1].total) == (9, 9)
