"""What must hold of any query; values by hand are in test_query_agreement.py."""

from __future__ import annotations

import math
import signal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from interpreted import compiled_only
from relforest.scenes import Scenes
from relforest.support.errors import InputError
from relforest.trees import Instantiation, Tree, query
from relforest.trees.boxes import FEWEST
from relforest.trees.kernels import (
    BEST_PATH,
    PAUSE,
    STEPS,
    UNFINISHED,
    WITNESSES,
    query_scene,
    query_work,
)
from small_trees import Place, leaf, near_tree, plane, scenes_in

SCHEMA = plane()
places = st.tuples(st.floats(-5, 5), st.floats(-5, 5))
scene_lists = st.lists(st.lists(places, max_size=4), min_size=1, max_size=6)


def random_scenes(n: int, seed: int = 0) -> Scenes:
    rng = np.random.default_rng(seed)
    counts = rng.integers(0, 5, size=n)
    return scenes_in(SCHEMA, [[tuple(place) for place in rng.normal(size=(k, 2)).tolist()] for k in counts])


@pytest.mark.parametrize("n_jobs", [2, 3, 50])
def test_answers_do_not_depend_on_the_number_of_threads(n_jobs: int) -> None:
    tree, scenes = near_tree(SCHEMA, 0.5), random_scenes(37)
    expected, found = query(tree, scenes), query(tree, scenes, n_jobs=n_jobs)

    np.testing.assert_array_equal(found.leaf, expected.leaf)
    np.testing.assert_array_equal(found.densities, expected.densities)
    np.testing.assert_array_equal(found.witnesses, expected.witnesses)
    assert set(expected.leaf.tolist()) == {0, 1, 2}


def test_shapes() -> None:
    answers = query(near_tree(SCHEMA), random_scenes(7))

    assert answers.leaf.shape == (7,)
    assert answers.densities.shape == (7, 1)
    assert answers.witnesses.shape == (7, 2)


@pytest.mark.parametrize("steps", [1, 2, 7])
def test_a_search_that_pauses_finds_the_same(steps: int) -> None:
    tree, scenes = near_tree(SCHEMA, 0.5), random_scenes(20)
    expected, packed = query(tree, scenes), tree.packed
    work = query_work(packed.n_variables, packed.n_asked, packed.n_dims)
    pauses = 0

    for scene in range(len(scenes)):
        leaf = UNFINISHED
        while leaf == UNFINISHED:
            work.integers[PAUSE, STEPS] = steps
            arguments = scenes.arguments[scene]
            leaf = query_scene(
                packed.nodes, packed.numbers, 0, scenes.matrix, scenes.objects(scene), arguments, work
            )
            pauses += leaf == UNFINISHED
        assert leaf == expected.leaf[scene]
        assert work.integers[WITNESSES, :2].tolist() == expected.witnesses[scene].tolist()
        # Compiled code and NumPy may round the last bit differently.
        assert np.exp(work.numbers[BEST_PATH, 0]) == pytest.approx(expected.densities[scene, 0], rel=1e-14)

    assert pauses > 20


@compiled_only
@pytest.mark.parametrize("n_jobs", [1, 2])
def test_a_query_without_end_is_interrupted(n_jobs: int) -> None:
    endless = Tree(SCHEMA, (*(Instantiation(i + 1) for i in range(15)), leaf(0.5)))
    scenes = scenes_in(SCHEMA, [[(float(i), 0.0) for i in range(15)]] * 4)
    query(endless, scenes.take([]))

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(KeyboardInterrupt):
            query(endless, scenes, n_jobs=n_jobs)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("n_jobs", [1, 2])
