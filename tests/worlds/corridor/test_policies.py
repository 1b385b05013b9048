from __future__ import annotations

import numpy as np
import pytest

from relforest.smdp import Decision
from relforest.support.errors import InputError
from relforest.worlds.corridor import LEFT, RIGHT, CorridorState, OptimalPolicy, RandomPolicy
from relforest.worlds.corridor.env import CorridorEnv
from relforest.worlds.corridor.scene import decision


@pytest.mark.parametrize(
    ("x", "best"), [(0.0, LEFT), (np.nextafter(0.5, 0.0), LEFT), (0.5, RIGHT), (1.0, RIGHT)]
)
def test_the_best_policy_walks_to_the_nearer_edge(x: float, best: int) -> None:
    choices = decision(CorridorState(x))
    assert choices.types[OptimalPolicy().choose(choices, np.random.default_rng(0))] == best


def test_the_best_policy_finds_its_action_wherever_it_stands_in_the_decision() -> None:
    one = decision(CorridorState(0.2))
    turned = Decision(one.objects, one.types[::-1], one.arguments, one.indices[::-1])
    assert OptimalPolicy().choose(turned, np.random.default_rng(0)) == 1


def test_the_random_policy_is_uniform_and_reproducible() -> None:
    choices = decision(CorridorState(0.2))
    rng, again = np.random.default_rng(3), np.random.default_rng(3)
    chosen = [RandomPolicy().choose(choices, rng) for _ in range(2000)]
    # Binomial(2000, 1/2): mean 1000, standard deviation sqrt(500) = 22.4; 4 of them = 89.
    assert abs(sum(chosen) - 1000) < 89
    assert chosen == [RandomPolicy().choose(choices, again) for _ in range(2000)]


def test_the_best_policy_earns_its_reward_in_the_environment() -> None:
    env, rng, policy = CorridorEnv(), np.random.default_rng(0), OptimalPolicy()
    totals = []
    env.reset(seed=1)
    for _ in range(300):
        total, truncated = 0.0, False
        while not truncated:
            choices = env.decision()
            _, paid, _, truncated, _ = env.step(choices.indices[policy.choose(choices, rng)])
            total += paid
        totals.append(total)
        env.reset()
    error = np.std(totals, ddof=1) / np.sqrt(len(totals))
    assert np.mean(totals) == pytest.approx(8.69, abs=4 * error)


@pytest.mark.parametrize("policy", [OptimalPolicy(), RandomPolicy()])
def test_no_policy_chooses_when_there_is_nothing_to_choose(policy: OptimalPolicy | RandomPolicy) -> None:
    whole = decision(CorridorState(0.2))
    none = Decision(whole.objects, whole.types[:0], whole.arguments[:0], whole.indices[:0])
    with pytest.raises(InputError, match="the decision offers no action"):
        policy.choose(none, np.random.default_rng(0))
