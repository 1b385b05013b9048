"""The compiled assignment of leaf probabilities against its plain twin, and the twin against hand work."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from reference import leaves as twin
from relforest.trees.criterion import Target


def check(presence: NDArray[np.bool_], labels: NDArray[np.bool_]) -> twin.Assignment:
    """Assert that both assignments agree and return the twin's."""
    found, expected = Target.binary(labels).assign(presence), twin.assign(presence, labels)
    np.testing.assert_allclose(found.value, expected.probabilities, rtol=1e-14)
    np.testing.assert_array_equal(found.sums, np.column_stack([expected.negatives, expected.positives]))
    np.testing.assert_array_equal(found.winner, expected.winners)
    return expected


@pytest.mark.parametrize("seed", range(30))
def test_random_presence(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n_leaves, n_scenes = int(rng.integers(1, 8)), int(rng.integers(1, 40))
    presence = rng.random((n_leaves, n_scenes)) < rng.random((n_leaves, 1))
    presence[rng.integers(n_leaves), ~presence.any(axis=0)] = True
    check(presence, rng.random(n_scenes) < rng.random())


def test_a_scene_counts_at_one_leaf_only() -> None:
    # Leaf 0 holds scenes 0, 1, 2 with 2 positives (2/3), leaf 1 holds 2, 3, 4 with 1 (1/3). Leaf 0 comes
    # first and takes scene 2, a negative; leaf 1 keeps 3 (positive) and 4: 1/2.
    presence = np.array([[1, 1, 1, 0, 0], [0, 0, 1, 1, 1]], dtype=np.bool_)
    found = check(presence, np.array([1, 1, 0, 1, 0], dtype=np.bool_))
    assert found.probabilities.tolist() == pytest.approx([2 / 3, 1 / 2])
    assert found.winners.tolist() == [0, 0, 0, 1, 1]
    assert found.positives.tolist() == [2, 1]
    assert found.negatives.tolist() == [1, 1]


def test_a_later_leaf_stays_below_an_earlier_one() -> None:
    # Leaf 0: scenes 0, 1, 2, 4, 5 with 3 positives (3/5). Leaf 1: scenes 2, 3, 4 with 1 (1/3), until leaf 0
    # takes the negatives 2 and 4 from it; what is left is the positive 3 alone, 1/1, capped below 3/5.
    presence = np.array([[1, 1, 1, 0, 1, 1], [0, 0, 1, 1, 1, 0]], dtype=np.bool_)
    found = check(presence, np.array([1, 1, 0, 1, 0, 1], dtype=np.bool_))
    assert found.probabilities[0] == pytest.approx(3 / 5)
    assert found.probabilities[1] == pytest.approx(3 / 5 * (1 - 1e-6), rel=1e-12)


def test_a_leaf_without_scenes_gets_the_base_rate() -> None:
    presence = np.array([[1, 1, 0, 0], [0, 0, 0, 0], [0, 0, 1, 1]], dtype=np.bool_)
    found = check(presence, np.array([1, 1, 1, 0], dtype=np.bool_))
    # Base rate 3/4, but leaf 2 has 1/2 and was assigned before.
    assert found.probabilities.tolist() == pytest.approx([1, 0.5 * (1 - 1e-6), 0.5], rel=1e-12)


def test_the_first_leaf_wins_a_tie() -> None:
    presence = np.ones((3, 4), dtype=np.bool_)
    found = check(presence, np.array([1, 0, 0, 0], dtype=np.bool_))
    assert found.winners.tolist() == [0, 0, 0, 0]
    assert found.probabilities[0] == pytest.approx(0.25)
