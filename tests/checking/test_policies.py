from __future__ import annotations

from collections.abc import Mapping
from itertools import permutations
from typing import Any

import numpy as np
import pytest

from relforest.checking import Situation, check_policy
from relforest.rl.value import ValueFunction
from relforest.smdp import UNBOUND
from relforest.support.errors import InputError
from rl.fitted.test_value import value as fitted_value
from rl.small_worlds import ACTION_TYPES, PICK_SCHEMA, SCHEMA, Reaching, near

# To wait is worth .5, to pick .9 what is near .25, and .2 anything else.
PICKING = ValueFunction(
    SCHEMA,
    ACTION_TYPES,
    "probability",
    ((), (near(PICK_SCHEMA),)),
    (np.array([0.5]), np.array([0.0, 1.0])),
)
OBJECTS = ({"id": "a", "location": 0.8}, {"id": "b", "location": 0.2}, {"id": "c", "location": 0.3})
ACTIONS = [["wait"], ["pick", "a"], ["pick", "b"]]


def faults(expect: Mapping[str, Any], **fields: Any) -> tuple[str, ...]:
    (verdict,) = check_policy(PICKING, [Situation("it acts", OBJECTS, expect, {"actions": ACTIONS} | fields)])
    return verdict.faults


@pytest.mark.parametrize(
    "expect",
    [
        {"chosen": ["pick", "b"]},
        {"chosen": ["pick"]},
        {"avoided": ["wait"]},
        {"avoided": ["pick", "a"]},
        {"better": ["wait"], "than": ["pick", "a"]},
        {"better": ["pick"], "than": ["wait"], "chosen": ["pick", "b"]},
    ],
)
def test_what_is_worth_more_holds(expect: dict[str, Any]) -> None:
    assert faults(expect) == ()


def test_faults_tell_what_is_worth_more_and_why() -> None:
    (fault,) = faults({"chosen": ["wait"]})
    assert fault.startswith("expected: chosen wait; but pick(b) is worth 0.40 more than wait; for it: ")
    assert "; against it: " in fault

    assert len(faults({"chosen": ["pick", "a"], "avoided": ["pick"]})) == 2
    (fault,) = faults({"better": ["pick", "a"], "than": ["wait"]})
    assert fault.startswith("expected: better pick(a) than wait; but wait is worth 0.30 more than pick(a)")
    # What is worth the same is chosen at random.
    assert faults({"chosen": ["pick", "b"]}, actions=[*ACTIONS, ["pick", "c"]]) != ()


def test_actions_see_no_places_but_their_own() -> None:
    value, world = fitted_value(None), Reaching()
    for seed in range(5):
        world.reset(seed=seed)
        decision = world.decision()
        objects = [{"id": row, "location": place} for row, (place,) in enumerate(decision.objects.tolist())]
        names = [each.name for each in world.action_types]
        actions = [
            [names[number], *(row for row in bound if row != UNBOUND)]
            for number, bound in zip(decision.types, decision.arguments.tolist(), strict=True)
        ]
        fields = {"actions": actions, "places": objects[decision.n_shared :], "remaining": 2}
        worth = value.values(decision)
        for first, second in permutations(range(len(actions)), 2):
            expect = {"better": actions[first], "than": actions[second]}
            situation = Situation("it reaches", objects[: decision.n_shared], expect, fields)
            (verdict,) = check_policy(value, [situation])
            assert (verdict.faults == ()) == (worth[first] > worth[second])


@pytest.mark.parametrize(
    ("expect", "fields", "said"),
    [
        (
            {"chosen": ["pick"]},
            {"arguments": {}},
            "'arguments' is not understood here: write name, objects, ",
        ),
        ({"chosen": ["pick"]}, {"actions": None}, "actions must be a list of at least two, got None"),
        ({"chosen": ["wait"]}, {"actions": [["wait"]]}, "actions must be a list of at least two"),
        ({"chosen": ["wait"]}, {"actions": ["wait", "pick"]}, "must be a list that begins with wait, pick, "),
        ({"chosen": ["wait"]}, {"actions": [["wait"], []]}, "must be a list that begins with wait, pick, "),
        ({"chosen": ["wait"]}, {"actions": [["wait"], [["pick"]]]}, "must be a list that begins with wait, "),
        ({"chosen": ["wait"]}, {"actions": [["wait"], ["kick"]]}, "must be a list that begins with wait, "),
        ({"chosen": ["wait"]}, {"actions": [["wait", "a"], ["wait"]]}, "wait(a) must name nothing else, by"),
        ({"chosen": ["wait"]}, {"actions": [["wait"], ["pick", "d"]]}, "name thing, by ids of a, b, c"),
        ({"chosen": ["wait"]}, {"actions": [["wait"], ["pick", ["a"]]]}, "name thing, by ids of a, b, c"),
        ({"chosen": ["wait"]}, {"actions": [["wait"], ["wait"]]}, "action wait is listed twice"),
        ({"chosen": ["wait"]}, {"places": "home"}, "places must be a list of objects, got 'home'"),
        ({"chosen": ["wait"]}, {"places": [{"id": "a"}]}, "object 'a' occurs twice in scene 'it acts'"),
        ({"chosen": ["wait"]}, {"remaining": -1}, "remaining must be"),
        ({"chosen": ["wait"]}, {"remaining": 1.5}, "remaining must be"),
        (
            {"chosen": "wait"},
            {},
            "chosen must be a list that names one of the actions wait, pick(a), pick(b)",
        ),
        ({"chosen": []}, {}, "chosen must be a list that names one of the actions"),
        ({"avoided": ["pick", "c"]}, {}, "avoided must be a list that names one of the actions"),
        ({"predicted": True}, {}, "it expects 'predicted', which is not understood: write chosen, avoided, "),
        ({"better": ["wait"]}, {}, "it expects 'better' or 'than' alone: write both"),
        ({"better": ["pick"], "than": ["pick", "a"]}, {}, "better pick than pick(a) leaves no other action"),
        (
            {"chosen": ["pick"]},
            {"actions": ACTIONS[1:]},
            "chosen pick leaves no other action to compare with",
        ),
    ],
)
def test_what_is_wrong_with_a_situation_is_said(
    expect: dict[str, Any], fields: dict[str, Any], said: str
) -> None:
    with pytest.raises(InputError) as caught:
        faults(expect, **fields)
    assert str(caught.value).startswith("situation 'it acts': ")
    assert said in str(caught.value)
