from __future__ import annotations

import numpy as np
import pytest

from relforest.forests import Condition
from relforest.forests.statements import Bound, Near, Statement
from relforest.mappings import Mapping
from relforest.rl.action_scenes import action_scenes
from relforest.rl.experience import Experience
from relforest.rl.fitted.additive import Sum
from relforest.rl.fitted.questions import Question, measured
from relforest.rl.fitted.value import QValue
from relforest.rl.fitted.view import View
from relforest.rl.policy import RandomPolicy
from relforest.rl.rollout import rollout
from relforest.scenes import Schema
from relforest.scenes.arrays import FloatArray
from relforest.smdp import NO_LIMIT, Decisions
from rl.small_worlds import LOCATION, REACH_SCHEMA, REACHING_TYPES, SCHEMA, Reaching

KNOTS, HEIGHTS = (-0.2, 0.0, 0.1, 0.3, 0.6), (1.0, -2.0, 0.5, 0.0, 3.0)
RIGHT = Condition(1, (Statement(Mapping("identity", LOCATION), (0,), Bound(0, "at least", 0.6)),))
BESIDE = Condition(1, (Statement(Mapping("difference", LOCATION), (1, 2), Near(0, (0.0,), (0.1,))),))


def value(base: int | None) -> QValue:
    questions = ((Question(RIGHT, KNOTS, HEIGHTS),), (Question(BESIDE, KNOTS, HEIGHTS),))
    learned = Sum((SCHEMA, REACH_SCHEMA), base, (0.5, -0.25), questions)
    return QValue(View(SCHEMA, ()), REACHING_TYPES, learned)


def decisions_of(experience: Experience) -> Decisions:
    return Decisions(
        experience.matrix,
        experience.objects,
        experience.private,
        experience.remaining,
        experience.candidates,
        experience.types,
        experience.arguments,
        np.zeros_like(experience.types),
    )


def from_scenes(found: QValue, experience: Experience) -> FloatArray:
    """Return the values of all candidates by way of scenes."""
    learned, states = found.learned, np.arange(experience.n_states)
    owner = np.repeat(states, np.diff(experience.candidates))
    out = np.empty(len(owner))
    for number, (packed, action_type) in enumerate(zip(learned.packed, REACHING_TYPES, strict=True)):
        own = np.flatnonzero(experience.types == number)
        scenes = action_scenes(experience, own, Schema(SCHEMA.attributes, action_type.parameters))
        out[own] = learned.worth(number, measured(packed, scenes), None)
    if learned.base is not None:
        for state in states:
            mine, base = owner == state, experience.types == learned.base
            out[mine & ~base] += out[mine & base][0]
    return out


@pytest.mark.parametrize("base", [None, 0])
def test_values_of_many_decisions_are_those_of_their_scenes(base: int | None) -> None:
    experience, found = rollout(Reaching(3), RandomPolicy(), 3, np.random.SeedSequence(2)), value(base)
    decisions = decisions_of(experience)
    values = found.values_all(decisions)
    assert len(set(values.tolist())) > 20
    np.testing.assert_array_equal(values, from_scenes(found, experience))
    np.testing.assert_array_equal(values, np.concatenate([found.values(each) for each in decisions]))


def test_states_without_the_base_action_are_worth_what_their_questions_say() -> None:
    experience = rollout(Reaching(2), RandomPolicy(), 1, np.random.SeedSequence(2))
    for each in decisions_of(experience):
        without = Decisions(
            each.objects,
            np.array([0, each.n_objects]),
            np.array([each.n_private]),
            np.array([NO_LIMIT]),
            np.array([0, len(each) - 1]),
            each.types[1:],
            each.arguments[1:],
            each.indices[1:],
        )
        expected = value(None).values(each)[1:]
        np.testing.assert_array_equal(value(0).values_all(without), expected)
