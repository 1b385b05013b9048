"""Layout of bags and distances of witnesses against loops over bags."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from numpy.typing import NDArray

from relforest.volumes.bag_layout import NO_EVIDENCE, Instances, SlotMajor, slot_major
from relforest.volumes.conditioning import whiten
from relforest.volumes.witnesses import (
    CIRCLE,
    EUCLIDEAN,
    n_instances,
    nearest_instance,
    witness_distances,
)
from strategies import BagSet, bag_sets

Floats = NDArray[np.float64]


def layout(bags: BagSet) -> tuple[SlotMajor, NDArray[np.int64]]:
    return slot_major(Instances(bags.points, bags.starts, bags.labels, NO_EVIDENCE))


def contents(bags: BagSet) -> list[Floats]:
    return [bags.points[bags.starts[i] : bags.starts[i + 1]] for i in range(len(bags.labels))]


def arranged(made: SlotMajor) -> list[Floats]:
    """The bags of a layout, each (n, d)."""
    result = []
    for bag in range(len(made.weights)):
        slots = [made.offsets[slot] + bag for slot in range(n_instances(made, bag))]
        result.append(made.points[:, slots].T)
    return result


@given(bag_sets(max_bags=8))
def test_the_layout_holds_the_same_bags_largest_first(bags: BagSet) -> None:
    made, positives = layout(bags)
    sizes = np.diff(bags.starts)
    order = np.argsort(-sizes, kind="stable")
    found, given_bags = arranged(made), contents(bags)

    assert len(found) == len(given_bags)
    for position, bag in enumerate(order):
        np.testing.assert_array_equal(found[position], given_bags[bag])
    assert (made.weights == np.where(bags.labels[order], 2**32, 1)).all()
    # Positive bags by their new numbers, in the caller's order.
    assert order[positives].tolist() == np.flatnonzero(bags.labels).tolist()
    assert made.evidence.shape == (2, 0)
    evidence = np.arange(2.0 * len(order)).reshape(-1, 2)
    weighed, _ = slot_major(Instances(bags.points, bags.starts, bags.labels, evidence))
    np.testing.assert_array_equal(weighed.evidence, evidence[order].T)


def random_bags(rng: np.random.Generator, dim: int, n_bags: int) -> BagSet:
    sizes = rng.integers(1, 5, size=n_bags)
    starts = np.concatenate([[0], np.cumsum(sizes)])
    return BagSet(rng.standard_normal((starts[-1], dim)), starts, rng.random(n_bags) < 0.5)


# 150 bags fill two of the tiles of 64 and a part of the third.
@pytest.mark.parametrize("n_bags", [1, 7, 150])
@pytest.mark.parametrize("dim", [1, 2, 3, 4, 6])
def test_euclidean_witnesses_agree_with_a_loop(dim: int, n_bags: int) -> None:
    rng = np.random.default_rng([dim, n_bags])
    bags = random_bags(rng, dim, n_bags)
    root = rng.standard_normal((dim, dim))
    covariance = root @ root.T + np.eye(dim)
    metric, centre = np.empty((dim, dim)), rng.standard_normal(dim)
    whiten(covariance, metric)
    made, _ = layout(bags)
    squared = np.empty(n_bags)
    witness_distances(EUCLIDEAN, made, centre, metric, squared)

    precision = np.linalg.inv(covariance)
    for bag, points in enumerate(arranged(made)):
        offsets = points - centre
        distances = np.einsum("ij,jk,ik->i", offsets, precision, offsets)
        assert squared[bag] == pytest.approx(distances.min(), rel=1e-9)
        column = nearest_instance(EUCLIDEAN, made, bag, centre, metric)
        np.testing.assert_array_equal(made.points[:, column], points[distances.argmin()])


def test_witnesses_on_the_circle() -> None:
    # Around 3: bag 0 holds -3 (2 pi - 6 away) and 0; bag 1 holds 2.5.
    bags = BagSet(np.array([[0.0], [-3.0], [2.5]]), np.array([0, 2, 3]), np.array([True, False]))
    made, _ = layout(bags)
    squared, metric = np.empty(2), np.ones((1, 1))
    witness_distances(CIRCLE, made, np.array([3.0]), metric, squared)

    assert squared.tolist() == pytest.approx([(2 * np.pi - 6) ** 2, 0.25])
    column = nearest_instance(CIRCLE, made, 0, np.array([3.0]), metric)
    assert made.points[0, column] == -3


@pytest.mark.parametrize("dim", [1, 2, 3, 4])
def test_the_first_of_equal_instances_is_the_witness(dim: int) -> None:
    # Both instances are at distance 1 from the centre, on opposite sides.
    points = np.zeros((2, dim))
    points[:, 0] = [1.0, -1.0]
    made, _ = layout(BagSet(points, np.array([0, 2]), np.array([True])))
    metric = np.empty((dim, dim))
    whiten(np.eye(dim), metric)

    column = nearest_instance(EUCLIDEAN, made, 0, np.zeros(dim), metric)

    assert made.points[0, column] == 1
