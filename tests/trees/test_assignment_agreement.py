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


@pytest.mark.parametrize("task", ["classes", "real"])
@pytest.mark.parametrize("seed", range(10))
def test_other_targets_at_random(task: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    n_leaves, n = int(rng.integers(1, 6)), int(rng.integers(4, 20))
    presence = rng.random((n_leaves, n)) < 0.5
    presence[rng.integers(n_leaves), ~presence.any(axis=0)] = True
    weights = rng.uniform(0.5, 2, size=n)
    if task == "real":
        target = Target.real(rng.normal(size=n), weights)
    else:
        target = Target.classes(rng.integers(0, 3, size=n), 3, weights)

    def value(leaf_sums: NDArray[np.float64]) -> float:
        if task == "real":
            return float(leaf_sums[1] / leaf_sums[0])
        return float(np.delete(leaf_sums, target.common).max() / leaf_sums.sum())

    undecided, bound, winner = np.ones(n, dtype=np.bool_), np.inf, np.full(n, -1)
    values: dict[int, float] = {}
    while len(values) < n_leaves:
        here = {leaf: presence[leaf] & undecided for leaf in range(n_leaves) if leaf not in values}
        open_leaves = {leaf: value(target.sums[own].sum(axis=0)) for leaf, own in here.items() if own.any()}
        # Leaves without scenes come last, with the value of all scenes.
        best = max(open_leaves or here, key=lambda leaf: open_leaves.get(leaf, 0.0))
        values[best] = min(open_leaves.get(best, value(target.sums.sum(axis=0))), bound)
        bound = values[best] - 1e-6 if task == "real" else values[best] * (1 - 1e-6)
        winner[here[best]] = best
        undecided &= ~presence[best]
    found = target.assign(presence)

    np.testing.assert_array_equal(found.winner, winner)
    np.testing.assert_allclose(found.value, [values[leaf] for leaf in range(n_leaves)], rtol=1e-9, atol=1e-12)
    for leaf in range(n_leaves):
        expected = target.sums[winner == leaf].sum(axis=0)
        np.testing.assert_allclose(found.sums[leaf], expected, rtol=1e-9, atol=1e-12)