def test_no_scenes_get_no_answers(n_jobs: int) -> None:
    answers = query(near_tree(SCHEMA), random_scenes(3).take([]), n_jobs=n_jobs)

    assert answers.leaf.shape == (0,)
    assert answers.densities.shape == (0, 1)
    # None chosen of many objects, which boxes would search.
    crowd = scenes_in(SCHEMA, [[(float(i), 0.0) for i in range(2 * FEWEST)]])
    assert query(near_tree(SCHEMA), crowd.take([]), n_jobs=n_jobs).leaf.shape == (0,)


def test_a_stub_binds_nothing() -> None:
    answers = query(Tree.stub(SCHEMA, leaf(0.5)), random_scenes(4))

    assert answers.leaf.tolist() == [0] * 4
    assert answers.densities.shape == answers.witnesses.shape == (4, 0)


def test_scenes_are_answered_one_by_one() -> None:
    tree, scenes = near_tree(SCHEMA, 0.5), random_scenes(20)
    chosen = [7, 3, 3, 19]
    whole, part = query(tree, scenes), query(tree, scenes.take(chosen))

    np.testing.assert_array_equal(part.leaf, whole.leaf[chosen])
    np.testing.assert_array_equal(part.densities, whole.densities[chosen])
    # Rows are those of the shared matrix.
    np.testing.assert_array_equal(part.witnesses, whole.witnesses[chosen])


@given(scene_lists, st.randoms(use_true_random=False))
def test_the_order_of_objects_does_not_matter(scenes: list[list[Place]], random: object) -> None:
    tree = near_tree(SCHEMA, 2.0)
    shuffled = [sorted(scene, key=lambda _: random.random()) for scene in scenes]  # type: ignore[attr-defined]
    here, there = query(tree, scenes_in(SCHEMA, scenes)), query(tree, scenes_in(SCHEMA, shuffled))

    np.testing.assert_array_equal(there.leaf, here.leaf)
    np.testing.assert_array_equal(there.densities, here.densities)


@given(scene_lists)
def test_the_answer_is_the_nearest_pair(scenes: list[list[Place]]) -> None:
    answers = query(near_tree(SCHEMA, 2.0), scenes_in(SCHEMA, scenes))
    for scene, found, density in zip(scenes, answers.leaf, answers.densities[:, 0], strict=True):
        gaps = [math.dist(a, b) for i, a in enumerate(scene) for b in scene[:i]]
        if not gaps:
            assert (found, density) == (2, 0)
            continue
        # A pair within 2 wins with 0.9; pairs beyond would be answered with No.
        assert found == (0 if min(gaps) <= 2 else 1)
        assert density == pytest.approx(math.exp(-(min(gaps) ** 2) / 2), abs=1e-12)


@given(scene_lists)
def test_witnesses_are_different_objects_of_the_scene(scenes: list[list[Place]]) -> None:
    made = scenes_in(SCHEMA, scenes)
    answers = query(near_tree(SCHEMA, 2.0), made)
    for position, bound in enumerate(answers.witnesses.tolist()):
        real = [row for row in bound if row >= 0]
        assert len(real) == len(set(real)) == min(2, len(scenes[position]))
        assert set(real) <= set(made.objects(position).tolist())


def test_other_probabilities_change_who_wins() -> None:
    # Of three objects in a row, one pair is near and one is far: the more probable answer decides.
    scenes = scenes_in(SCHEMA, [[(0, 0), (1, 0), (9, 0)]])

    assert query(near_tree(SCHEMA, 3.0, (0.9, 0.1, 0.3)), scenes).leaf.tolist() == [0]
    assert query(near_tree(SCHEMA, 3.0, (0.1, 0.9, 0.3)), scenes).leaf.tolist() == [1]
    # Equal ones: the first leaf.
    assert query(near_tree(SCHEMA, 3.0, (0.5, 0.5, 0.5)), scenes).leaf.tolist() == [0]


def test_scenes_of_another_schema_are_refused() -> None:
    other = scenes_in(plane("passer"), [[(0, 0)]], [[0]])
    with pytest.raises(InputError, match="the model is for scenes with"):
        query(near_tree(SCHEMA), other)
