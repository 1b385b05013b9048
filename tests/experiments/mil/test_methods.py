from __future__ import annotations

import pytest

from experiments.mil.fakes import FAKES, Threshold
from relforest.experiments.mil.methods import COVAGG, IMPROVED, METHODS, PEERS
from relforest.support.rng import seed_sequence


@pytest.mark.parametrize("name", METHODS)
def test_every_method_can_be_made_anew(name: str) -> None:
    method = METHODS[name]
    parameters = {"C": 10.0, "gamma_factor": 0.5} if method.is_tuned else {}
    one, same, other = (method.learner(seed_sequence(seed), parameters) for seed in (1, 1, 2))

    assert one is not same
    found = [learner.get_params() for learner in (one, same, other)]
    assert found[0] == found[1]
    if "random_state" in found[0]:
        assert found[0]["random_state"] != found[2]["random_state"]
    if method.is_tuned:
        assert (found[0]["C"], found[0]["gamma_factor"]) == (10.0, 0.5)


def test_parameters_reach_the_learner() -> None:
    learner = FAKES["miles-tuned"].learner(seed_sequence(0), {"C": 3.0, "gamma_factor": 2.0})

    assert isinstance(learner, Threshold)
    assert learner.threshold == 6.0


def test_methods_are_told_apart() -> None:
    assert len({method.key for method in METHODS.values()}) == len(METHODS)
    assert len({method.title for method in METHODS.values()}) == len(METHODS)
    assert not {COVAGG, IMPROVED} & set(PEERS)
    assert len(PEERS) == 8
