"""Targets by hand: what leaves are worth with weights, for several classes and for real numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.trees import ClassLeaf, Leaf, MeanLeaf
from relforest.trees.criterion import Target, effective_weights

Floats = NDArray[np.float64]

# Leaf 0 holds scenes 0, 1, 2; leaf 1 holds 2, 3, 4.
OVERLAPPING = np.array([[1, 1, 1, 0, 0], [0, 0, 1, 1, 1]], dtype=np.bool_)
EVERYWHERE = np.ones((1, 5), dtype=np.bool_)


def floats(*values: float) -> Floats:
    return np.array(values, dtype=np.float64)


def test_effective_weights() -> None:
    # (1 + 1 + 2)^2 / (1 + 1 + 4) scenes.
    weights = effective_weights(floats(1, 1, 2))
    assert weights.sum() == pytest.approx(16 / 6)
    assert (weights / weights[0]).tolist() == pytest.approx([1, 1, 2])
    np.testing.assert_allclose(effective_weights(floats(5, 5, 10)), weights)
    # Nothing overflows.
    np.testing.assert_allclose(effective_weights(floats(1e300, 1e300, 2e300)), weights)


def test_equal_weights_are_no_weights() -> None:
    labels = np.array([1, 1, 0, 1, 0], dtype=np.bool_)
    plain, weighted = Target.binary(labels), Target.binary(labels, np.full(5, 3.0))

    np.testing.assert_array_equal(plain.sums, weighted.sums)
    assert not weighted.weighted


def test_weighted_labels_by_hand() -> None:
    # The positives 0, 1, 3 weigh 1, the negatives 2 and 4 weigh 2 and 1.
    weights = floats(1, 1, 2, 1, 1)
    target = Target.binary(np.array([1, 1, 0, 1, 0], dtype=np.bool_), weights)
    found = target.assign(OVERLAPPING)

    # Leaf 0 wins scenes 0, 1, 2 at 2 of 4; leaf 1 the others at 1 of 2, but stays below.
    below = 0.5 * (1 - 1e-6)
    assert found.value.tolist() == pytest.approx([0.5, below], rel=1e-12)
    assert found.winner.tolist() == [0, 0, 0, 1, 1]
    # 6 in sum, 36 / 8 scenes.
    unit = 36 / 8 / 6
    np.testing.assert_allclose(found.sums, unit * np.array([[2, 2], [1, 1]]))
    assert found.log_likelihood == pytest.approx(unit * 6 * math.log(0.5), rel=1e-9)
    # Leaves count scenes.
    assert target.leaves(found) == [Leaf(0.5, 1, 2), Leaf(float(found.value[1]), 1, 1)]
    (view,) = target.views(np.array([0, 2, 3]))
    assert view.labels.tolist() == [True, False, True]
    assert view.evidence is not None
    np.testing.assert_allclose(view.evidence, unit * np.array([[0, 1], [2, 0], [0, 1]]))
    # A volume with scene 0 alone: 1 of 1, and 1 of 3 outside.
    score = unit * (math.log(1 / 3) + 2 * math.log(2 / 3))
    null = unit * 4 * math.log(1 / 2)
    assert target.gain(view, score, np.array([0, 2, 3])) == pytest.approx(score - null)


def test_real_targets_by_hand() -> None:
    y = floats(4, 6, 5, 1, -1)
    target = Target.real(y)
    found = target.assign(OVERLAPPING)

    # Mean 3, variance (1 + 9 + 4 + 4 + 16) / 5. Leaf 0 wins 0, 1, 2 at 5, leaf 1 the others at 0.
    unit = math.sqrt(34 / 5)
    assert (3 + unit * found.value).tolist() == pytest.approx([5, 0])
    assert found.winner.tolist() == [0, 0, 0, 1, 1]
    # What is left is (1 + 1 + 0 + 1 + 1) of 34.
    assert found.log_likelihood == pytest.approx(-2.5 * math.log(4 / 34))
    assert target.assign(EVERYWHERE).log_likelihood == pytest.approx(0)
    first, second = target.leaves(found)
    assert isinstance(first, MeanLeaf)
    assert (first.probability, first.deviation) == pytest.approx((5, math.sqrt(2 / 3)))
    assert (first.negatives, first.positives) == (0, 3)
    assert first.summary == "mean 5  (deviation 0.816, 3 scenes)"
    assert second.probability == pytest.approx(0)
    assert second.positives == 2


def test_weighted_real_targets_by_hand() -> None:
    # Mean 1, variance (3 * 1 + 1 * 9) / 4; 16 / 10 scenes.
    target = Target.real(floats(0, 4), floats(3, 1))
    found = target.assign(np.ones((1, 2), dtype=np.bool_))

    assert target.scale == pytest.approx((1, math.sqrt(3)))
    assert found.value.tolist() == pytest.approx([0], abs=1e-12)
    assert found.sums[0, [0, 2]].tolist() == pytest.approx([1.6, 1.6])


def test_a_later_leaf_stays_lower() -> None:
    # Leaf 0 wins 5 and 6 by its mean 5.5; then leaf 1 has but a 9 left, and may not exceed it.
    presence = np.array([[1, 1, 0, 0], [1, 0, 1, 0], [0, 0, 0, 1]], dtype=np.bool_)
    target = Target.real(floats(1, 12, 9, -20))
    found = target.assign(presence)

    assert found.winner.tolist() == [0, 0, 1, 2]
    assert found.value[1] == pytest.approx(found.value[0] - 1e-6, abs=1e-12)


def test_volumes_for_real_targets() -> None:
    target = Target.real(floats(4, 6, 5, 1, -1))
    scenes = np.array([0, 1, 3])
    (view,) = target.views(scenes)

    # Above the mean of these three, 11 / 3.
    assert view.labels.tolist() == [True, True, False]
    assert view.objective == "squared-error"
    assert view.evidence is not None
    unit, y = math.sqrt(34 / 5), (floats(4, 6, 1) - 3) / math.sqrt(34 / 5)
    np.testing.assert_allclose(view.evidence, np.column_stack([np.ones(3), y]))
    # 4 and 6 against 1: of (1 + 49 + 64) / 9 remain 2.
    score = (y[0] + y[1]) ** 2 / 2 + y[2] ** 2
    assert target.gain(view, score, scenes) == pytest.approx(-1.5 * math.log(2 / (114 / 9)))
    assert unit > 1


def test_several_classes_by_hand() -> None:
    # Class 0 is the common one.
    codes = np.array([1, 1, 0, 2, 0, 0])
    target = Target.classes(codes, 3)
    presence = np.array([[1, 1, 1, 0, 0, 0], [0, 0, 1, 1, 1, 1]], dtype=np.bool_)
    found = target.assign(presence)

    assert target.common == 0
    assert target.n_values == 2
    # Leaf 0: 2 of 3 are of class 1. Leaf 1: 1 of the 3 left is of class 2.
    assert found.value.tolist() == pytest.approx([2 / 3, 1 / 3])
    assert found.winner.tolist() == [0, 0, 0, 1, 1, 1]
    expected = 2 * math.log(2 / 3) + math.log(1 / 3)
    assert found.log_likelihood == pytest.approx(2 * expected)
    assert target.leaves(found) == [
        ClassLeaf(2 / 3, 1, 2, (1 / 3, 2 / 3, 0.0), (1, 2, 0)),
        ClassLeaf(1 / 3, 2, 1, (2 / 3, 0.0, 1 / 3), (2, 0, 1)),
    ]
    assert target.leaves(found)[0].summary == "0.33, 0.67, 0.00  (1, 2, 0 of 3 scenes)"
    # One class against the rest, except for the common one.
    assert [view.labels.tolist() for view in target.views(np.arange(4))] == [
        [True, True, False, False],
        [False, False, False, True],
    ]
    assert [len(target.views(np.array(scenes))) for scenes in ([2, 4], [0, 2])] == [0, 1]


def test_a_leaf_without_scenes_gets_the_shares_of_all() -> None:
    target = Target.classes(np.array([1, 0, 0, 2]), 3)
    presence = np.array([[1, 1, 1, 1], [0, 0, 0, 0]], dtype=np.bool_)
    empty = target.leaves(target.assign(presence))[1]

    assert isinstance(empty, ClassLeaf)
    assert (empty.shares, empty.counts) == ((0.5, 0.25, 0.25), (0, 0, 0))
    assert empty.probability < 0.25


def test_potential_of_other_targets() -> None:
    # Perfect separation of the largest special class, or of what is above the mean.
    target = Target.classes(np.array([0, 0, 0, 1, 1, 2]), 3)
    root = np.ones((1, 6), dtype=np.bool_)
    expected = 3 * math.log(3 / 4) + math.log(1 / 4)
    assert target.potential(root, target.assign(root), 0) == pytest.approx(expected)
    real = Target.real(floats(0, 0, 1, 1, 1, 1))
    assert real.potential(root, real.assign(root), 0) == pytest.approx(-3 * math.log(1e-9))


def test_permuting_moves_all_that_is_known_of_a_scene() -> None:
    target = Target.real(floats(1, 2, 4), floats(1, 1, 2))
    moved = target.permuted(np.array([2, 0, 1]))

    np.testing.assert_array_equal(moved.sums, target.sums[[2, 0, 1]])
    assert moved.strata.tolist() == target.strata[[2, 0, 1]].tolist()
    assert moved.scale == target.scale


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (floats(1, math.nan), "targets contain NaN or infinite values"),
        (floats(1, math.inf), "targets contain NaN or infinite values"),
        (floats(3, 3, 3), "all targets are 3: there is nothing to explain"),
        (floats(0, 0), "all targets are 0"),
        (floats(1e16, 1e16 + 2), "all targets are 1e"),
    ],
)
def test_targets_without_meaning_are_refused(values: Floats, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Target.real(values)


def test_large_and_small_values() -> None:
    for unit in (1e-200, 1e200):
        target = Target.real(unit * floats(1, 2, 3))
        assert target.scale == pytest.approx((2 * unit, unit * math.sqrt(2 / 3)))
