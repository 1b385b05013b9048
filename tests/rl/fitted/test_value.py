from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from sklearn.ensemble import ExtraTreesRegressor

from relforest.forests import Condition
from relforest.forests.statements import Bound, Near, Statement
from relforest.mappings import Mapping
from relforest.rl.action_scenes import action_scenes
from relforest.rl.experience import Experience
from relforest.rl.fitted.forest_arrays import ForestArrays, forest_mean, joined
from relforest.rl.fitted.horizon import Horizon
from relforest.rl.fitted.questions import Question, measured, spokesmen
from relforest.rl.fitted.sum import Sum
from relforest.rl.fitted.value import QValue
from relforest.rl.fitted.view import View
from relforest.rl.policy import RandomPolicy
from relforest.rl.rollout import rollout
from relforest.scenes import Schema
from relforest.scenes.arrays import FloatArray
from relforest.smdp import NO_LIMIT, Decision, Decisions
from relforest.support.errors import InputError
from rl.small_worlds import LOCATION, REACH_SCHEMA, REACHING_TYPES, SCHEMA, Reaching

KNOTS, HEIGHTS = (-0.2, 0.0, 0.1, 0.3, 0.6), (1.0, -2.0, 0.5, 0.0, 3.0)
RIGHT = Condition(1, (Statement(Mapping("identity", LOCATION), (0,), Bound(0, "at least", 0.6)),))
BESIDE = Condition(1, (Statement(Mapping("difference", LOCATION), (1, 2), Near(0, (0.0,), (0.1,))),))


def trees_for(*numbers: int) -> ForestArrays:
    """Return two trees of a single distance for each of these action types."""
    rng = np.random.default_rng(1)
    margins, worth = rng.uniform(-0.3, 0.8, (50, 1)), rng.normal(size=50)
    grown: list[list[Any]] = [[], []]
    for number in numbers:
        model = ExtraTreesRegressor(2, random_state=number).fit(margins, worth)
        grown[number] = [tree.tree_ for tree in model.estimators_]
    return joined([grown])


def value(base: int | None, trees: ForestArrays | None = None) -> QValue:
    questions = ((Question(RIGHT, KNOTS, HEIGHTS),), (Question(BESIDE, KNOTS, HEIGHTS),))
    learned = Sum((SCHEMA, REACH_SCHEMA), base, (0.5, -0.25), questions, trees)
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


@pytest.mark.parametrize("trees", [None, trees_for(0, 1), trees_for(1)])
@pytest.mark.parametrize("base", [None, 0])
def test_values_of_many_decisions_are_those_of_their_scenes(
    base: int | None, trees: ForestArrays | None
) -> None:
    experience = rollout(Reaching(3), RandomPolicy(), 3, np.random.SeedSequence(2))
    found = value(base, trees)
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


def test_curves_and_trees_count_alike_and_curves_alone_where_there_are_no_trees() -> None:
    experience, trees = rollout(Reaching(3), RandomPolicy(), 2, np.random.SeedSequence(2)), trees_for(1)
    for decision in decisions_of(experience):
        of_curves, of_both = value(None).values(decision), value(None, trees).values(decision)
        scenes = value(None)._scene(decision, 1)
        margins = measured(value(None).learned.packed[1], scenes).margins
        of_trees = forest_mean(trees, trees.roots[0, 1], np.nan_to_num(margins, nan=1e6).astype(np.float32))
        assert of_both[1] == pytest.approx((of_curves[1] + of_trees[0]) / 2)
        assert of_both[0] == of_curves[0]
        for position in range(len(decision)):
            parts = value(0, trees).parts(decision, position)
            assert sum(adds for _, adds in parts) == pytest.approx(value(0, trees).values(decision)[position])


