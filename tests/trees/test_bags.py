"""The compiled mapping of bags against `Mapping.evaluate`, and whether bags differ against sets."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.mappings import catalogue
from relforest.scenes import Scenes
from relforest.trees.bags import Bags, bags_of
from relforest.trees.sequences import Sequences, argument_places, rows_of
from small_trees import plane, scenes_in
from strategies import scenes_batches


@given(scenes_batches(max_objects=4))
def test_points_are_those_of_the_mapping(scenes: Scenes) -> None:
    sequences = Sequences.empty(len(scenes))
    for _ in range(3):
        sequences = sequences.extended(scenes.counts, argument_places(scenes))
    for mapping in catalogue(scenes.schema):
        asked = sequences.distinct(tuple(range(mapping.arity)))
        found = bags_of(scenes, asked, mapping)

        rows = rows_of(scenes, asked)
        points = mapping.evaluate(scenes.schema, scenes.matrix, rows)
        defined = np.isfinite(points).all(axis=1)
        bag_scenes, first = np.unique(asked.scene[defined], return_index=True)
        np.testing.assert_array_equal(found.points, points[defined])
        np.testing.assert_array_equal(found.scenes, bag_scenes)
        np.testing.assert_array_equal(found.starts, np.append(first, defined.sum()))


@given(st.lists(st.lists(st.integers(0, 2), min_size=1, max_size=4), max_size=4))
def test_bags_differ_if_their_sets_of_points_do(values: list[list[int]]) -> None:
    points = np.array([value for bag in values for value in bag], dtype=np.float64).reshape(-1, 1)
    starts = np.cumsum([0, *map(len, values)])
    bags = Bags(points, starts, np.arange(len(values)))

    assert bags.differ == (len({frozenset(bag) for bag in values}) > 1)


@pytest.mark.filterwarnings("ignore:overflow")
def test_an_overflow_is_no_point() -> None:
    scenes = scenes_in(plane(operations=("distance",)), [[(-1e200, 0), (1e200, 0)], [(0, 0), (0, 1)]])
    pairs = Sequences.empty(2)
    for _ in range(2):
        pairs = pairs.extended(scenes.counts, argument_places(scenes))
    found = bags_of(scenes, pairs, catalogue(scenes.schema)[0])

    assert found.points.tolist() == [[1], [1]]
    assert found.scenes.tolist() == [1]
