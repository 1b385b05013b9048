"""Points of a question at a leaf, and what is left out."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.mappings import Mapping, catalogue
from relforest.scenes import Scenes
from relforest.trees import TreeSettings
from relforest.trees.candidates import Candidate, OpenLeaf, PreparedQuestion, best_candidate, prepare
from relforest.trees.expansions import Expansion
from relforest.trees.probabilities import assign
from relforest.trees.sequences import Sequences, argument_places
from relforest.trees.structure import MAX_VARIABLES
from small_trees import NOWHERE, Place, ball, plane, scenes_in

Booleans = NDArray[np.bool_]


def at_root(scenes: Scenes, max_points: int = 10**6) -> tuple[list[PreparedQuestion], int]:
    mappings = catalogue(scenes.schema)
    return prepare(scenes, argument_places(scenes), Sequences.empty(len(scenes)), mappings, max_points)


def asked(scenes: Scenes, operation: str, variables: tuple[int, ...], n_new: int) -> PreparedQuestion:
    sequences = Sequences.empty(len(scenes))
    for _ in range(n_new):
        sequences = sequences.extended(scenes.counts, argument_places(scenes))
    expansion = Expansion(n_new, Mapping(operation, scenes.schema["location"]), variables)
    return PreparedQuestion(scenes, expansion, sequences, sequences.distinct(variables))


# Two objects 5 apart; one object alone; one of unknown place next to one at (0, 2); nothing.
PLACES: list[list[Place]] = [[(0, 0), (3, 4)], [(1, 0)], [NOWHERE, (0, 2)], []]


def test_points_and_bags_by_hand() -> None:
    question = asked(scenes_in(plane(), PLACES), "identity", (0,), 1)

    assert question.points.tolist() == [[0, 0], [3, 4], [1, 0], [0, 2]]
    assert question.starts.tolist() == [0, 2, 3, 4]
    # The empty scene has no point.
    assert question.bag_scenes.tolist() == [0, 1, 2]
    assert question.rows.tolist() == [[0], [1], [2], [3], [4], [-1]]


def test_pairs_by_hand() -> None:
    question = asked(scenes_in(plane(), PLACES), "distance", (0, 1), 2)

    # Only the first scene has two objects with a place.
    assert question.points.tolist() == [[5], [5]]
    assert question.starts.tolist() == [0, 2]
    assert question.bag_scenes.tolist() == [0]


def test_who_goes_where() -> None:
    scenes = scenes_in(plane(), PLACES)
    question = asked(scenes, "identity", (0,), 1)
    volume = ball([0.0, 0.0], 2.0)
    yes, no, error = question.partition(volume)

    # Inside: (0, 0), (1, 0), (0, 2) on the boundary.
    assert yes.scene.tolist() == [0, 1, 2]
    assert yes.objects.tolist() == [[0], [0], [1]]
    assert (no.scene.tolist(), no.objects.tolist()) == ([0], [[1]])
    assert (error.scene.tolist(), error.objects.tolist()) == ([2, 3], [[0], [-1]])
    assert question.presence(volume).tolist() == [
        [True, True, True, False],
        [True, False, False, False],
        [False, False, True, True],
    ]


def test_presence_agrees_with_the_partition() -> None:
    rng = np.random.default_rng(0)
    places = [
        [tuple(place) for place in rng.normal(size=(n, 2)).tolist()] for n in rng.integers(0, 5, size=20)
    ]
    scenes = scenes_in(plane(), places)
    for operation, variables, centre in [
        ("identity", (1,), [0.0, 0.0]),
        ("distance", (0, 2), [1.0]),
        ("reframe", (2, 0, 1), [0.0, 0.5]),
        ("scaled_reframe", (0, 1, 2), [0.5, 0.0]),
    ]:
        question = asked(scenes, operation, variables, 3)
        volume = ball(centre, 1.0)
        presence = question.presence(volume)
        parts = question.partition(volume)
        assert sum(len(part) for part in parts) == len(question.sequences)
        for part, there in zip(parts, presence, strict=True):
            assert np.unique(part.scene).tolist() == np.flatnonzero(there).tolist()


def test_every_expansion_is_prepared() -> None:
    rng = np.random.default_rng(0)
    scenes = scenes_in(
        plane(), [[tuple(place) for place in rng.normal(size=(3, 2)).tolist()] for _ in range(2)]
    )
    questions, left_out = at_root(scenes)

    assert left_out == 0
    assert [question.expansion.n_new for question in questions] == [1] + [2] * 2 + [3] * 9


@pytest.mark.parametrize(
    ("max_points", "n_prepared", "n_left_out"),
    [
        # 2 scenes of 4 objects: 8 single objects, 24 pairs, 48 triples; 1, 2 and 9 expansions.
        (7, 0, 12),
        (8, 1, 11),
        (23, 1, 11),
        (24, 3, 9),
        (47, 3, 9),
        (48, 12, 0),
    ],
)
def test_expansions_with_too_many_points_are_counted(
    max_points: int, n_prepared: int, n_left_out: int
) -> None:
    rng = np.random.default_rng(0)
    scenes = scenes_in(
        plane(), [[tuple(place) for place in rng.normal(size=(4, 2)).tolist()] for _ in range(2)]
    )
    questions, left_out = at_root(scenes, max_points)

    assert (len(questions), left_out) == (n_prepared, n_left_out)


def test_arguments_do_not_multiply_points() -> None:
    # Two arguments and a third object: one sequence per scene for A, for A and B, and for C.
    rng = np.random.default_rng(0)
    schema = plane("passer", "receiver")
    places = [[tuple(place) for place in rng.normal(size=(3, 2)).tolist()] for _ in range(2)]
    questions, _ = at_root(scenes_in(schema, places, [[0, 1], [2, 0]]), 2)

    assert {question.expansion.n_new for question in questions} == {1, 2, 3}
    assert {len(question.sequences) for question in questions} == {2}


def test_questions_without_a_point_are_dropped() -> None:
    # Single objects have no distances; objects without a place nothing at all.
    questions, left_out = at_root(scenes_in(plane(), [[(0, 0)], [(1, 1)]]))
    assert [question.expansion.mapping.name for question in questions] == ["identity(location)"]
    assert left_out == 0
    assert at_root(scenes_in(plane(), [[NOWHERE], []])) == ([], 0)


def test_a_mapping_of_many_objects_needs_no_mapping_of_few() -> None:
    # No expansion binds just one variable, which once hid all the others.
    scenes = scenes_in(plane(operations=("distance",)), [[(0, 0), (3, 4)], [(1, 0), (1, 1)]])
    questions, left_out = at_root(scenes)

    assert [(question.expansion.n_new, len(question.points)) for question in questions] == [(2, 4)]
    assert left_out == 0


def test_a_branch_that_binds_all_it_may_is_not_extended() -> None:
    scenes = scenes_in(plane(operations=("identity",)), PLACES)
    full = Sequences(np.arange(4), np.full((4, MAX_VARIABLES), -1))
    mappings = catalogue(scenes.schema)
    questions, left_out = prepare(scenes, argument_places(scenes), full, mappings, 1000)

    # Nothing is bound, so that there is nothing to ask without another variable either.
    assert questions == []
    assert left_out > 0


def candidate(p_value: float, gain: float) -> Candidate:
    question = asked(scenes_in(plane(), PLACES), "identity", (0,), 1)
    return Candidate(question, ball([0.0, 0.0], 1.0), np.zeros((3, 4), dtype=np.bool_), gain, p_value, 1)


def test_the_smaller_p_value_wins_and_then_the_larger_gain() -> None:
    assert candidate(0.01, 5).beats(candidate(0.02, 9))
    assert not candidate(0.02, 9).beats(candidate(0.01, 5))
    # Both have vanished.
    assert candidate(0.0, 900).beats(candidate(0.0, 800))
    assert not candidate(0.0, 800).beats(candidate(0.0, 900))
    # Equals stay.
    assert candidate(0.01, 5).beats(candidate(0.01, 5))


def search(scenes: Scenes, labels: Booleans, *, attempts: int = 1) -> Candidate | None:
    questions, _ = at_root(scenes)
    presence = np.ones((1, len(scenes)), dtype=np.bool_)
    root = OpenLeaf(0, presence, assign(presence, labels))
    settings = TreeSettings(attempts=attempts)
    return best_candidate(questions, labels, root, settings, np.random.default_rng(0))


def test_the_best_candidate_of_an_obvious_concept() -> None:
    rng = np.random.default_rng(0)
    far = rng.uniform(5, 9, size=(20, 2))
    far[:10] = rng.uniform(-1, 1, size=(10, 2))
    labels = np.arange(20) < 10
    scenes = scenes_in(plane(), [[tuple(place)] for place in far.tolist()])
    found = search(scenes, labels)

    assert found is not None
    assert found.question.expansion.mapping.name == "identity(location)"
    # 10 against 10 explained completely: 20 ln 2.
    assert found.gain == pytest.approx(20 * np.log(2))
    assert found.presence.tolist() == [labels.tolist(), (~labels).tolist(), [False] * 20]
    assert found.n_tried == 1
    again = search(scenes, labels, attempts=3)
    assert again is not None
    assert again.n_tried == 3


def test_nothing_to_find() -> None:
    scenes = scenes_in(plane(), [[(0, 0)], [(0, 0)]])

    assert search(scenes, np.array([True, False])) is None
    assert search(scenes, np.array([True, True])) is None
