from __future__ import annotations

import math

import numpy as np
import pytest

from interpreted import compiled_only
from relforest.forests.tree_features import width
from relforest.mappings import Mapping
from relforest.rl.action_scenes import action_scenes
from relforest.rl.policy import RandomPolicy
from relforest.rl.rollout import rollout
from relforest.rl.settings import FEATURE_MODES, FeatureMode
from relforest.rl.value import ValueFunction, action_schemas, forest_features
from relforest.scenes import Scenes, Schema
from relforest.smdp import Decision
from relforest.support.errors import InputError
from relforest.trees import Instantiation, Leaf, Question, Tree
from relforest.trees.kernels import MOST_STEPS
from rl.small_worlds import (
    ACTION_TYPES,
    LOCATION,
    PICK_SCHEMA,
    SCHEMA,
    Picking,
    beside,
    near,
    within,
)

FORESTS = ((near(SCHEMA), near(SCHEMA, mean=0.9)), (beside(), near(PICK_SCHEMA), beside()))


def random_value(mode: FeatureMode, seed: int = 0) -> ValueFunction:
    rng = np.random.default_rng(seed)
    columns = [1 + sum(width(tree, mode) for tree in trees) for trees in FORESTS]
    weights = tuple(rng.standard_normal(count) for count in columns)
    return ValueFunction(SCHEMA, ACTION_TYPES, mode, FORESTS, weights)


def decision(*things: float) -> Decision:
    numbers = np.arange(1 + len(things))
    return Decision(np.array(things).reshape(-1, 1), np.minimum(numbers, 1), numbers[:, None] - 1, numbers)


