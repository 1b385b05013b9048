"""Points of a question at a leaf, who goes where, and which of two candidates is better."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from relforest.mappings import Mapping
from relforest.scenes import Scenes
from relforest.trees import Leaf, Question, Tree
from relforest.trees.candidates import Candidate, OpenLeaf, PreparedQuestion
from relforest.trees.criterion import Target
from relforest.trees.expansions import Expansion
from relforest.trees.sequences import Sequences, argument_places
from small_trees import NOWHERE, Place, ball, plane, scenes_in


def asked(scenes: Scenes, operation: str, variables: tuple[int, ...], n_new: int) -> PreparedQuestion:
    sequences = Sequences.empty(len(scenes))
    for _ in range(n_new):
        sequences = sequences.extended(scenes.counts, argument_places(scenes))
    expansion = Expansion(n_new, Mapping(operation, scenes.schema["location"]), variables)
    return PreparedQuestion(scenes, expansion, sequences)


# Two objects 5 apart; one object alone; one of unknown place next to one at (0, 2); nothing.
PLACES: list[list[Place]] = [[(0, 0), (3, 4)], [(1, 0)], [NOWHERE, (0, 2)], []]


def test_points_and_bags_by_hand() -> None:
    question = asked(scenes_in(plane(), PLACES), "identity", (0,), 1)

    assert question.bags.points.tolist() == [[0, 0], [3, 4], [1, 0], [0, 2]]
    assert question.bags.starts.tolist() == [0, 2, 3, 4]
    # The empty scene has no point.
    assert question.bags.scenes.tolist() == [0, 1, 2]


def test_pairs_by_hand() -> None:
    question = asked(scenes_in(plane(), PLACES), "distance", (0, 1), 2)

    # Only the first scene has two objects with a place.
    assert question.bags.points.tolist() == [[5], [5]]
    assert question.bags.starts.tolist() == [0, 2]
    assert question.bags.scenes.tolist() == [0]


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


def test_who_goes_where_is_known_without_the_sequences() -> None:
    rng = np.random.default_rng(1)
    counts = rng.integers(0, 5, size=20)
    places = [[tuple(place) for place in rng.normal(size=(n, 2)).tolist()] for n in counts]
    scenes = scenes_in(plane(), places)
    first = asked(scenes, "identity", (0,), 1)
    stub = Tree.stub(scenes.schema, Leaf(0.0, 0, 0))
    everywhere = np.ones((1, 20), dtype=np.bool_)
    target = Target.binary(rng.random(20) < 0.5)
    root = OpenLeaf(stub, 0, everywhere, target.assign(everywhere))
    near = ball([0.0, 0.0], 1.0)
    np.testing.assert_array_equal(root.below(first, near), first.presence(near))

    # Below the No leaf, for a question about another object.
    presence = first.presence(near)
    node = Question(first.expansion.mapping, (0,), near, 0, 0, 0)
    leaf = OpenLeaf(stub.expanded(0, 1, node), 1, presence, target.assign(presence))
    sequences = first.partition(near)[1].extended(scenes.counts, argument_places(scenes))
    distance = Expansion(1, Mapping("distance", scenes.schema["location"]), (0, 1))
    second = PreparedQuestion(scenes, distance, sequences)
    close = ball([0.0], 1.5)
    np.testing.assert_array_equal(leaf.below(second, close), second.presence(close))

    # Of a sample, the judgement takes the scenes without a sequence for No, unless it is exact.
    few = PreparedQuestion(
        scenes, second.expansion, replace(sequences.where(sequences.scene < 10), ratio=2.0)
    )
    missing = presence[1] & (np.arange(20) >= 10)
    assert missing.any()
    assert leaf.judged(few, close, target).presence[1][missing].all()
    exact = leaf.judged(few, close, target, exactly=True)
    np.testing.assert_array_equal(exact.presence, second.presence(close))
    assert exact.gain == leaf.judged(second, close, target).gain
