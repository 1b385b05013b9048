from __future__ import annotations

import numpy as np

from relforest.rl.policy import EpsilonGreedyPolicy, GreedyPolicy, RandomPolicy
from relforest.rl.practice import ANYHOW, Practice
from relforest.rl.refinement import BeamSearch, SearchingPolicy
from relforest.scenes.arrays import FloatArray
from relforest.smdp import Decision
from rl.small_worlds import Picking, Proposing


class Nothing:
    def values(self, decision: Decision) -> FloatArray:
        return np.zeros(len(decision))


class Waits:
    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        del decision, rng
        return 0


def test_before_anything_is_known_others_act() -> None:
    practice = Practice(explorer=Waits())
    assert isinstance(practice.trainee(Picking(), None, 0.1), Waits)
    assert practice.tested(Picking(), None) == RandomPolicy()


def test_in_training_the_explorer_acts_now_and_then_and_in_tests_nobody_explores() -> None:
    value, explorer = Nothing(), Waits()
    trainee = Practice(explorer=explorer).trainee(Picking(), value, 0.1)
    assert trainee == EpsilonGreedyPolicy(GreedyPolicy(value), 0.1, explorer)
    assert Practice(explorer=explorer).tested(Picking(), value) == GreedyPolicy(value)


def test_in_worlds_that_propose_actions_policies_search_as_soon_as_something_is_known() -> None:
    world, value, beam = Proposing(), Nothing(), BeamSearch(3, 1)
    found = Practice(search=beam).tested(world, value)
    assert isinstance(found, SearchingPolicy)
    assert (found.policy, found.world, found.search) == (GreedyPolicy(value), world, beam)
    assert isinstance(Practice(search=beam).trainee(world, value, 0.1), SearchingPolicy)
    assert ANYHOW.tested(world, None) == RandomPolicy()
    assert Practice(search=None).tested(world, value) == GreedyPolicy(value)


def test_a_configuration_names_what_differs() -> None:
    assert ANYHOW.to_dict(Picking()) == {}
    assert ANYHOW.to_dict(Proposing()) == {"practice": {"search": {"width": 5, "rounds": 2}}}
    practice = Practice(Picking(), Waits(), search=None)
    assert practice.to_dict(Proposing()) == {"practice": {"training": {}, "explorer": "Waits"}}
