"""The query with boxes finds what the query through all objects finds, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

from random_trees import ATTRIBUTES, random_question, random_scenes, random_tree, random_volume
from reference import tree as twin
from relforest.mappings import Mapping
from relforest.scenes import Attribute, Scenes, Schema
from relforest.trees import Instantiation, Node, Question, Tree, inference, query
from relforest.trees.boxes import FEWEST, make_boxes
from relforest.trees.kernels import (
    BEST_PATH,
    PAUSE,
    STEPS,
    UNFINISHED,
    WITNESSES,
    query_scene,
    query_work,
)
from relforest.volumes import Ellipsoid
from small_trees import NOWHERE, leaf, near_tree, plane, scenes_in

Result = tuple[int, list[int], list[float]]


def search(tree: Tree, scenes: Scenes, scene: int, *, boxed: bool, steps: int = 10**9) -> Result:
    """Query one scene and continue as often as it pauses."""
    packed = tree.packed
    work = query_work(packed.n_variables, packed.n_asked, packed.n_dims)
    objects, arguments = scenes.objects(scene), scenes.arguments[scene]
    boxes = make_boxes(packed, len(objects)) if boxed else None
    found = UNFINISHED
    while found == UNFINISHED:
        work.integers[PAUSE, STEPS] = steps
        found = query_scene(packed.nodes, packed.numbers, 0, scenes.matrix, objects, arguments, work, boxes)
    return found, work.integers[WITNESSES].tolist(), work.numbers[BEST_PATH].tolist()


def check(tree: Tree, scenes: Scenes, *steps: int) -> None:
    """Assert that both searches agree on scenes with more objects than the tree has variables."""
    for scene in np.flatnonzero(scenes.counts > tree.n_variables).tolist():
        expected = search(tree, scenes, scene, boxed=False)
        for limit in (*steps, 10**9):
            assert search(tree, scenes, scene, boxed=True, steps=limit) == expected


def on_grid(scenes: Scenes, width: float) -> Scenes:
    """The same scenes with values on a grid: equal densities, and objects in the same place."""
    schema, matrix, *others = scenes.parts[:6]
    return Scenes(schema, np.round(matrix / width) * width, *others)


def pair_tree(rng: np.random.Generator, n_parameters: int) -> Tree:
    """One question about the last of two or three variables, with leaves of any order."""
    n_bound = max(2, n_parameters + 1)
    while True:
        mapping, variables = random_question(rng, n_bound)
        if n_bound - 1 in variables:
            break
    nodes: list[Node] = [Instantiation(i + 1) for i in range(n_bound)]
    nodes.append(
        Question(mapping, variables, random_volume(rng, mapping), n_bound + 1, n_bound + 2, n_bound + 3)
    )
    nodes += [leaf(probability) for probability in rng.permutation([0.1, 0.5, 0.5, 0.9])[:3].tolist()]
    return Tree(Schema(ATTRIBUTES, [f"arg{i}" for i in range(n_parameters)]), tuple(nodes))


@pytest.mark.parametrize("n_parameters", [0, 1, 2])
@pytest.mark.parametrize("seed", range(15))
def test_random_trees(seed: int, n_parameters: int) -> None:
    rng = np.random.default_rng([n_parameters, seed])
    tree = random_tree(rng, n_parameters)
    scenes = random_scenes(rng, n_parameters, n_scenes=4, most=10)
    check(tree, scenes)
    check(tree, on_grid(scenes, 1.0))
    check(tree, on_grid(scenes, 0.5), 1 + seed)


@pytest.mark.parametrize("n_parameters", [0, 1, 2])
@pytest.mark.parametrize("seed", range(25))
def test_random_pairs(seed: int, n_parameters: int) -> None:
    rng = np.random.default_rng([n_parameters, seed])
    tree = pair_tree(rng, n_parameters)
    scenes = random_scenes(rng, n_parameters, n_scenes=4, most=20)
    check(tree, scenes)
    check(tree, on_grid(scenes, 1.0))
    check(tree, on_grid(scenes, 0.5), 1 + seed)


@pytest.mark.parametrize("seed", range(40))
def test_long_tilted_volumes_far_from_the_origin(seed: int) -> None:
    # Here rounding errors are as large as they get.
    rng = np.random.default_rng(seed)
    n, offset = 15, 10.0 ** int(rng.integers(0, 8))
    matrix = offset + np.round(4 * rng.standard_normal((n, 3))) / 4
    axes, lengths = np.linalg.qr(rng.standard_normal((3, 3)))[0], 10.0 ** rng.uniform(0, 8, size=3)
    covariance = axes @ np.diag(lengths) @ axes.T
    volume = Ellipsoid(np.zeros(3), (covariance + covariance.T) / 2, float(10 ** rng.uniform(-4, 0)), 3, 0.1)
    schema = Schema((Attribute("color", 3),))
    question = Question(Mapping("difference", schema["color"]), (0, 1), volume, 3, 4, 5)
    leaves = [leaf(probability) for probability in rng.permutation([0.1, 0.5, 0.9]).tolist()]
    tree = Tree(schema, (Instantiation(1), Instantiation(2), question, *leaves))
    check(tree, Scenes(schema, matrix, np.arange(n), np.array([0]), np.array([n])))


@pytest.mark.parametrize("probabilities", [(0.9, 0.1, 0.3), (0.1, 0.9, 0.3), (0.1, 0.3, 0.9)])
def test_scenes_of_all_sizes_in_one_batch(
    monkeypatch: pytest.MonkeyPatch, probabilities: tuple[float, float, float]
) -> None:
    rng = np.random.default_rng(0)
    tree = near_tree(plane(), 0.5, probabilities)
    scenes = scenes_in(
        plane(), [[NOWHERE, *map(tuple, rng.uniform(0, 9, size=(n, 2)).tolist())] for n in (3, 20, 0, 12)]
    )
    expected = twin.query(tree, scenes)

    monkeypatch.setattr(inference, "FEWEST", 8)
    for n_jobs in (1, 2):
        answers = query(tree, scenes, n_jobs=n_jobs)
        np.testing.assert_array_equal(answers.leaf, [answer.leaf for answer in expected])
        np.testing.assert_array_equal(answers.witnesses, [answer.witnesses for answer in expected])


def test_more_objects_than_the_threshold() -> None:
    rng = np.random.default_rng(0)
    tree, n = near_tree(plane(), 0.5), FEWEST + 4
    scenes = scenes_in(plane(), [[*map(tuple, rng.uniform(0, 9, size=(n, 2)).tolist())]])
    (expected,) = twin.query(tree, scenes)
    answers = query(tree, scenes)

    assert answers.leaf.tolist() == [expected.leaf]
    assert tuple(answers.witnesses[0].tolist()) == expected.witnesses


def test_of_equal_pairs_the_first_in_the_order_of_objects_wins() -> None:
    # Boxes are made for the third A. The fourth has two B in the same place, and the last is looked at first.
    scenes = scenes_in(plane(), [[(100.0, 0.0), (200.0, 0.0), (300.0, 0.0), *[(0.0, 0.0)] * 3]])

    assert search(near_tree(plane()), scenes, 0, boxed=True)[1][:2] == [3, 4]
    check(near_tree(plane()), scenes)


@pytest.mark.parametrize("probabilities", [(0.9, 0.1, 0.3), (0.1, 0.9, 0.3), (0.1, 0.3, 0.9)])
@pytest.mark.parametrize("n_undefined", [1, 5, 9, 10])
def test_undefined_objects(n_undefined: int, probabilities: tuple[float, float, float]) -> None:
    places = [(float(i), 0.0) for i in range(10 - n_undefined)]
    for scene in ([NOWHERE] * n_undefined + places, places + [NOWHERE] * n_undefined):
        check(near_tree(plane(), 1.5, probabilities), scenes_in(plane(), [scene]), 1)


def test_numbers_too_large_to_be_compared() -> None:
    # Squares overflow, and a density may be undefined.
    scenes = scenes_in(plane(), [[(float(i), 1e200 * (i % 3 - 1)) for i in range(10)]])
    with np.errstate(all="ignore"):
        check(near_tree(plane()), scenes)


def test_few_objects_are_looked_at() -> None:
    # All of the 90 * 89 pairs without boxes.
    tree, n = near_tree(plane(), 0.01), 90
    places = np.random.default_rng(0).uniform(0, 9, size=(n, 2))
    scenes = scenes_in(plane(), [[*map(tuple, places.tolist())]])
    packed = tree.packed
    work = query_work(packed.n_variables, packed.n_asked, packed.n_dims)
    work.integers[PAUSE, STEPS] = 10_000
    query_scene(
        packed.nodes,
        packed.numbers,
        0,
        scenes.matrix,
        scenes.objects(0),
        scenes.arguments[0],
        work,
        make_boxes(packed, n),
    )

    assert work.integers[PAUSE, STEPS] > 7000
