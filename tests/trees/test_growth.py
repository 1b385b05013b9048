"""Learning trees: concepts found, noise refused, and everything about scenes that may be missing."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from interpreted import compiled_only
from relforest.scenes import Attribute, Scenes, Schema
from relforest.scenes.batch import scenes_of
from relforest.support.errors import InputError
from relforest.support.progress import Stage, listening
from relforest.trees import Growth, Leaf, Question, TreeSettings, grow, query
from relforest.trees.significance import sidak
from relforest.volumes import CovAggSettings
from small_trees import NOWHERE, Place, plane, scenes_in

Booleans = NDArray[np.bool_]

WEIGHTS = Schema((Attribute("weight", operations=("identity",)),))


def grown(scenes: Scenes, labels: Booleans, *, seed: int = 0, **options: Any) -> Growth:
    return grow(scenes, labels, rng=np.random.default_rng(seed), settings=TreeSettings(**options))


def of_weights(weights: list[list[float]]) -> Scenes:
    """Scenes of objects that have nothing but a weight."""
    counts = np.array([len(scene) for scene in weights], dtype=np.int64)
    matrix = np.array([weight for scene in weights for weight in scene], dtype=np.float64).reshape(-1, 1)
    return Scenes(WEIGHTS, matrix, np.arange(len(matrix)), np.cumsum(counts) - counts, counts)


def leaves_of(growth: Growth) -> list[Leaf]:
    return [node for node in growth.tree.nodes if isinstance(node, Leaf)]


def heavy_scenes(seed: int = 0, n: int = 30) -> tuple[Scenes, Booleans]:
    """One to three objects of weight 0 to 4; half of the scenes have one more of about 8."""
    rng = np.random.default_rng(seed)
    labels = np.arange(n) % 2 == 0
    weights = [rng.uniform(0, 4, size=rng.integers(1, 4)).tolist() for _ in range(n)]
    for scene in np.flatnonzero(labels):
        weights[scene].insert(int(rng.integers(0, 2)), float(rng.normal(8, 0.3)))
    return of_weights(weights), labels


def noise(seed: int, n: int = 30) -> tuple[Scenes, Booleans]:
    rng = np.random.default_rng(seed)
    return of_weights(rng.uniform(0, 4, size=(n, 2)).tolist()), rng.permutation(np.arange(n) % 2 == 0)


def test_an_obvious_concept_is_found() -> None:
    scenes, labels = heavy_scenes()
    growth = grown(scenes, labels)
    tree = growth.tree

    assert [step.question for step in growth.steps] == ["identity(weight)"]
    assert tree.leaf_probabilities[query(tree, scenes).leaf].tolist() == labels.astype(float).tolist()
    question = tree.nodes[1]
    assert isinstance(question, Question)
    assert question.volume.contains([[8.0], [4.0]]).tolist() == [True, False]
    # Nothing was missing, so the Error leaf is empty: the base rate, or what is just below the No leaf.
    assert tree.nodes[2:] == (Leaf(1.0, 0, 15), Leaf(0.0, 15, 0), Leaf(0.0, 0, 0))


def test_what_is_reported_of_a_step() -> None:
    growth = grown(*heavy_scenes(), attempts=2)
    (step,) = growth.steps

    assert (step.leaf, step.question, step.n_tried) == (0, "identity(weight)", 2)
    # 15 against 15 explained completely: 30 ln 2; chi-square with 3 degrees of freedom.
    assert step.gain == pytest.approx(30 * math.log(2))
    assert step.p_value < sidak(0.05, 2)
    assert growth.n_left_out == 0


def test_a_relation_of_two_objects_is_found() -> None:
    # Positive: some two objects are within 1 of each other.
    rng = np.random.default_rng(0)
    places: list[list[Place]] = []
    for scene in range(40):
        first, second = rng.uniform(0, 10, size=2), rng.uniform(20, 30, size=2)
        third = first + rng.uniform(-0.5, 0.5, size=2) if scene % 2 else rng.uniform([40, 0], [50, 10])
        order = rng.permutation(3)
        places.append([tuple(np.array([first, second, third])[i].tolist()) for i in order])
    scenes = scenes_in(plane(operations=("distance",)), places)
    labels = np.arange(40) % 2 == 1
    tree = grown(scenes, labels).tree

    assert tree.leaf_probabilities[query(tree, scenes).leaf].tolist() == labels.astype(float).tolist()
    assert tree.n_variables == 2


def test_arguments_matter() -> None:
    # Positive: the passer is at the left. The others are anywhere.
    rng = np.random.default_rng(1)
    places = rng.uniform(0, 10, size=(30, 3, 2))
    arguments = rng.integers(3, size=30)
    labels = places[np.arange(30), arguments, 0] < 5
    schema = plane("passer", operations=("identity",))
    scenes = scenes_in(schema, places.tolist(), arguments[:, None].tolist())
    growth = grown(scenes, labels)

    assert growth.tree.nodes[1].variables == (0,)  # type: ignore[union-attr]
    predicted = growth.tree.leaf_probabilities[query(growth.tree, scenes).leaf] > 0.5
    assert (predicted == labels).mean() > 0.9
    # Without the argument there is hardly anything to learn.
    anonymous = scenes_in(plane(operations=("identity",)), places.tolist())
    tree = grown(anonymous, labels).tree
    assert ((tree.leaf_probabilities[query(tree, anonymous).leaf] > 0.5) == labels).mean() < 0.9


@pytest.mark.parametrize("label", [False, True])
def test_one_class_gives_a_stub(*, label: bool) -> None:
    scenes, labels = heavy_scenes()
    growth = grown(scenes, np.full(len(labels), label))

    assert growth.tree.nodes == (Leaf(float(label), 0 if label else 30, 30 if label else 0),)
    assert growth.steps == ()


@pytest.mark.parametrize("seed", range(4))
def test_noise_gives_a_stub_under_the_permutation_test(seed: int) -> None:
    growth = grown(*noise(seed), test="permutation", permutations=19, attempts=1)

    assert growth.tree.is_stub
    assert growth.tree.nodes == (Leaf(0.5, 15, 15),)


def test_the_permutation_test_accepts_what_is_there() -> None:
    growth = grown(*heavy_scenes(), test="permutation", permutations=19, attempts=1)
    (step,) = growth.steps

    # As good as none of the 19 shuffles.
    assert step.p_value == 1 / 20
    assert not growth.tree.is_stub


def test_a_strict_level_refuses() -> None:
    scenes, labels = heavy_scenes(n=8)

    # 4 against 4: the gain of 8 ln 2 has a p-value of .011 with 3 degrees of freedom.
    assert len(grown(scenes, labels, alpha=0.05).steps) == 1
    assert len(grown(scenes, labels, alpha=0.001).steps) == 0


def test_two_questions() -> None:
    # Positive: a weight near 8 or one near 20. One question finds one of them, a second the other.
    rng = np.random.default_rng(0)
    weights = [rng.uniform(0, 4, size=2).tolist() for _ in range(60)]
    labels = np.arange(60) % 2 == 0
    for scene in range(0, 60, 2):
        weights[scene].append(float(rng.normal(8 if scene % 4 else 20, 0.2)))
    for scene in range(1, 60, 2):
        weights[scene].append(float(rng.uniform(12, 15)))
    growth = grown(of_weights(weights), labels)

    assert len(growth.steps) == 2
    predicted = growth.tree.leaf_probabilities[query(growth.tree, of_weights(weights)).leaf]
    assert predicted.tolist() == pytest.approx(labels.astype(float).tolist(), abs=1e-5)
    # Every step raised the likelihood of the whole tree.
    assert all(step.gain > 0 for step in growth.steps)
    assert sum(step.gain for step in growth.steps) == pytest.approx(60 * math.log(2), rel=1e-5)


@pytest.mark.parametrize("seed", range(3))
def test_leaves_count_the_scenes_that_the_query_sends_there(seed: int) -> None:
    # Learning and inference walk the tree in different ways; they must agree on who wins each scene.
    rng = np.random.default_rng(seed)
    n = 25
    schema = Schema((Attribute("location", 2), Attribute("weight", operations=("identity",))), ("passer",))
    counts = rng.integers(0, 4, size=n)
    matrix = rng.normal(size=(counts.sum(), 3))
    matrix[rng.random(len(matrix)) < 0.1, 2] = np.nan
    starts = np.cumsum(counts) - counts
    arguments = np.where(counts > 0, starts, -1)[:, None]
    labels = rng.random(n) < np.where(counts > 1, 0.8, 0.2)
    scenes = Scenes(schema, matrix, np.arange(len(matrix)), starts, counts, arguments)
    tree = grown(scenes, labels, seed=seed, alpha=0.5, attempts=1).tree

    leaf = query(tree, scenes).leaf
    assert not tree.is_stub
    for ordinal, node in enumerate(tree.leaves):
        here = labels[leaf == ordinal]
        expected = tree.nodes[node]
        assert isinstance(expected, Leaf)
        assert (expected.negatives, expected.positives) == (int((~here).sum()), int(here.sum()))


def test_the_same_generator_grows_the_same_tree() -> None:
    scenes, labels = heavy_scenes()
    first, again = (grown(scenes, labels, seed=5, alpha=0.3) for _ in range(2))

    assert first.tree.to_dict() == again.tree.to_dict()
    assert first.steps == again.steps


def test_sharing_rows_changes_nothing() -> None:
    scenes, labels = heavy_scenes()
    taken = scenes.take(np.arange(len(scenes)))
    compact = Scenes.from_dicts(scenes.to_dicts(), scenes.schema)

    assert grown(taken, labels).tree.to_dict() == grown(compact, labels).tree.to_dict()


def test_scenes_without_the_attribute_take_the_error_branch() -> None:
    # Heavy is positive, light is negative, and of unknown weight is positive as well.
    weights = [[8.0 + 0.01 * i] for i in range(10)] + [[0.1 * i] for i in range(20)] + [[np.nan]] * 10
    labels = np.array([True] * 10 + [False] * 20 + [True] * 10)
    growth = grown(of_weights(weights), labels)
    tree = growth.tree

    assert tree.leaf_probabilities.tolist() == pytest.approx([1, 0, 1 - 1e-6], rel=1e-12)
    assert [(leaf.negatives, leaf.positives) for leaf in leaves_of(growth)] == [(0, 10), (20, 0), (0, 10)]
    assert query(tree, of_weights([[np.nan], [8.0], [1.0]])).leaf.tolist() == [2, 0, 1]


def test_scenes_with_too_few_objects_take_the_error_branch() -> None:
    rng = np.random.default_rng(0)
    pairs: list[list[Place]] = [[(0, 0), (float(rng.uniform(0, 1)), 0)] for _ in range(15)]
    far: list[list[Place]] = [[(0, 0), (float(rng.uniform(5, 9)), 0)] for _ in range(15)]
    alone: list[list[Place]] = [[(float(rng.uniform(0, 9)), 0)] for _ in range(5)]
    scenes = scenes_in(plane(operations=("distance",)), [*pairs, *far, *alone, []])
    tree = grown(scenes, np.arange(36) < 15).tree

    assert query(tree, scenes).leaf.tolist() == [0] * 15 + [1] * 15 + [2] * 6


def test_scenes_without_any_object_give_a_stub() -> None:
    scenes = of_weights([[], [], []])

    assert grown(scenes, np.array([True, False, True])).tree.nodes == (Leaf(2 / 3, 1, 2),)


def test_scenes_without_any_known_value_give_a_stub() -> None:
    scenes = scenes_in(plane(), [[NOWHERE, NOWHERE], [NOWHERE]])

    assert grown(scenes, np.array([True, False])).tree.is_stub


def test_one_object_per_scene_and_three_arguments() -> None:
    # More arguments than objects; two of them are missing, one variable asks in vain.
    rng = np.random.default_rng(0)
    schema = plane("first", "second", "third")
    places: list[list[Place]] = [[(float(rng.uniform(0, 1) + 5 * (i % 2)), 0.0)] for i in range(20)]
    scenes = scenes_in(schema, places, [[0, -1, -1]] * 20)
    growth = grown(scenes, np.arange(20) % 2 == 1)

    assert [step.question for step in growth.steps] == ["identity(location)"]
    assert growth.tree.n_variables == 1


def test_one_object_and_one_scene() -> None:
    growth = grown(of_weights([[1.0]]), np.array([True]))

    assert growth.tree.nodes == (Leaf(1.0, 0, 1),)


def test_a_constant_attribute_says_nothing() -> None:
    assert grown(of_weights([[3.0]] * 10), np.arange(10) < 5).tree.nodes == (Leaf(0.5, 5, 5),)


def test_scenes_that_no_question_may_look_at() -> None:
    scenes, labels = heavy_scenes()
    schema = Schema((Attribute("weight", operations=()),))
    mute = replace_schema(scenes, schema)

    assert grown(mute, labels).tree.is_stub


def replace_schema(scenes: Scenes, schema: Schema) -> Scenes:
    return scenes_of(scenes.parts._replace(schema=schema))


def test_expansions_left_out_or_sampled_are_counted() -> None:
    scenes, labels = heavy_scenes()
    n_points = int(scenes.counts.sum())

    complete = grown(scenes, labels, max_points=n_points)
    assert (complete.n_left_out, complete.n_sampled) == (0, 0)
    limited = grown(scenes, labels, max_points=n_points - 1, search="exhaustive")
    assert limited.tree.is_stub
    assert (limited.n_left_out, limited.n_sampled) == (1, 0)
    sampled = grown(scenes, labels, max_points=n_points - 1)
    assert not sampled.tree.is_stub
    assert sampled.n_left_out == 0
    assert sampled.n_sampled > 0
    # Leaves count what arrives by all sequences.
    for growth in (complete, sampled):
        leaf = query(growth.tree, scenes).leaf
        assert [each.negatives + each.positives for each in leaves_of(growth)] == [
            np.count_nonzero(leaf == ordinal) for ordinal in range(growth.tree.n_leaves)
        ]


def test_the_order_of_objects_does_not_change_what_a_tree_says() -> None:
    rng = np.random.default_rng(2)
    places = [[tuple(place) for place in rng.normal(size=(3, 2)).tolist()] for _ in range(24)]
    nearest = [min(math.dist(*pair) for pair in combinations(scene, 2)) for scene in places]
    schema = plane(operations=("identity", "distance"))
    scenes = scenes_in(schema, places)
    tree = grown(scenes, np.array(nearest) < 0.6, alpha=0.3, attempts=1).tree
    assert not tree.is_stub
    shuffled = scenes_in(schema, [[scene[i] for i in rng.permutation(3)] for scene in places])
    here, there = query(tree, scenes), query(tree, shuffled)

    np.testing.assert_array_equal(there.leaf, here.leaf)
    np.testing.assert_allclose(there.densities.prod(axis=1), here.densities.prod(axis=1), rtol=1e-9)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"test": "t"}, "test must be one of 'likelihood-ratio', 'permutation', got 't'"),
        ({"search": "s"}, "search must be one of 'screened', 'exhaustive', got 's'"),
        ({"alpha": 0.0}, "alpha must be a number above 0 and below 1, got 0.0"),
        ({"alpha": 1.0}, "alpha must be a number above 0 and below 1, got 1.0"),
        ({"alpha": math.nan}, "alpha must be"),
        ({"attempts": 0}, "attempts must be an integer of at least 1, got 0"),
        ({"attempts": -2}, "attempts must be an integer of at least 1"),
        ({"permutations": 0}, "permutations must be an integer of at least 1"),
        ({"max_points": 0}, "max_points must be an integer of at least 1"),
        (
            {"test": "permutation", "permutations": 18},
            r"permutations=18 can never reach alpha=0.05: use at least 19",
        ),
        ({"test": "permutation", "alpha": 0.3, "permutations": 2}, "use at least 3"),
    ],
)
def test_settings_out_of_range_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        TreeSettings(**options)


@pytest.mark.parametrize("n", [2, 3, 10, 20, 49, 100, 103])
def test_the_number_of_permutations_recommended_is_accepted(n: int) -> None:
    # 1 / 49 * 49 is rounded below 1.
    assert TreeSettings(test="permutation", alpha=1 / n, permutations=n - 1).permutations == n - 1
    if n > 2:
        with pytest.raises(InputError, match=f"use at least {n - 1}$"):
            TreeSettings(test="permutation", alpha=1 / n, permutations=n - 2)


def test_few_permutations_are_fine_for_the_other_test() -> None:
    assert TreeSettings(permutations=1).permutations == 1


def test_settings_of_the_volume_are_passed_on() -> None:
    scenes, labels = heavy_scenes()
    settings = TreeSettings(covagg=CovAggSettings(prior_weight=2.5))
    tree = grow(scenes, labels, rng=np.random.default_rng(0), settings=settings).tree

    assert tree.nodes[1].volume.prior_weight == 2.5  # type: ignore[union-attr]
    assert replace(settings, alpha=0.1).covagg.prior_weight == 2.5


@pytest.mark.parametrize(
    ("n_scenes", "n_labels", "message"),
    [(0, 0, "pass at least one scene and one label for each: got 0"), (3, 2, r"got 3 and \(2,\)")],
)
def test_labels_that_do_not_fit_are_refused(n_scenes: int, n_labels: int, message: str) -> None:
    with pytest.raises(InputError, match=message):
        grown(of_weights([[1.0]] * n_scenes), np.zeros(n_labels, dtype=np.bool_))


def test_values_too_large_for_a_volume_are_refused() -> None:
    scenes = of_weights([[1e31], [1.0], [2.0]])
    with pytest.raises(InputError, match=r"beyond 1e\+30"):
        grown(scenes, np.array([True, False, True]))


@compiled_only
def test_growth_reports_its_questions_and_gives_the_same_tree() -> None:
    scenes, labels = heavy_scenes()
    silent = grown(scenes, labels, test="permutation", search="exhaustive")
    heard: list[Stage] = []
    with listening(heard.append):
        told = grown(scenes, labels, test="permutation", search="exhaustive")

    assert told.tree.to_dict() == silent.tree.to_dict()
    assert Stage("expansions prepared", 0, None, ("question 1",)) in heard
    assert Stage("expansions tried", 0, 1, ("question 1",)) in heard
    assert Stage("expansions tried", 0, 1, ("question 1", "shuffle 7 of 99")) in heard
