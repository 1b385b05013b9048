from __future__ import annotations

import math

import numpy as np
import pytest

from interpreted import compiled_only
from relforest.forests.tree_features import width
from relforest.mappings import Mapping
from relforest.rl.frozen import ForestFeatures
from relforest.rl.settings import FEATURE_MODES, FeatureMode
from relforest.rl.value import ValueFunction
from relforest.smdp import Decision
from relforest.trees import Instantiation, Leaf, Question, Tree
from rl.small_worlds import ACTION_TYPES, LOCATION, PICK_SCHEMA, SCHEMA, beside, near, within

FORESTS = ((near(SCHEMA), near(SCHEMA, mean=0.9)), (beside(), near(PICK_SCHEMA), beside()))


def frozen(
    mode: FeatureMode, forests: tuple[tuple[Tree, ...], ...] = FORESTS
) -> tuple[ValueFunction, ForestFeatures]:
    rng = np.random.default_rng(0)
    sizes = [1 + sum(width(tree, mode) for tree in trees) for trees in forests]
    weights = tuple(rng.standard_normal(size) for size in sizes)
    value = ValueFunction(SCHEMA, ACTION_TYPES[: len(forests)], mode, forests, weights)
    return value, ForestFeatures(value, tuple(tuple("t.json" for _ in trees) for trees in forests))


def decision(*things: float) -> Decision:
    numbers = np.arange(1 + len(things))
    return Decision(np.array(things).reshape(-1, 1), np.minimum(numbers, 1), numbers[:, None] - 1, numbers)


def test_features_by_hand() -> None:
    _, features = frozen("densities+bits", ((), (near(PICK_SCHEMA),)))
    indices, values = features.features(decision(0.35, 0.75, np.nan))

    assert (features.n_features, features.n_active) == (8, 3)
    assert indices.tolist() == [list(range(8))] * 4
    # Wait; then a constant, and bit and density of the leaves inside, outside and unknown.
    near_by, far = math.exp(-0.005), math.exp(-0.125)
    expected = np.array(
        [
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 1.0, near_by, 0.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0, 1.0, far, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
        ]
    )
    np.testing.assert_allclose(values, expected, rtol=1e-12)


@pytest.mark.parametrize("mode", FEATURE_MODES)
def test_the_weights_of_the_policy_give_its_values(mode: FeatureMode) -> None:
    value, features = frozen(mode)
    rng = np.random.default_rng(1)
    for _ in range(20):
        offered = decision(*rng.random(4))
        _, rows = features.features(offered)

        np.testing.assert_allclose(rows @ np.concatenate(value.weights), value.values(offered), rtol=1e-12)
        assert np.count_nonzero(rows, axis=1).max() <= features.n_active


@compiled_only
def test_a_search_that_has_to_pause_finds_the_same() -> None:
    things = np.linspace(0.0, 1.0, 460)
    pairs = Question(Mapping("distance", LOCATION), (0, 1), within(0.0, 0.001), 3, 4, 5)
    leaves = [Leaf(probability, 1, 1) for probability in (0.9, 0.1, 0.2)]
    slow = Tree(SCHEMA, (Instantiation(1), Instantiation(2), pairs, *leaves))
    value, features = frozen("densities+bits", ((slow, near(SCHEMA)),))
    waiting = Decision(things[:, None], np.zeros(3, int), np.full((3, 1), -1), np.arange(3))

    _, rows = features.features(waiting)
    np.testing.assert_allclose(rows @ value.weights[0], value.values(waiting), rtol=1e-12)


def test_other_trees_are_told_apart() -> None:
    _, features = frozen("bits")
    _, same = frozen("bits")
    _, other = frozen("bits", ((near(SCHEMA), near(SCHEMA, mean=0.8)), FORESTS[1]))

    assert features.to_dict() == same.to_dict()
    assert features.to_dict() != other.to_dict()
    assert features.n_features == other.n_features
