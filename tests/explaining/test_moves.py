from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from relforest.explaining import Move, smallest_move
from relforest.explaining.moves import moved, region_of, single
from relforest.models import Model
from relforest.scenes import Attribute, Scenes, Schema
from relforest.support.errors import InputError
from small_trees import near_tree, plane, scenes_in

PAIRS = plane("A")
NEAR = Model(near_tree(PAIRS), "tree", "meets", (False, True), None)


def scene(*places: tuple[float, float]) -> Scenes:
    return scenes_in(PAIRS, [places], [[0]])


def found(move: Move | None) -> Move:
    assert move is not None
    return move


def test_the_move_ends_where_the_volume_begins() -> None:
    # B is 5 away and must be within 3; whether A or B moves is the same.
    move = found(smallest_move(NEAR, scene((0.0, 0.0), (5.0, 0.0))))

    assert move.predicted is True
    assert move.distance == pytest.approx(2.0, rel=2e-3)
    assert move.scene.matrix[move.row] == pytest.approx(move.end)


def test_of_several_objects_the_one_that_must_move_least_is_found() -> None:
    move = found(smallest_move(NEAR, scene((0.0, 0.0), (9.0, 1.0), (0.0, -4.0))))

    assert move.row in {0, 2}
    assert move.distance == pytest.approx(1.0, rel=5e-3)


@settings(max_examples=8, deadline=None)
@given(st.lists(st.tuples(st.floats(-9, 9), st.floats(-9, 9)), min_size=2, max_size=4))
def test_the_class_turns_at_the_end_and_not_before(places: list[tuple[float, float]]) -> None:
    move = smallest_move(NEAR, given_scene := scene(*places))

    if move is not None:
        here, shorter = (
            NEAR.predictions(each)
            for each in (given_scene, moved(given_scene, np.array([move.row]), move.shorter[None]))
        )
        assert NEAR.predictions(move.scene).predicted[0] == move.predicted != here.predicted[0]
        assert shorter.predicted[0] == here.predicted[0]


def test_the_order_of_objects_does_not_matter() -> None:
    places = [(0.0, 0.0), (9.0, 1.0), (0.0, -4.0)]
    one = found(smallest_move(NEAR, scene(*places)))
    other = found(smallest_move(NEAR, scenes_in(PAIRS, [places[::-1]], [[2]])))

    assert one.distance == pytest.approx(other.distance, rel=5e-3)


def test_nothing_is_found_where_nothing_turns() -> None:
    assert smallest_move(NEAR, scene((0.0, 0.0), (5.0, 0.0)), within=[[4.9, -0.1], [5.1, 0.1]]) is None


def test_copies_differ_in_one_object_only() -> None:
    given_scene = single(scenes_in(PAIRS, [[(7.0, 7.0)], [(0.0, 0.0), (1.0, 2.0)]], [[0], [1]]).take([1]))
    copies = moved(given_scene, np.array([0, 1]), np.array([[5.0, 6.0], [8.0, 9.0]]))

    places = [[record["location"] for record in each["objects"]] for each in copies.to_dicts()]
    assert places == [[[5.0, 6.0], [1.0, 2.0]], [[0.0, 0.0], [8.0, 9.0]]]
    assert [each["arguments"] for each in copies.to_dicts()] == 2 * [given_scene.to_dicts()[0]["arguments"]]


def test_the_region_is_that_of_the_objects_and_some_room() -> None:
    assert region_of(scene((0.0, 1.0), (10.0, 5.0))).tolist() == [[-2.0, -1.0], [12.0, 7.0]]
    assert region_of(scene((0.0, 1.0), (10.0, 5.0)), [[0, 0], [4, 4]]).tolist() == [[0.0, 0.0], [4.0, 4.0]]


@pytest.mark.parametrize(
    ("within", "said"),
    [
        ([[0, 0], [0, 1]], "2 lower and then 2 upper bounds"),
        ([[0, 0]], "2 lower and then 2 upper bounds"),
        ([[0, 0], [np.nan, 1]], "2 lower and then 2 upper bounds"),
        ([[20, 0], [30, 1]], "lies outside the scene"),
    ],
)
def test_regions_that_do_not_fit_are_refused(within: list[list[float]], said: str) -> None:
    with pytest.raises(InputError, match=said):
        smallest_move(NEAR, scene((0.0, 1.0), (10.0, 5.0)), within=within)


def test_scenes_without_places_are_refused() -> None:
    with pytest.raises(InputError, match="no object of the scene has a place"):
        smallest_move(NEAR, scene((np.nan, 0.0)))
    with pytest.raises(InputError, match="a single scene, got 2"):
        smallest_move(NEAR, scenes_in(PAIRS, [[(0.0, 0.0)], [(0.0, 0.0)]], [[0], [0]]))
    weights = Scenes.from_dicts([{"objects": [{"weight": 2.0}]}], schema=Schema([Attribute("weight")]))
    with pytest.raises(InputError, match="no attribute of weight is a location"):
        region_of(weights)
