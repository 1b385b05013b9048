from __future__ import annotations

from typing import final

import numpy as np
import pytest

from relforest.playing.reasons import Reason
from relforest.rl.explaining import AS_SUCH, Explaining, Key, Part, Told, explanation
from relforest.rl.policy import RandomPolicy
from relforest.rl.rollout import rollout
from relforest.rl.settings import FEATURE_MODES, FeatureMode
from relforest.rl.value import ValueFunction, forest_features
from relforest.scenes import Scenes
from relforest.scenes.arrays import FloatArray
from relforest.smdp import Decision
from rl.fitted.test_value import decisions_of, value
from rl.small_worlds import ACTION_TYPES, PICK_SCHEMA, SCHEMA, Picking, Reaching, beside, near


@final
class Known:
    """Three actions: two of type 0, one of type 1; all that adds up is written down."""

    PARTS: tuple[dict[Key, float], ...] = (
        {(0, AS_SUCH): 1.0, (0, 0): 3.0, (0, 1): -0.5, (0, 2): 0.25},
        {(0, AS_SUCH): 1.0, (0, 0): 1.0, (0, 1): 0.5, (0, 2): 0.25},
        {(1, AS_SUCH): 0.5, (1, 0): 2.5},
    )

    def values(self, decision: Decision) -> FloatArray:  # noqa: ARG002
        return np.array([sum(parts.values()) for parts in self.PARTS])

    def parts(self, decision: Decision, position: int) -> list[Part]:  # noqa: ARG002
        return [Part(*each) for each in self.PARTS[position].items()]

    def tell(self, decision: Decision, position: int, key: Key) -> Told:  # noqa: ARG002
        if key == (0, 1):
            return Told(f"answer of {position}")
        return Told(f"question {key}", f"stands for {position}", (("C", position),))


DECISION = Decision(np.zeros((3, 1)), np.array([0, 0, 1]), np.empty((3, 0), dtype=np.int64), np.arange(3))


def test_reasons_are_what_differs_from_the_best_other_action() -> None:
    # Values are 3.75, 2.75 and 3.0: the best other action than 1 is 0.
    found = explanation(Known(), DECISION, 1)
    assert found is not None
    assert (found.rival, found.lead, found.n_others, found.rest) == (0, -1.0, 0, 0.0)
    assert found.reasons == (
        Reason(-2.0, "question (0, 0)", "stands for 1", "stands for 0", witnesses=(("C", 1),)),
        Reason(1.0, "answer of 1", "", "answer of 0"),
    )


def test_what_only_one_of_two_types_has_is_told_about_that_one() -> None:
    found = explanation(Known(), DECISION, 0, most=1)
    assert found is not None
    # 3.75 - 3.0; of +3, +.5 (1 as such, less .5) and +.25 the first is told, of -.5 and -2.5 the last.
    assert (found.rival, found.lead, found.n_others) == (2, 0.75, 3)
    assert [(each.adds, each.says, each.of_rival) for each in found.reasons] == [
        (3.0, "question (0, 0)", False),
        (-2.5, "question (1, 0)", True),
    ]
    assert found.reasons[1].witnesses == (("C", 2),)
    assert found.rest == pytest.approx(0.25)


def test_an_action_without_an_alternative_needs_no_reasons() -> None:
    only = Decision(np.zeros((1, 1)), np.array([0]), np.empty((1, 0), dtype=np.int64), np.array([0]))
    assert explanation(Known(), only, 0) is None


def check_sums(found: Explaining, decision: Decision) -> None:
    """The parts add up to the values, and the reasons and the rest to the difference of values."""
    values = found.values(decision)
    for position in range(len(decision)):
        parts = found.parts(decision, position)
        assert len({part.key for part in parts}) == len(parts)
        assert sum(part.adds for part in parts) == pytest.approx(values[position], abs=1e-9)
        why = explanation(found, decision, position, most=1)
        assert why is not None
        lead = values[position] - np.delete(values, position).max()
        assert (why.lead, sum(each.adds for each in why.reasons) + why.rest) == pytest.approx((lead, lead))


@pytest.mark.parametrize("base", [None, 0])
def test_the_parts_of_a_sum_add_up(base: int | None) -> None:
    for decision in decisions_of(rollout(Reaching(3), RandomPolicy(), 2, np.random.SeedSequence(4))):
        check_sums(value(base), decision)


@pytest.mark.parametrize("mode", FEATURE_MODES)
def test_the_parts_of_a_linear_value_are_weighted_features(mode: FeatureMode) -> None:
    rng, forests = np.random.default_rng(0), ((near(SCHEMA),), (near(PICK_SCHEMA), beside()))
    nothing = Scenes(
        PICK_SCHEMA,
        np.zeros((1, 1)),
        np.zeros(1, int),
        np.zeros(1, int),
        np.ones(1, int),
        np.zeros((1, 1), int),
    )
    plain = Scenes(SCHEMA, *nothing.parts[1:5])
    widths = [
        forest_features(trees, scenes, mode).shape[1]
        for trees, scenes in zip(forests, (plain, nothing), strict=True)
    ]
    found = ValueFunction(SCHEMA, ACTION_TYPES, mode, forests, tuple(rng.normal(size=n) for n in widths))
    for decision in decisions_of(rollout(Picking(3), RandomPolicy(), 2, np.random.SeedSequence(4))):
        if len(decision) > 1:
            check_sums(found, decision)


def test_a_tree_is_told_by_its_answers_and_the_objects_bound() -> None:
    found = ValueFunction(SCHEMA, ACTION_TYPES, "bits", ((), (beside(),)), (np.zeros(1), np.arange(6.0)))
    things = np.array([[0.9], [0.5], [0.45]])
    numbers = np.arange(4)
    decision = Decision(things, np.minimum(numbers, 1), numbers[:, None] - 1, numbers)
    # Thing 1 has another one beside it, which is near .5: leaf 0, weight 1.
    told = found.tell(decision, 2, (1, 0))
    assert told.witnesses == (("A", 1), ("B", 2))
    assert "B" in told.says
    assert found.parts(decision, 2) == [Part((1, AS_SUCH), 0.0), Part((1, 0), 1.0)]
    assert found.tell(decision, 2, (1, AS_SUCH)) == Told("pick as such")
