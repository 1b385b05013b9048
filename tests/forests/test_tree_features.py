from __future__ import annotations

import math

import numpy as np
import pytest

from relforest.forests.tree_features import TreeMode, leaf_widths, tree_features, width
from relforest.scenes import Scenes
from relforest.trees import query
from rl.small_worlds import PICK_SCHEMA, SCHEMA, beside, near


def scenes_at(*locations: float) -> Scenes:
    """One scene per location, with one object and no arguments."""
    numbers = np.arange(len(locations))
    return Scenes(SCHEMA, np.array(locations)[:, None], numbers, numbers, np.ones_like(numbers))


def picks(*things: float) -> Scenes:
    """One scene with these things; the first one is the argument."""
    n = len(things)
    return Scenes(
        PICK_SCHEMA, np.array(things)[:, None], np.arange(n), np.array([0]), np.array([n]), np.array([[0]])
    )


def test_a_question_with_three_leaves_by_hand() -> None:
    tree, scenes = near(SCHEMA), scenes_at(0.35, 0.75, np.nan)
    features = tree_features(tree, query(tree, scenes), "densities+bits")
    # Bit and density of the Yes leaf, of the No leaf, of the Error leaf; density exp(-(x - 0.25)^2 / 2).
    expected = [
        [1.0, math.exp(-0.005), 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, math.exp(-0.125), 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
    ]
    np.testing.assert_allclose(features, expected, rtol=1e-12)


def test_a_leaf_has_a_density_for_every_question_above_it() -> None:
    tree = beside()
    assert leaf_widths(tree, "densities+bits") == (3, 3, 3, 2, 2)
    # The argument is at 0.6, the other thing at 0.65: first question 50 * 0.05^2 / 2, second 3 * 0.15^2 / 2.
    features = tree_features(tree, query(tree, picks(0.6, 0.65)), "densities+bits")
    expected = np.zeros((1, 13))
    expected[0, :3] = [1.0, math.exp(-0.0625), math.exp(-0.03375)]
    np.testing.assert_allclose(features, expected, rtol=1e-12)


def test_the_representative_sequence_has_the_largest_product() -> None:
    # Things at 0.6 +- 0.05: the first question says the same of both, the second prefers 0.55, with
    # exp(-3 * 0.05^2 / 2).
    tree = beside()
    features = tree_features(tree, query(tree, picks(0.6, 0.65, 0.55)), "densities+bits")
    np.testing.assert_allclose(features[0, :3], [1.0, math.exp(-0.0625), math.exp(-0.00375)], rtol=1e-12)


def test_bits_and_probabilities() -> None:
    tree, scenes = near(SCHEMA), scenes_at(0.35, 0.75, np.nan)
    answers = query(tree, scenes)
    assert tree_features(tree, answers, "bits").tolist() == np.eye(3).tolist()
    assert tree_features(tree, answers, "probability").tolist() == [[0.9], [0.2], [0.5]]


@pytest.mark.parametrize(("mode", "expected"), [("densities+bits", 13), ("bits", 5), ("probability", 1)])
def test_widths(mode: TreeMode, expected: int) -> None:
    tree, scenes = beside(), picks(0.1, 0.9)
    assert width(tree, mode) == expected
    assert tree_features(tree, query(tree, scenes), mode).shape == (1, expected)
