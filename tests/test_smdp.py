from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from relforest.scenes import Attribute, Schema
from relforest.smdp import NO_LIMIT, Action, ActionType, Decision, Decisions, World, check_decision
from relforest.support.errors import InputError

SCHEMA = Schema((Attribute("location", 2),))
TYPES = (ActionType("wait"), ActionType("pass", ("passer", "receiver")))


def make(**changes: Any) -> Decision:
    """Two objects; wait, or the first passes to the second: numbers 0 and 4 of the flat space."""
    fields: dict[str, Any] = {
        "objects": np.array([[0.0, 1.0], [2.0, np.nan]]),
        "types": np.array([0, 1]),
        "arguments": np.array([[-1, -1], [0, 1]]),
        "indices": np.array([0, 4]),
    }
    return Decision(**(fields | changes))


def test_arity_is_the_number_of_parameters() -> None:
    assert [action_type.arity for action_type in TYPES] == [0, 2]


@pytest.mark.parametrize(
    ("name", "parameters", "message"),
    [
        ("", (), "non-empty strings, got ''"),
        ("pass", ("passer", ""), "non-empty strings, got ''"),
        ("pass", ("passer", 3), "non-empty strings, got 3"),
        ("pass", ("passer", "passer"), "names a parameter twice"),
        ("pass", "passer", "must be a tuple of names"),
    ],
)
def test_action_type_refuses_bad_names(name: str, parameters: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        ActionType(name, parameters)


def test_action_holds_plain_integers_and_compares_by_value() -> None:
    action = Action(np.int64(1), (np.int64(0), np.int64(1)))  # type: ignore[arg-type]  # what kernels hand out
    assert action == Action(1, (0, 1))
    assert type(action.type) is int
    assert [type(argument) for argument in action.arguments] == [int, int]


@pytest.mark.parametrize(("type_", "arguments"), [(-1, ()), (True, ()), (0.0, ()), (0, (-1,)), (0, ("A",))])
def test_action_refuses_what_is_no_position(type_: Any, arguments: Any) -> None:
    with pytest.raises(InputError, match="must be positions"):
        Action(type_, arguments)


def test_decision_counts_and_names_its_actions() -> None:
    decision = make()
    assert (len(decision), decision.n_objects) == (2, 2)
    assert decision.action(0) == Action(0)
    assert decision.action(1) == Action(1, (0, 1))


@pytest.mark.parametrize("position", [-1, 2])
def test_decision_refuses_positions_that_do_not_exist(position: int) -> None:
    with pytest.raises(InputError, match=f"one of the 2 available actions, got {position}"):
        make().action(position)


def test_decision_is_read_only_and_leaves_the_callers_arrays_writeable() -> None:
    objects = np.zeros((2, 2))
    decision = make(objects=objects)
    with pytest.raises(ValueError, match="read-only"):
        decision.objects[0, 0] = 1.0
    objects[0, 0] = 1.0


def test_decision_takes_a_read_only_array_as_it_is() -> None:
    objects = np.zeros((2, 2))
    objects.flags.writeable = False
    assert make(objects=objects).objects is objects


def test_decision_converts_lists_and_narrow_types() -> None:
    decision = make(objects=[[0, 1], [2, 3]], types=np.array([0, 1], dtype=np.int8), indices=[0, 4])
    assert decision.objects.dtype == np.float64
    assert decision.types.dtype == decision.indices.dtype == np.int64
    np.testing.assert_array_equal(decision.objects, [[0.0, 1.0], [2.0, 3.0]])


def test_the_last_objects_may_be_private() -> None:
    assert (make().n_private, make().n_shared) == (0, 2)
    decision = make(n_private=np.int64(1))
    assert (decision.n_objects, decision.n_private, decision.n_shared) == (2, 1, 1)
    assert type(decision.n_private) is int
    check_decision(decision, SCHEMA, TYPES)
    assert make(n_private=2).n_shared == 0


@pytest.mark.parametrize(
    ("n_private", "message"),
    [
        (3, "n_private must be at most 2, the number of objects, got 3"),
        (-1, "n_private must be an integer of at least 0, got -1"),
        (1.0, "n_private must be an integer"),
        (True, "n_private must be an integer"),
    ],
)
def test_no_more_objects_are_private_than_there_are(n_private: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make(n_private=n_private)


def test_a_task_may_limit_how_many_actions_remain() -> None:
    assert make().remaining is None
    decision = make(remaining=np.int64(3))
    assert decision.remaining == 3
    assert type(decision.remaining) is int
    # A time limit is no reason to offer nothing in the last state.
    for remaining in (3, 0):
        check_decision(make(remaining=remaining), SCHEMA, TYPES)
    nothing: dict[str, Any] = {"types": [], "arguments": np.empty((0, 2)), "indices": []}
    check_decision(make(**nothing, remaining=0), SCHEMA, TYPES)
    with pytest.raises(InputError, match="remaining must be 0 in a state without actions, got 3"):
        check_decision(make(**nothing, remaining=3), SCHEMA, TYPES)


@pytest.mark.parametrize("remaining", [-1, 1.0, True, np.inf])
def test_remaining_actions_are_counted(remaining: Any) -> None:
    with pytest.raises(InputError, match="remaining must be an integer of at least 0, got"):
        make(remaining=remaining)


def test_decision_may_offer_no_action() -> None:
    empty = make(types=[], arguments=np.empty((0, 2)), indices=[])
    assert len(empty) == 0
    check_decision(empty, SCHEMA, TYPES)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"objects": np.zeros(2)}, "objects must be a 2-dimensional array of float64, got 1 dimensions"),
        (
            {"objects": [["a", "b"]]},
            "objects must be a 2-dimensional array of float64, got 2 dimensions of <U1",
        ),
        ({"objects": [[0.0], [1.0, 2.0]]}, "objects must be a 2-dimensional array of float64"),
        ({"types": np.array([0.0, 1.0])}, "types must be a 1-dimensional array of int64, got .* float64"),
        ({"types": np.array([0])}, "one entry for each action, got 1, 2 and 2"),
        ({"indices": np.array([0])}, "one entry for each action, got 2, 2 and 1"),
        ({"arguments": np.array([[0, 1]])}, "one entry for each action, got 2, 1 and 2"),
    ],
)
def test_decision_refuses_arrays_of_the_wrong_form(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make(**changes)


def test_check_decision_accepts_a_decision_that_suits_the_world() -> None:
    check_decision(make(), SCHEMA, TYPES)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"objects": np.zeros((2, 3))}, "objects has 3 columns, but the schema of the world has 2"),
        ({"objects": np.full((2, 2), np.inf)}, "infinite value; use NaN"),
        ({"arguments": np.array([[-1], [0]])}, "arguments has 1 columns, .* is 2"),
        ({"indices": np.array([4, 4])}, "distinct and not negative"),
        ({"indices": np.array([-1, 4])}, "distinct and not negative"),
        ({"types": np.array([0, 2])}, "action 1 has type 2, but there are 2 action types"),
        ({"types": np.array([-1, 1])}, "action 0 has type -1"),
        ({"arguments": np.array([[-1, -1], [0, 2]])}, r"action 1 \(pass\) has arguments \[0, 2\]"),
        ({"arguments": np.array([[-1, -1], [0, -1]])}, r"action 1 \(pass\) has arguments \[0, -1\]"),
        ({"arguments": np.array([[0, -1], [0, 1]])}, r"action 0 \(wait\) has arguments \[0, -1\]"),
    ],
)
def test_check_decision_names_what_does_not_suit_the_world(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        check_decision(make(**changes), SCHEMA, TYPES)


def test_world_is_recognised_by_its_members() -> None:
    class Complete:
        schema = SCHEMA
        action_types = TYPES
        discount = 0.9

        def decision(self) -> Decision:
            return make()

    assert isinstance(Complete(), World)
    assert not isinstance(object(), World)


def three() -> list[Decision]:
    """Of two objects, of none and no action, and of three objects, the last one private."""
    nothing = np.empty(0, dtype=np.int64)
    return [
        make(),
        Decision(np.empty((0, 2)), nothing, np.empty((0, 2), dtype=np.int64), nothing, remaining=0),
        make(objects=np.arange(6.0).reshape(3, 2), n_private=1, remaining=5),
    ]


def assert_same(found: Decision, expected: Decision) -> None:
    assert (found.n_private, found.remaining) == (expected.n_private, expected.remaining)
    for name in ("objects", "types", "arguments", "indices"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))


def test_many_decisions_are_columns() -> None:
    expected = three()
    found = Decisions.joined([Decisions.of(expected[:1]), Decisions.of(expected[1:])])
    assert len(found) == 3
    for mine, theirs in zip(found, expected, strict=True):
        assert_same(mine, theirs)
    assert found.n_actions.tolist() == [2, 0, 2]
    assert found.owners.tolist() == [0, 0, 2, 2]
    assert found.remaining.tolist() == [NO_LIMIT, 0, 5]
    with pytest.raises(ValueError, match="read-only"):
        found.matrix[0, 0] = 1.0


@pytest.mark.parametrize("order", [[2, 0, 1], [1], [2, 2], []])
def test_decisions_can_be_taken_in_another_order(order: list[int]) -> None:
    expected = three()
    found = Decisions.of(expected).take(np.array(order, dtype=np.int64))
    assert len(found) == len(order)
    for mine, number in zip(found, order, strict=True):
        assert_same(mine, expected[number])
