from __future__ import annotations

from typing import Any

import pytest

from relforest.checking import Situation, check_model
from relforest.models import Model
from relforest.support.errors import InputError
from small_trees import near_tree, plane

# .9 if some B is within 3 of A, otherwise .1; .3 without any B.
MEETS = Model(near_tree(plane("A")), "tree", "meets", (False, True), None)
NEAR = ({"id": "a", "location": [0, 0]}, {"id": "b", "location": [0, 2]}, {"id": "c", "location": [9, 9]})


def faults(model: Model, **expect: Any) -> tuple[str, ...]:
    (verdict,) = check_model(model, [Situation("they meet", NEAR, expect, {"arguments": {"A": "a"}})])
    return verdict.faults


def test_columns_of_predictions_are_compared() -> None:
    assert faults(MEETS, predicted=True, leaf=0, witness_A="a", witness_B="b") == ()
    assert faults(MEETS, probability={"at_least": 0.9, "at_most": 0.9}) == ()
    first, second, why = faults(MEETS, predicted=False, probability={"at_most": 0.5, "at_least": 0})
    assert first == "predicted is True, expected False"
    assert second == "probability is 0.9, expected at most 0.5 and at least 0"
    assert why.startswith("meets = True\nThe probability of meets = True is 0.90, ")
    assert "(A = a, B = b)" in why
    assert "meets = False would be predicted." in why


def test_an_object_that_is_not_there_is_undefined() -> None:
    situation = Situation("it is alone", NEAR[:1], {"witness_B": "a"}, {"arguments": {"A": "a"}})
    (verdict,) = check_model(MEETS, [situation])
    assert verdict.faults[0] == "witness_B is undefined, expected a"
    assert str(verdict).startswith(
        "FAILED  it is alone\n        witness_B is undefined, expected a\n        "
    )


def test_classes_of_several_types_are_compared_as_they_are_written() -> None:
    mixed = Model(near_tree(plane("A")), "tree", "meets", (0, "yes"), None)
    assert faults(mixed, predicted="yes") == ()
    with pytest.raises(InputError, match="predicted must be one of 0, yes, got 0"):
        faults(mixed, predicted=0)


@pytest.mark.parametrize(
    ("expect", "said"),
    [
        ({"predicted": 1}, "predicted must be one of False, True, got 1"),
        ({"leaf": 3}, "leaf must be one of 0, 1, 2, got 3"),
        ({"witness_B": "d"}, "witness_B must be one of a, b, c, got 'd'"),
        ({"prediction": 1.0}, "it expects 'prediction', but the model says probability, predicted, leaf, "),
        ({"probability": 0.9}, "probability needs bounds, such as {at_least = 0.5, at_most = 1.0}, got 0.9"),
        ({"probability": {}}, "probability needs bounds"),
        ({"probability": {"over": 0.5}}, "probability needs bounds"),
        ({"probability": {"at_least": True}}, "probability needs bounds"),
        ({"probability": {"at_least": [0.5]}}, "probability needs bounds"),
    ],
)
def test_what_a_model_could_never_say_is_refused(expect: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as caught:
        faults(MEETS, **expect)
    assert str(caught.value).startswith(f"situation 'they meet': {said}")


@pytest.mark.parametrize(
    ("objects", "fields", "said"),
    [
        (
            NEAR,
            {"actions": []},
            "'actions' is not understood here: write name, objects, arguments, relations",
        ),
        (NEAR, {"arguments": {"A": "d"}}, "argument 'A' of scene 'they meet' is 'd'"),
        (NEAR, {"relations": {"touches": []}}, "unknown relation 'touches'"),
        ([{"id": "a", "location": [0, 0, 0]}], {}, "object 'a': 'location' has 3 components"),
        ([{"id": "a", "location": [0, 10**400]}], {}, "'location' is infinite"),
        ([{"id": "a", "size": 1}], {}, "unknown attribute 'size'"),
    ],
)
def test_scenes_that_do_not_fit_are_refused(objects: Any, fields: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as caught:
        check_model(MEETS, [Situation("they meet", objects, {"leaf": 0}, fields, "meet.toml")])
    assert str(caught.value).startswith("meet.toml, situation 'they meet': ")
    assert said in str(caught.value)
