"""Instantiation sequences by hand: permutations, arguments, null objects."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from relforest.scenes import Scenes
from relforest.trees.sequences import Sequences, argument_places, n_extensions, rows_of
from small_trees import plane, scenes_in
from strategies import scenes_batches

Integers = NDArray[np.int64]


def integers(values: object) -> Integers:
    return np.array(values, dtype=np.int64)


def none(n_scenes: int) -> Integers:
    """No arguments."""
    return np.empty((n_scenes, 0), dtype=np.int64)


def pairs(sequences: Sequences) -> list[tuple[int, ...]]:
    """(scene, objects...) of each sequence."""
    found = zip(sequences.scene.tolist(), sequences.objects.tolist(), strict=True)
    return [(scene, *objects) for scene, objects in found]


def test_at_a_root_every_scene_has_one_empty_sequence() -> None:
    start = Sequences.empty(3)

    assert pairs(start) == [(0,), (1,), (2,)]
    assert (len(start), start.depth) == (3, 0)


def test_variables_go_through_all_objects_and_none_comes_twice() -> None:
    counts = integers([2, 3])
    once = Sequences.empty(2).extended(counts, none(2))
    twice = once.extended(counts, none(2))

    assert pairs(once) == [(0, 0), (0, 1), (1, 0), (1, 1), (1, 2)]
    assert pairs(twice) == [
        *[(0, 0, 1), (0, 1, 0)],
        *[(1, 0, 1), (1, 0, 2), (1, 1, 0), (1, 1, 2), (1, 2, 0), (1, 2, 1)],
    ]


def test_when_objects_run_out_the_sequence_goes_on_without() -> None:
    counts = integers([2, 0, 1])
    sequences = Sequences.empty(3)
    for _ in range(3):
        sequences = sequences.extended(counts, none(3))

    assert pairs(sequences) == [(0, 0, 1, -1), (0, 1, 0, -1), (1, -1, -1, -1), (2, 0, -1, -1)]


def test_the_first_variables_are_the_arguments() -> None:
    counts, arguments = integers([3, 2, 0]), integers([[2, 0], [1, -1], [-1, -1]])
    once = Sequences.empty(3).extended(counts, arguments)
    twice = once.extended(counts, arguments)
    thrice = twice.extended(counts, arguments)

    assert pairs(once) == [(0, 2), (1, 1), (2, -1)]
    assert pairs(twice) == [(0, 2, 0), (1, 1, -1), (2, -1, -1)]
    # The rest range over the other objects.
    assert pairs(thrice) == [(0, 2, 0, 1), (1, 1, -1, 0), (2, -1, -1, -1)]


def test_two_arguments_may_be_the_same_object() -> None:
    counts, arguments = integers([3]), integers([[1, 1]])
    sequences = Sequences.empty(1)
    for _ in range(3):
        sequences = sequences.extended(counts, arguments)

    assert pairs(sequences) == [(0, 1, 1, 0), (0, 1, 1, 2)]


def test_a_selection() -> None:
    once = Sequences.empty(2).extended(integers([2, 1]), none(2))

    assert pairs(once.where(np.array([False, True, True]))) == [(0, 1), (1, 0)]


def test_distinct_tuples_by_hand() -> None:
    objects = integers([[0, 1, 2], [0, 2, 1], [1, 0, 2], [0, 1, 2], [0, 2, -1]])
    sequences = Sequences(integers([0, 0, 0, 1, 1]), objects)

    assert pairs(sequences.distinct((0,))) == [(0, 0), (0, 1), (1, 0)]
    assert pairs(sequences.distinct((2,))) == [(0, 1), (0, 2), (1, -1), (1, 2)]
    assert pairs(sequences.distinct((2, 0))) == [(0, 1, 0), (0, 2, 0), (0, 2, 1), (1, -1, 0), (1, 2, 0)]
    # All variables: the sequences themselves, in the order asked for.
    assert pairs(sequences.distinct((2, 1, 0)))[:2] == [(0, 2, 1, 0), (0, 1, 2, 0)]


@given(scenes_batches(), st.integers(0, 3), st.data())
def test_distinct_is_the_set_of_tuples_per_scene(scenes: Scenes, depth: int, data: st.DataObject) -> None:
    places = argument_places(scenes)
    sequences = Sequences.empty(len(scenes))
    for _ in range(depth):
        sequences = sequences.extended(scenes.counts, places)
    variables = tuple(data.draw(st.permutations(range(depth)))[: data.draw(st.integers(0, depth))])
    found = pairs(sequences.distinct(variables))

    expected = {(scene, *(objects[v] for v in variables)) for scene, *objects in pairs(sequences)}
    assert len(found) == len(set(found))
    assert set(found) == expected
    assert [scene for scene, *_ in found] == sorted(scene for scene, *_ in found)


@pytest.mark.parametrize("largest", [3, 5000])
def test_distinct_tuples_are_in_order_whether_tabulated_or_sorted(largest: int) -> None:
    rng = np.random.default_rng(0)
    scene = np.sort(rng.integers(4, size=40))
    objects = rng.choice([-1, 0, 1, largest], size=(40, 3))
    found = pairs(Sequences(scene, objects).distinct((2, 0)))

    rows = zip(scene.tolist(), objects[:, 2].tolist(), objects[:, 0].tolist(), strict=True)
    assert found == sorted(set(rows))


@given(scenes_batches(max_objects=5))
def test_extending_keeps_every_scene_and_counts_right(scenes: Scenes) -> None:
    places = argument_places(scenes)
    sequences = Sequences.empty(len(scenes))
    for depth in range(3):
        expected = n_extensions(sequences.scene, sequences.objects, scenes.counts, places, 1)
        sequences = sequences.extended(scenes.counts, places)
        assert len(sequences) == expected
        assert sequences.depth == depth + 1
        assert set(sequences.scene.tolist()) == set(range(len(scenes)))
        for objects in sequences.objects.tolist():
            free = objects[scenes.schema.n_parameters :]
            bound = [each for each in free if each >= 0]
            assert len(bound) == len(set(bound))
            assert not set(bound) & set(objects[: scenes.schema.n_parameters])


@given(scenes_batches())
def test_places_and_rows_are_inverse(scenes: Scenes) -> None:
    places = argument_places(scenes)
    sequences = Sequences.empty(len(scenes))
    for _ in range(scenes.schema.n_parameters):
        sequences = sequences.extended(scenes.counts, places)

    np.testing.assert_array_equal(rows_of(scenes, sequences), scenes.arguments)


def test_rows_of_scenes_that_share_objects() -> None:
    scenes = scenes_in(plane(), [[(0, 0), (1, 1)]])
    shared = Scenes(scenes.schema, scenes.matrix, integers([1, 0, 1]), integers([0, 2]), integers([2, 1]))
    sequences = Sequences.empty(2).extended(shared.counts, none(2))

    assert rows_of(shared, sequences).tolist() == [[1], [0], [1]]


@pytest.mark.parametrize("n_scenes", [0, 2])
def test_scenes_without_any_object(n_scenes: int) -> None:
    scenes = scenes_in(plane(), [[]] * n_scenes)
    sequences = Sequences.empty(n_scenes).extended(scenes.counts, none(n_scenes))

    assert rows_of(scenes, sequences).tolist() == [[-1]] * n_scenes


@given(scenes_batches(max_objects=5), st.integers(1, 40), st.data())
def test_drawn_sequences_are_some_of_all(scenes: Scenes, most: int, data: st.DataObject) -> None:
    places = argument_places(scenes)
    rng = np.random.default_rng(data.draw(st.integers(0, 9)))
    sequences = Sequences.empty(len(scenes))
    for _ in range(data.draw(st.integers(0, 3))):
        sequences = sequences.extended(scenes.counts, places)
    complete, drawn = (
        sequences.extended(scenes.counts, places),
        sequences.drawn(scenes.counts, places, most, rng),
    )

    assert len(drawn) <= max(most, len(scenes))
    assert set(pairs(drawn)) <= set(pairs(complete))
    assert set(drawn.scene.tolist()) == set(complete.scene.tolist())
    assert pairs(drawn) == sorted(pairs(drawn))
    assert drawn.ratio == len(complete) / len(drawn)


def test_every_sequence_is_equally_likely_to_be_drawn() -> None:
    # Ten scenes of 4 objects, of which 5 of 12 pairs each are drawn.
    scenes = scenes_in(plane(), [[(0.0, float(i)) for i in range(4)]] * 10)
    places, rng = argument_places(scenes), np.random.default_rng(0)
    single = Sequences.empty(10).extended(scenes.counts, places)
    counts: Counter[tuple[int, ...]] = Counter()
    for _ in range(200):
        counts.update(tuple(pair) for pair in single.drawn(scenes.counts, places, 50, rng).objects.tolist())

    assert len(counts) == 12
    expected = 2000 * 5 / 12
    assert all(abs(count - expected) < 4 * np.sqrt(expected) for count in counts.values())