def test_the_features_of_a_forest_have_a_bias_first() -> None:
    numbers = np.arange(2)
    scenes = Scenes(SCHEMA, np.array([[0.35], [0.75]]), numbers, numbers, np.ones_like(numbers))
    assert forest_features([near(SCHEMA), near(SCHEMA, mean=0.8)], scenes, "bits").tolist() == [
        [1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
        [1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0],
    ]
    assert forest_features([], scenes, "bits").tolist() == [[1.0], [1.0]]


def test_nothing_learned_is_worth_nothing() -> None:
    value = ValueFunction.zero(SCHEMA, ACTION_TYPES, "bits")
    assert value.values(decision(0.1, 0.9)).tolist() == [0.0, 0.0, 0.0]
    assert (value.n_trees, value.n_leaves) == (0, 0)


def test_values_by_hand() -> None:
    weights = (np.array([3.0]), np.array([0.5, 1.0, 2.0, 10.0, 20.0, 100.0, 200.0]))
    value = ValueFunction(SCHEMA, ACTION_TYPES, "densities+bits", ((), (near(PICK_SCHEMA),)), weights)
    # Wait: 3. Pick inside, at 0.35: 0.5 + 1 + 2 exp(-0.005); outside, at 0.75: 0.5 + 10 + 20 exp(-0.125).
    # Pick a thing of unknown location: 0.5 + 100, no density.
    found = value.values(decision(0.35, 0.75, np.nan))
    expected = [3.0, 1.5 + 2 * math.exp(-0.005), 10.5 + 20 * math.exp(-0.125), 100.5]
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    assert (value.n_trees, value.n_leaves) == (1, 3)


@pytest.mark.parametrize("mode", FEATURE_MODES)
def test_the_fast_path_is_features_times_weights(mode: FeatureMode) -> None:
    value = random_value(mode)
    experience = rollout(Picking(things=4), RandomPolicy(), 10, np.random.SeedSequence(1))
    schemas = action_schemas(SCHEMA, ACTION_TYPES)
    slow = np.empty(len(experience.types))
    for action_type, schema in enumerate(schemas):
        own = np.flatnonzero(experience.types == action_type)
        scenes = action_scenes(experience, own, schema)
        slow[own] = forest_features(FORESTS[action_type], scenes, mode) @ value.weights[action_type]
        np.testing.assert_array_equal(value.scene_values(action_type, scenes), slow[own])
    for state in range(experience.n_states):
        objects = slice(*experience.objects[state : state + 2])
        candidates = slice(*experience.candidates[state : state + 2])
        offered = Decision(
            experience.matrix[objects],
            experience.types[candidates],
            experience.arguments[candidates],
            np.arange(candidates.stop - candidates.start),
        )
        np.testing.assert_allclose(value.values(offered), slow[candidates], rtol=1e-12, atol=1e-12)


def test_values_follow_the_order_of_the_decision() -> None:
    value, offered = random_value("densities+bits"), decision(0.2, 0.6, 0.55)
    order = np.array([2, 0, 3, 1])
    shuffled = Decision(
        offered.objects, offered.types[order], offered.arguments[order], offered.indices[order]
    )
    np.testing.assert_array_equal(value.values(shuffled), value.values(offered)[order])


def test_the_order_of_objects_does_not_matter() -> None:
    value = random_value("densities+bits")
    things = np.array([0.2, 0.6, 0.55, 0.9])
    order = np.array([3, 1, 0, 2])
    found = value.values(decision(*things[order]))
    np.testing.assert_allclose(found[1:], value.values(decision(*things))[1:][order], rtol=1e-12)


@compiled_only
def test_a_search_that_has_to_pause_finds_the_same() -> None:
    # Twice more pairs of objects than nodes that one call of the kernel may visit.
    things = np.linspace(0.0, 1.0, 460)
    pairs = Question(Mapping("distance", LOCATION), (0, 1), within(0.0, 0.001), 3, 4, 5)
    leaves = [Leaf(probability, 1, 1) for probability in (0.9, 0.1, 0.2)]
    forest = (Tree(SCHEMA, (Instantiation(1), Instantiation(2), pairs, *leaves)), near(SCHEMA))
    weights = np.linspace(1.0, 2.0, 13)
    value = ValueFunction(SCHEMA, ACTION_TYPES[:1], "densities+bits", (forest,), (weights,))
    scene = Scenes(SCHEMA, things[:, None], np.arange(460), np.array([0]), np.array([460]))
    waiting = Decision(things[:, None], np.zeros(3, int), np.full((3, 1), -1), np.arange(3))

    assert MOST_STEPS < 460 * 459
    np.testing.assert_allclose(value.values(waiting), value.scene_values(0, scene).repeat(3), rtol=1e-12)


def test_no_actions_have_no_values() -> None:
    empty = Decision(
        np.zeros((1, 1)), np.empty(0, np.int64), np.empty((0, 1), np.int64), np.empty(0, np.int64)
    )
    assert random_value("bits").values(empty).tolist() == []


@pytest.mark.parametrize(
    ("forests", "weights", "message"),
    [
        (((),), (np.zeros(1),), "each of the 2 action types needs a forest and a weight vector, got 1 and 1"),
        (((), ()), (np.zeros(1), np.zeros(2)), "'pick' needs 1 finite weights.* got the shape"),
        (((), ()), (np.zeros(1), np.array([np.nan])), "'pick' needs 1 finite weights"),
        (((), ()), (np.zeros(1), np.array([1e101])), "'pick' needs 1 finite weights"),
        (((near(PICK_SCHEMA),), ()), (np.zeros(7), np.zeros(1)), "tree of action type 'wait' is for scenes"),
    ],
)
def test_parts_that_do_not_fit_are_refused(
    forests: tuple[tuple[Tree, ...], ...], weights: tuple[np.ndarray, ...], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        ValueFunction(SCHEMA, ACTION_TYPES, "densities+bits", forests, weights)


def test_unknown_features_are_refused() -> None:
    with pytest.raises(InputError, match="features must be one of 'densities\\+bits', 'bits', 'probability'"):
        ValueFunction.zero(SCHEMA, ACTION_TYPES, "leaves")  # type: ignore[arg-type]


def test_schemas_of_actions_have_their_parameters() -> None:
    assert action_schemas(SCHEMA, ACTION_TYPES) == (SCHEMA, Schema(SCHEMA.attributes, ("thing",)))
