"""Conditions and trees of them mean what their definitions say."""

from __future__ import annotations

import signal
from functools import partial

import numpy as np
import pytest

from forest_scenes import RELATIONS, holds, random_condition, random_scenes, related
from interpreted import compiled_only
from relforest.forests import Condition, Ensemble, GrowthSettings, SceneTree, Split, Value
from relforest.forests.features import features
from relforest.forests.statements import Bound, Statement
from relforest.mappings import Mapping
from relforest.scenes import Relation, Scenes
from relforest.support.errors import InputError
from small_trees import plane, scenes_in


def tree_of(condition: Condition) -> SceneTree:
    return SceneTree((Split(condition, 1, 2, 0.0), Value((1.0,), 0), Value((0.0,), 0)))


def ensemble_of(scenes: Scenes, *trees: SceneTree) -> Ensemble:
    return Ensemble(scenes.schema, np.zeros(1), trees, np.ones(len(trees)))


@pytest.mark.parametrize("relations", [(), RELATIONS])
@pytest.mark.parametrize("seed", range(6))
def test_conditions_hold_as_defined(seed: int, relations: tuple[Relation, ...]) -> None:
    rng = np.random.default_rng(seed)
    n_parameters = seed % 3
    scenes = random_scenes(rng, 12, n_parameters)
    scenes = related(rng, scenes) if relations else scenes
    conditions = [random_condition(rng, n_parameters, relations) for _ in range(40)]
    ensemble = ensemble_of(scenes, *map(tree_of, conditions))

    found = ensemble.leaves(scenes) == 0

    expected = [[holds(condition, scenes, scene) for condition in conditions] for scene in range(12)]
    assert found.tolist() == expected
    assert 0 < np.count_nonzero(found) < found.size


def test_the_order_of_objects_and_threads_do_not_matter() -> None:
    rng = np.random.default_rng(0)
    scenes = random_scenes(rng, 300, 1)
    ensemble = ensemble_of(scenes, *(tree_of(random_condition(rng, 1)) for _ in range(20)))
    rows = scenes.rows.copy()
    for start, count in zip(scenes.starts, scenes.counts, strict=True):
        rows[start : start + count] = rng.permutation(rows[start : start + count])
    shuffled = Scenes(scenes.schema, scenes.matrix, rows, scenes.starts, scenes.counts, scenes.arguments)

    expected = ensemble.scores(scenes)

    assert np.array_equal(ensemble.scores(shuffled), expected)
    assert np.array_equal(ensemble.scores(scenes, n_jobs=2), expected)
    assert np.array_equal(ensemble.scores(scenes.take([5, 3])), expected[[5, 3]])


def test_a_tree_leads_each_scene_to_one_leaf_by_its_answers() -> None:
    rng = np.random.default_rng(1)
    scenes = random_scenes(rng, 40, 2)
    first, second = random_condition(rng, 2), random_condition(rng, 2)
    nodes = (
        Split(first, 1, 2, 0.0),
        Value((1.0,), 0),
        Split(second, 3, 4, 0.0),
        Value((2.0,), 0),
        Value((3.0,), 0),
    )
    ensemble = ensemble_of(scenes, SceneTree(nodes))

    for scene in range(len(scenes)):
        yes = [holds(condition, scenes, scene) for condition in (first, second)]
        expected = 1.0 if yes[0] else 2.0 if yes[1] else 3.0
        assert ensemble.scores(scenes.take([scene]))[0, 0] == expected
        path = ensemble.path(0, scenes.take([scene]))
        assert [is_true for _, is_true, _ in path] == (yes[:1] if yes[0] else yes)


def test_scores_are_weighted_sums() -> None:
    rng = np.random.default_rng(2)
    scenes = random_scenes(rng, 10, 0)
    condition = random_condition(rng, 0)
    tree = SceneTree((Split(condition, 1, 2, 0.0), Value((1.0, 10.0), 0), Value((0.0, -10.0), 0)))
    ensemble = Ensemble(scenes.schema, np.array([0.5, 0.0]), (tree, tree), np.array([2.0, 0.25]))

    yes = np.array([holds(condition, scenes, scene) for scene in range(10)])

    assert np.array_equal(ensemble.scores(scenes)[:, 0], 0.5 + 2.25 * yes)
    assert np.array_equal(ensemble.scores(scenes)[:, 1], np.where(yes, 22.5, -22.5))


def test_a_condition_on_every_object_survives_files() -> None:
    rng = np.random.default_rng(3)
    scenes = random_scenes(rng, 40, 1)
    conditions = [each for each in (random_condition(rng, 1) for _ in range(60)) if each.every]
    ensemble = ensemble_of(scenes, *map(tree_of, conditions))
    read = Ensemble.from_dict(ensemble.to_dict())

    assert read.conditions == tuple(conditions)
    assert np.array_equal(read.leaves(scenes), ensemble.leaves(scenes))
    path = ensemble.path(0, scenes.take([0]))
    assert path[0][1] == holds(conditions[0], scenes, 0)


def test_settings_of_every_object_are_checked() -> None:
    with pytest.raises(InputError, match="every must be True or False"):
        GrowthSettings(every=1)  # type: ignore[arg-type]


@compiled_only
@pytest.mark.parametrize("n_jobs", [1, 2])
def test_a_scene_without_end_is_interrupted(n_jobs: int) -> None:
    schema = plane()
    far = Statement(Mapping("distance", schema["location"]), (0, 1), Bound(0, "at least", 1e9))
    few, many = (scenes_in(schema, [[(float(i), 0.0) for i in range(n)]]) for n in (3, 100_000))
    ensemble = ensemble_of(few, tree_of(Condition(2, (far,))))
    assert not ensemble.scores(few).any()
    assert not features(ensemble, few, "counts").any()

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        for measured in (ensemble.leaves, partial(features, ensemble, mode="counts")):
            signal.setitimer(signal.ITIMER_REAL, 0.3)
            with pytest.raises(KeyboardInterrupt):
                measured(many, n_jobs=n_jobs)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
