from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.rl.policy import GreedyPolicy
from relforest.rl.refinement import BeamSearch, SearchingPolicy
from relforest.rl.rollout import rollout
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.smdp import Decision, check_refined
from relforest.support.errors import InputError
from rl.small_worlds import Proposing


class Rightmost:
    """What lies farther to the right is worth more; waiting is worth a lot."""

    def __init__(self, waiting: float = 100.0) -> None:
        self.waiting = waiting

    def values(self, decision: Decision) -> FloatArray:
        places = decision.objects[decision.arguments[:, 1], 0]
        return np.where(decision.types == 0, self.waiting, places)


def begun(places: list[float], things: int = 2) -> Proposing:
    world = Proposing(things)
    world.reset(seed=0)
    world.places = np.array(places)
    return world


def test_a_beam_asks_near_the_best_places_and_not_twice_about_the_same() -> None:
    world = begun([0.1, 0.4, 0.3, 0.2])
    found = BeamSearch(width=2, rounds=2).refined(world.decision(), Rightmost(), world.refine)
    # 0.4 and 0.3 are at positions 2 and 3; they give 0.45 and 0.35. The best are 0.45 and 0.4 then, and only
    # the first of them, at position 5, has not been refined.
    assert world.asked == [[2, 3], [5]]
    np.testing.assert_allclose(found.objects[2:, 0], [0.1, 0.4, 0.3, 0.2, 0.45, 0.35, 0.5])
    # They move the things that the places they are near to are for.
    assert found.arguments[5:].tolist() == [[0, 6], [1, 7], [0, 8]]


def test_equal_values_are_refined_in_order() -> None:
    world = begun([0.3, 0.3, 0.3, 0.3])
    BeamSearch(width=2, rounds=1).refined(world.decision(), Rightmost(), world.refine)
    assert world.asked == [[1, 2]]


def test_a_beam_ends_when_nothing_new_is_proposed() -> None:
    world = begun([0.1, 0.4, 0.3, 0.2])
    found = BeamSearch(width=9, rounds=100).refined(world.decision(), Rightmost(), world.refine)
    # 0.15, 0.45, 0.35, 0.25; one more, which is all that the world offers; nothing near that one.
    assert [len(asked) for asked in world.asked] == [4, 4, 1]
    assert len(found) == 1 + 4 + Proposing.EXTRA


def test_a_beam_asks_nothing_where_no_action_aims_at_a_place() -> None:
    alone = replace(begun([0.1] * 4).decision(), n_private=0)

    def never(positions: IntArray) -> Decision:
        raise AssertionError(positions)

    assert BeamSearch().refined(alone, Rightmost(), never) is alone
    offered = begun([0.1] * 4).decision()
    assert BeamSearch(rounds=0).refined(offered, Rightmost(), never) is offered


@given(st.integers(1, 6), st.integers(0, 4), st.integers(0, 2**32 - 1))
def test_a_refined_decision_keeps_what_was_offered_and_is_always_the_same(
    width: int, rounds: int, seed: int
) -> None:
    found = []
    for _ in range(2):
        world = begun(np.random.default_rng(seed).random(6).tolist(), things=3)
        before = world.decision()
        found.append(BeamSearch(width, rounds).refined(before, Rightmost(), world.refine))
        check_refined(before, found[-1])
        # It never gets worse.
        assert Rightmost(0.0).values(found[-1]).max() >= Rightmost(0.0).values(before).max()
    for name in ("objects", "types", "arguments", "indices"):
        np.testing.assert_array_equal(getattr(found[0], name), getattr(found[1], name))


def test_experience_holds_what_a_search_has_found() -> None:
    world, value = Proposing(2), Rightmost(0.0)
    policy = SearchingPolicy(GreedyPolicy(value), value, world, BeamSearch(1, 2))
    played = rollout(world, policy, 2, np.random.SeedSequence(1))
    # Three decisions of 1 + 4 + 2 actions in each episode; nobody searches when it is over.
    assert np.diff(played.candidates).tolist() == [7, 7, 7, 5] * 2
    # The last one, two steps to the right of the best that was offered, was taken.
    assert (played.actions - played.candidates[played.states]).tolist() == [6] * 6
    again = rollout(world, policy, 2, np.random.SeedSequence(1))
    assert again.matrix.tobytes() == played.matrix.tobytes()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"width": 0}, "width must be an integer from 1"),
        ({"rounds": -1}, "rounds must be an integer from 0 to 100, got -1"),
        ({"rounds": 101}, "rounds must be an integer from 0 to 100, got 101"),
        ({"width": 2.5}, "width must be an integer"),
    ],
)
def test_options_out_of_range_are_errors(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        BeamSearch(**options)


def place(x: float) -> Callable[[Decision], Decision]:
    """Return a change of a decision: its last object is at x."""

    def changed(decision: Decision) -> Decision:
        objects = decision.objects.copy()
        objects[-1] = x
        return replace(decision, objects=objects)

    return changed


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda now: replace(now, types=now.types[::-1]), "must keep types of earlier actions"),
        (lambda now: replace(now, indices=now.indices[::-1]), "must keep indices of earlier"),
        (lambda now: replace(now, arguments=now.arguments[::-1]), "must keep arguments"),
        (lambda now: replace(now, objects=now.objects[::-1]), "must keep objects"),
        (lambda now: replace(now, n_private=3), "must keep the shared objects"),
        (lambda now: replace(now, remaining=3), "the number of remaining actions"),
        (place(np.inf), "must add finite places"),
        (place(np.nan), "one that is infinite or undefined"),
        (lambda now: replace(now, indices=np.array([0, 1, 2, 3, 4, 4])), "a number of its own"),
        (
            lambda now: replace(now, arguments=np.append(now.arguments[:-1], [[0, 2]], axis=0)),
            "must bind one of the private objects that it adds",
        ),
    ],
)
def test_a_world_that_breaks_the_rules_is_named_with_the_rule(
    change: Callable[[Decision], Decision], message: str
) -> None:
    class Careless(Proposing):
        def refine(self, positions: IntArray) -> Decision:
            return change(super().refine(positions))

    world = Careless(2)
    world.reset(seed=0)
    policy = SearchingPolicy(GreedyPolicy(Rightmost()), Rightmost(), world, BeamSearch(1, 1))
    with pytest.raises(InputError, match=message):
        policy.choose(world.decision(), np.random.default_rng(0))
