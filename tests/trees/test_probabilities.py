"""Likelihood and potential by hand; the assignment itself is in test_assignment_agreement.py."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from relforest.trees.criterion import Target
from relforest.trees.probabilities import Assignment

Booleans = NDArray[np.bool_]


def booleans(*rows: object) -> Booleans:
    return np.array(rows, dtype=np.bool_)


def assign(presence: Booleans, labels: Booleans) -> Assignment:
    return Target.binary(labels).assign(presence)


def potential(presence: Booleans, labels: Booleans, winner: NDArray[np.int64], leaf: int) -> float:
    target = Target.binary(labels)
    assert target.assign(presence).winner.tolist() == winner.tolist()
    return target.potential(presence, target.assign(presence), leaf)


OVERLAPPING = booleans([1, 1, 1, 0, 0], [0, 0, 1, 1, 1])
LABELS = booleans([1, 1, 0, 1, 0])[0]


def test_likelihood_of_a_stub() -> None:
    # 3 positives of 4: 3 ln(3/4) + ln(1/4).
    found = assign(booleans([1, 1, 1, 1]), booleans([1, 1, 0, 1])[0])

    assert found.log_likelihood == pytest.approx(3 * math.log(3 / 4) + math.log(1 / 4))


def test_likelihood_of_two_leaves() -> None:
    # Leaf 0 wins scenes 0, 1, 2 at 2/3, leaf 1 the others at 1/2.
    found = assign(OVERLAPPING, LABELS)

    expected = 2 * math.log(2 / 3) + math.log(1 / 3) + 2 * math.log(1 / 2)
    assert found.log_likelihood == pytest.approx(expected)
    assert found.sums.tolist() == [[1, 2], [1, 1]]


def test_a_perfect_tree_has_likelihood_one() -> None:
    found = assign(booleans([1, 1, 0], [0, 0, 1]), booleans([1, 1, 0])[0])

    assert found.log_likelihood == pytest.approx(0, abs=1e-10)
    assert found.value.tolist() == [1, 0]


def test_the_cap_costs_likelihood() -> None:
    # Leaf 1 is left with a positive alone, but may not exceed the 3/5 of leaf 0.
    presence = booleans([1, 1, 1, 0, 1, 1], [0, 0, 1, 1, 1, 0])
    found = assign(presence, booleans([1, 1, 0, 1, 0, 1])[0])
    bound = 3 / 5 * (1 - 1e-6)

    assert found.value[1] == pytest.approx(bound, rel=1e-12)
    expected = 3 * math.log(3 / 5) + 2 * math.log(2 / 5) + math.log(bound)
    assert found.log_likelihood == pytest.approx(expected)


def test_empty_leaves_get_the_base_rate_one_below_the_other() -> None:
    found = assign(booleans([1, 1, 1, 1], [0, 0, 0, 0], [0, 0, 0, 0]), booleans([1, 0, 0, 0])[0])

    bounds = [0.25, 0.25 * (1 - 1e-6), 0.25 * (1 - 1e-6) ** 2]
    assert found.value.tolist() == pytest.approx(bounds, rel=1e-12)
    assert found.sums.tolist() == [[3, 1], [0, 0], [0, 0]]


def test_an_empty_leaf_is_below_a_leaf_of_probability_zero() -> None:
    found = assign(booleans([1, 0], [0, 1], [0, 0]), booleans([1, 0])[0])

    assert found.value.tolist() == [1, 0, 0]


def test_potential_of_a_stub_is_a_perfect_separation() -> None:
    presence, labels = booleans([1, 1, 1, 1]), booleans([1, 1, 0, 0])[0]

    assert potential(presence, labels, assign(presence, labels).winner, 0) == pytest.approx(0, abs=1e-10)


def test_potentials_by_hand() -> None:
    winner = assign(OVERLAPPING, LABELS).winner

    # Leaf 0 keeps the positives 0 and 1; scene 2 moves away and falls to leaf 1: 1/3 of {2, 3, 4}.
    expected = math.log(1 / 3) + 2 * math.log(2 / 3)
    assert potential(OVERLAPPING, LABELS, winner, 0) == pytest.approx(expected)
    # Leaf 1 keeps the positive 3; 2 and 4 move away; leaf 0 takes 2 at 2/3 of {0, 1, 2}, 4 is left alone.
    expected = 2 * math.log(2 / 3) + math.log(1 / 3)
    assert potential(OVERLAPPING, LABELS, winner, 1) == pytest.approx(expected)


def test_a_leaf_without_own_positives_has_no_potential() -> None:
    # Leaf 1 decides scenes 2 and 3, both negative.
    presence, labels = booleans([1, 1, 0, 0], [0, 1, 1, 1]), booleans([1, 1, 0, 0])[0]
    found = assign(presence, labels)

    assert found.winner.tolist() == [0, 0, 1, 1]
    assert potential(presence, labels, found.winner, 1) == pytest.approx(found.log_likelihood, abs=1e-9)


@given(hnp.arrays(np.bool_, (4, 9)), hnp.arrays(np.bool_, 9))
def test_the_most_probable_leaf_of_a_scene_is_the_one_that_won_it(
    presence: Booleans, labels: Booleans
) -> None:
    presence[0] |= ~presence.any(axis=0)
    found = assign(presence, labels)

    assert ((found.value >= 0) & (found.value <= 1)).all()
    assert found.sums.sum() == 9
    assert found.sums[:, 1].sum() == labels.sum()
    assert found.log_likelihood <= 1e-9
    for scene in range(9):
        # As inference decides: the highest probability, the first leaf among equals.
        there = np.where(presence[:, scene], found.value, -1.0)
        assert int(there.argmax()) == found.winner[scene]


@given(hnp.arrays(np.bool_, (3, 8)), hnp.arrays(np.bool_, 8))
def test_potential_is_never_below_what_parting_the_leaf_would_give(
    presence: Booleans, labels: Booleans
) -> None:
    presence[0] |= ~presence.any(axis=0)
    found = assign(presence, labels)
    for leaf in range(3):
        own = (found.winner == leaf) & labels
        parted = np.vstack([presence, presence[leaf] & ~own])
        parted[leaf] = own
        value = potential(presence, labels, found.winner, leaf)
        assert value == assign(parted, labels).log_likelihood