def test_questions_that_are_left_out_add_what_is_usual() -> None:
    # .135 * 1 + .24 * -2 + .25 * .5 + .24 * 0 + .135 * 3 = .185.
    usual = 0.185
    rare, common = Question(RIGHT, KNOTS, HEIGHTS, 0.5), Question(BESIDE, KNOTS, HEIGHTS, 1.5)
    other = Question(BESIDE, KNOTS, HEIGHTS[::-1], 1.0)
    full = Sum((SCHEMA, REACH_SCHEMA), 0, (0.5, -0.25), ((rare,), (other, common)))
    assert rare.usual == pytest.approx(usual)
    found = QValue(View(SCHEMA, ()), REACHING_TYPES, full).with_questions(1).learned
    assert isinstance(found, Sum)
    assert found.questions == ((), (common,))
    assert found.constants == pytest.approx((0.5 + usual, -0.25 + usual))


def test_questions_about_the_base_are_left_out_first_and_change_no_decision() -> None:
    experience, found = rollout(Reaching(3), RandomPolicy(), 2, np.random.SeedSequence(3)), value(0)
    for decision in decisions_of(experience):
        values, fewer = found.values(decision), found.with_questions(1).values(decision)
        np.testing.assert_allclose(values - values[0], fewer - fewer[0], atol=1e-12)
    trees = trees_for(0, 1)
    both = value(0, trees)
    for decision in decisions_of(experience):
        values, fewer = both.values(decision), both.with_questions(1).values(decision)
        np.testing.assert_allclose(values - values[0], fewer - fewer[0], atol=1e-12)
    assert found.with_questions(2).learned.size == found.learned.size == found.with_questions(9).learned.size


def test_a_question_is_told_with_its_witness() -> None:
    things, places = [0.2, 0.5, 0.9], [0.55, 0.0]
    bound = np.array([[-1, -1], [0, 3], [0, 4]])
    objects = np.array([*things, *places])[:, None]
    decision = Decision(objects, np.array([0, 1, 1]), bound, np.arange(3), n_private=2)
    # The place at .55 is .05 from the thing at .5: nearer to its centre than the radius of .1 by .05.
    told = value(0).tell(decision, 1, (1, 0))
    assert (told.standing, told.witnesses) == ("true", (("", 1),))
    # Of thing and place at .2 and 0., the nearest other thing is .5 away.
    assert value(0).tell(decision, 2, (1, 0)) == (told.says, "off by 0.4", (("", 1),))
    # What is asked about the base is told about the base, whichever action is explained.
    assert value(0).tell(decision, 2, (0, 0)).witnesses == (("", 2),)
    assert value(0).tell(decision, 1, (1, -1)).says == "reach as such"


def test_questions_about_the_same_place_speak_with_one_voice() -> None:
    def beside(centre: float, radius: float, spread: float) -> Question:
        test = Near(0, (centre,), (radius,))
        condition = Condition(1, (Statement(Mapping("difference", LOCATION), (1, 2), test),))
        return Question(condition, KNOTS, HEIGHTS, spread)

    own = (beside(0.0, 0.1, 1.0), beside(0.05, 0.01, 3.0), beside(0.5, 0.1, 2.0), Question(RIGHT, KNOTS))
    assert spokesmen(own) == (1, 1, 2, 3)
    found = QValue(
        View(SCHEMA, ()), REACHING_TYPES, Sum((SCHEMA, REACH_SCHEMA), None, (0.0, 0.0), ((), own[:3]))
    )
    experience = rollout(Reaching(3), RandomPolicy(), 1, np.random.SeedSequence(3))
    for decision in decisions_of(experience):
        parts = dict(found.parts(decision, 1))
        assert parts[1, 0] == 0.0
        assert sum(parts.values()) == pytest.approx(found.values(decision)[1])
    assert found.tell(decision, 1, (1, 1)).says.endswith("(2 questions)")


def test_only_sums_can_do_with_fewer_questions() -> None:
    with pytest.raises(InputError, match="questions must be an integer of at least 0, got -1"):
        value(0).with_questions(-1)
    forests = joined([[[], []]])
    forest = QValue(View(SCHEMA, ()), REACHING_TYPES, Horizon((SCHEMA, REACH_SCHEMA), ((), ()), forests))
    with pytest.raises(InputError, match="questions can only be left out of a sum"):
        forest.with_questions(3)
