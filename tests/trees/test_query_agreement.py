"""The compiled query against its plain twin, on random trees and scenes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from random_trees import random_scenes, random_tree
from reference import tree as twin
from relforest.mappings import Mapping
from relforest.scenes import Attribute, Scenes, Schema
from relforest.trees import Instantiation, Leaf, Node, Question, Tree, query
from relforest.volumes import Ellipsoid, Slab


def of_one_coordinate(node: Node) -> Node:
    """The same question about the last coordinate of several."""
    if not isinstance(node, Question) or not isinstance(node.volume, Ellipsoid) or node.volume.dim == 1:
        return node
    volume = node.volume
    interval = Ellipsoid(volume.mean[-1:], volume.covariance[-1:, -1:], volume.radius, volume.n_keys, 0.1)
    return replace(node, volume=Slab(interval, volume.dim - 1, volume.dim))


def check(tree: Tree, scenes: Scenes) -> list[twin.SceneAnswer]:
    """Assert that both queries agree on every scene and return what the twin says."""
    answers = query(tree, scenes)
    expected = twin.query(tree, scenes)
    np.testing.assert_array_equal(answers.leaf, [answer.leaf for answer in expected])
    np.testing.assert_array_equal(answers.witnesses, [answer.witnesses for answer in expected])
    densities = np.array([answer.densities for answer in expected]).reshape(len(scenes), tree.depth)
    np.testing.assert_allclose(answers.densities, densities, rtol=1e-7, atol=1e-300)
    return expected


def scenes_of(locations: Sequence[Sequence[float]], arguments: Sequence[int] = ()) -> Scenes:
    """One scene of objects with a location each."""
    n = len(locations)
    schema = Schema((Attribute("location", 2),), [f"arg{i}" for i in range(len(arguments))])
    matrix = np.array(locations, dtype=np.float64).reshape(n, 2)
    return Scenes(
        schema,
        matrix,
        np.arange(n),
        np.array([0]),
        np.array([n]),
        np.array([arguments], dtype=np.int64).reshape(1, len(arguments)),
    )


def near(scenes: Scenes, *, n_bound: int, variables: tuple[int, int], within: float) -> Tree:
    """A tree with one question: are two of the bound objects within a distance?"""
    mapping = Mapping("distance", scenes.schema["location"])
    volume = Ellipsoid(np.zeros(1), np.eye(1), within, 1, 0.0)
    nodes: list[Node] = [Instantiation(i + 1) for i in range(n_bound)]
    nodes.append(Question(mapping, variables, volume, n_bound + 1, n_bound + 2, n_bound + 3))
    nodes += [Leaf(0.9, 0, 0), Leaf(0.4, 0, 0), Leaf(0.1, 0, 0)]
    return Tree(scenes.schema, tuple(nodes))


@pytest.mark.parametrize("n_parameters", [0, 1, 2])
@pytest.mark.parametrize("seed", range(25))
def test_random_trees_and_scenes(seed: int, n_parameters: int) -> None:
    rng = np.random.default_rng([n_parameters, seed])
    tree, scenes = random_tree(rng, n_parameters), random_scenes(rng, n_parameters)
    check(tree, scenes)
    check(Tree(tree.schema, tuple(map(of_one_coordinate, tree.nodes))), scenes)


@pytest.mark.parametrize("n_parameters", [0, 2])
def test_all_answers_occur(n_parameters: int) -> None:
    # The random trees above would prove little if their questions were answered one way only.
    taken: set[tuple[str, bool]] = set()
    for seed in range(10):
        rng = np.random.default_rng([n_parameters, seed])
        tree, scenes = random_tree(rng, n_parameters), random_scenes(rng, n_parameters)
        links = {
            child: answer
            for node in tree.nodes
            if isinstance(node, Question)
            for answer, child in (("yes", node.yes), ("no", node.no), ("error", node.error))
        }
        for scene in range(len(scenes)):
            for leaf, arrivals in twin.sequences_at_leaves(tree, scenes, scene).items():
                taken.add((links[leaf], len(arrivals.objects) > 1))
    assert taken == {(answer, many) for answer in ("yes", "no", "error") for many in (False, True)}


def test_a_stub_answers_with_its_leaf() -> None:
    scenes = random_scenes(np.random.default_rng(0), 0)
    answers = check(Tree(scenes.schema, (Leaf(0.3, 7, 3),)), scenes)
    assert {answer.n_sequences for answer in answers} == {1}


def test_the_nearest_pair_is_the_most_representative() -> None:
    # Distances: |0-1| = 3, |0-2| = 1, |1-2| = 2; all within 5. Density of the nearest: exp(-1^2 * 1 / 2).
    scenes = scenes_of([(0, 0), (3, 0), (1, 0)])
    (answer,) = check(near(scenes, n_bound=2, variables=(0, 1), within=5), scenes)
    assert answer.leaf == 0
    assert answer.witnesses == (0, 2)
    assert answer.densities == pytest.approx([0.6065306597])
    assert answer.n_sequences == 6


def test_ten_objects_with_one_argument_and_two_free_variables() -> None:
    scenes = scenes_of([(i, i**2) for i in range(10)], arguments=[4])
    (answer,) = check(near(scenes, n_bound=3, variables=(1, 2), within=2), scenes)
    # 9 objects for B, then 8 for C.
    assert answer.n_sequences == 72
    # |(0, 0) - (1, 1)| = 1.41 is the only distance within 2, found first with B = 0.
    assert answer.witnesses == (4, 0, 1)


def test_too_few_objects_take_the_error_branch_once() -> None:
    scenes = scenes_of([(0, 0), (1, 0)])
    (answer,) = check(near(scenes, n_bound=3, variables=(0, 2), within=5), scenes)
    assert answer.leaf == 2
    assert answer.densities == (0.0,)
    assert answer.witnesses == (0, 1, -1)
    assert answer.n_sequences == 2


def test_a_null_object_does_not_spoil_other_questions() -> None:
    scenes = scenes_of([(0, 0), (1, 0)])
    (answer,) = check(near(scenes, n_bound=3, variables=(0, 1), within=5), scenes)
    assert answer.leaf == 0
    assert answer.witnesses == (0, 1, -1)


def test_an_empty_scene_still_has_one_sequence() -> None:
    scenes = scenes_of([])
    (answer,) = check(near(scenes, n_bound=2, variables=(0, 1), within=5), scenes)
    assert (answer.leaf, answer.witnesses, answer.n_sequences) == (2, (-1, -1), 1)


def test_a_missing_argument_takes_the_error_branch() -> None:
    scenes = scenes_of([(0, 0), (1, 0)], arguments=[-1])
    (answer,) = check(near(scenes, n_bound=2, variables=(0, 1), within=5), scenes)
    assert (answer.leaf, answer.witnesses, answer.n_sequences) == (2, (-1, 0), 2)


def test_an_argument_is_not_bound_again() -> None:
    scenes = scenes_of([(0, 0), (1, 0), (5, 0)], arguments=[1])
    (answer,) = check(near(scenes, n_bound=2, variables=(0, 1), within=2), scenes)
    assert (answer.leaf, answer.witnesses, answer.n_sequences) == (0, (1, 0), 2)


def test_densities_beyond_the_branch_of_the_winner_are_zero() -> None:
    # A = object 0 reaches a leaf below two questions, A = object 1 a more probable one below the first.
    scenes = scenes_of([(0, 0), (9, 0)])
    mapping = Mapping("identity", scenes.schema["location"])
    here, anywhere = (Ellipsoid(np.zeros(2), np.eye(2), radius, 1, 0.0) for radius in (1.0, 20.0))
    nodes: tuple[Node, ...] = (
        Instantiation(1),
        Question(mapping, (0,), here, 2, 6, 7),
        Question(mapping, (0,), anywhere, 3, 4, 5),
        *(Leaf(probability, 0, 0) for probability in (0.5, 0.1, 0.1, 0.9, 0.1)),
    )
    (answer,) = check(Tree(scenes.schema, nodes), scenes)
    assert answer.leaf == 3
    assert answer.witnesses == (1,)
    # exp(-9^2 / 2) at the first question, nothing at the second.
    assert answer.densities == pytest.approx([2.5767571e-18, 0.0], rel=1e-6, abs=0)
