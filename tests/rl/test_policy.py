from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from relforest.rl.policy import EpsilonGreedyPolicy, GreedyPolicy, Policy, RandomPolicy, choose_all
from relforest.scenes.arrays import FloatArray
from relforest.smdp import Decision, Decisions
from relforest.support.errors import InputError

THREE = Decision(np.zeros((1, 1)), np.zeros(3, np.int64), np.empty((3, 0), np.int64), np.arange(3))


@dataclass(frozen=True, slots=True, eq=False)
class Fixed:
    numbers: FloatArray

    def values(self, decision: Decision) -> FloatArray:
        assert len(decision) == len(self.numbers)
        return self.numbers


def test_greedy_takes_the_best_and_draws_nothing() -> None:
    rng = np.random.default_rng(0)
    assert GreedyPolicy(Fixed(np.array([1.0, 3.0, 2.0]))).choose(THREE, rng) == 1
    assert rng.random() == np.random.default_rng(0).random()


def test_greedy_breaks_ties_at_random_among_the_best() -> None:
    policy, rng = GreedyPolicy(Fixed(np.array([3.0, 1.0, 3.0]))), np.random.default_rng(0)
    chosen = np.bincount([policy.choose(THREE, rng) for _ in range(400)], minlength=3)
    # Binomial(400, 1/2): standard deviation 10.
    assert chosen[1] == 0
    assert abs(chosen[0] - 200) <= 40


def test_random_is_uniform() -> None:
    rng = np.random.default_rng(0)
    chosen = np.bincount([RandomPolicy().choose(THREE, rng) for _ in range(600)], minlength=3)
    # Binomial(600, 1/3): standard deviation sqrt(600 * 2 / 9) = 11.5.
    assert (np.abs(chosen - 200) <= 46).all()


def test_epsilon_greedy_explores_now_and_then() -> None:
    policy = EpsilonGreedyPolicy(GreedyPolicy(Fixed(np.array([0.0, 1.0, 0.0]))), 0.3)
    rng = np.random.default_rng(0)
    chosen = np.bincount([policy.choose(THREE, rng) for _ in range(1000)], minlength=3)
    # Each of the others with 0.3 / 3: mean 100, standard deviation sqrt(1000 * .1 * .9) = 9.5.
    assert abs(chosen[0] - 100) <= 38
    assert abs(chosen[2] - 100) <= 38


@pytest.mark.parametrize("epsilon", [0.0, 1.0])
def test_epsilon_at_its_ends(epsilon: float) -> None:
    policy = EpsilonGreedyPolicy(GreedyPolicy(Fixed(np.array([0.0, 1.0, 0.0]))), epsilon)
    chosen = {policy.choose(THREE, np.random.default_rng(seed)) for seed in range(40)}
    assert chosen == ({0, 1, 2} if epsilon else {1})


def test_another_policy_may_explore() -> None:
    best = GreedyPolicy(Fixed(np.array([0.0, 1.0, 0.0])))
    explorer = GreedyPolicy(Fixed(np.array([0.0, 0.0, 1.0])))
    policy, rng = EpsilonGreedyPolicy(best, 0.3, explorer), np.random.default_rng(0)
    chosen = np.bincount([policy.choose(THREE, rng) for _ in range(1000)], minlength=3)
    # Binomial(1000, 0.3): standard deviation 14.5.
    assert chosen[0] == 0
    assert abs(chosen[2] - 300) <= 58


@pytest.mark.parametrize("epsilon", [-0.1, 1.1, float("nan")])
def test_epsilon_must_be_a_probability(epsilon: float) -> None:
    with pytest.raises(InputError, match="epsilon must be a number of at least 0 and of at most 1"):
        EpsilonGreedyPolicy(RandomPolicy(), epsilon)


class Steps:
    """Values in few steps, so that some are equal."""

    def values(self, decision: Decision) -> FloatArray:
        return np.floor(3.0 * np.resize(decision.objects[:, 0], len(decision)))


@dataclass(frozen=True, slots=True)
class Alone:
    """Choose one by one."""

    policy: Policy

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        return self.policy.choose(decision, rng)


@pytest.mark.parametrize(
    "policy",
    [
        RandomPolicy(),
        GreedyPolicy(Steps()),
        EpsilonGreedyPolicy(GreedyPolicy(Steps()), 0.4),
        EpsilonGreedyPolicy(Alone(RandomPolicy()), 0.4),
        EpsilonGreedyPolicy(RandomPolicy(), 0.4, Alone(GreedyPolicy(Steps()))),
        EpsilonGreedyPolicy(RandomPolicy(), 0.0),
        EpsilonGreedyPolicy(RandomPolicy(), 1.0),
    ],
)
def test_policies_choose_the_same_for_many_episodes_at_once(policy: Policy) -> None:
    rng = np.random.default_rng(0)
    counts = rng.integers(1, 6, 50)
    decisions = Decisions.of(
        [
            Decision(rng.random((4, 1)), np.zeros(n, np.int64), np.empty((n, 0), np.int64), np.arange(n))
            for n in counts
        ]
    )
    own, others = ([np.random.default_rng(i) for i in range(50)] for _ in range(2))
    for _ in range(3):
        found = choose_all(policy, decisions, own)
        assert found.tolist() == choose_all(Alone(policy), decisions, others).tolist()
    assert [a.random() for a in own] == [b.random() for b in others]
