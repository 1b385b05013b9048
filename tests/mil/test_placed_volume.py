"""Nearness of points and bags to volumes and balls."""

from __future__ import annotations

import numpy as np
import pytest

from relforest.mil.feature_view import FeatureView
from relforest.mil.placed_volume import (
    Balls,
    PlacedVolume,
    bag_blocks,
    bag_nearness,
    nearness,
    typical_squared_distance,
)
from relforest.volumes import Ellipsoid

PLAIN = FeatureView(np.arange(2), np.zeros(2), np.ones(2))
TURNED = FeatureView(np.arange(2), np.zeros(2), np.ones(2), np.array([[0.0, 1.0]]))


def placed(view: FeatureView, ellipsoid: Ellipsoid) -> PlacedVolume:
    return PlacedVolume("parts", view, ellipsoid, seeks_positive=True, weight=1.0)


def test_nearness_is_one_at_the_centre_and_one_half_on_the_boundary() -> None:
    # 2 ** -0, 2 ** -1, 2 ** -4, 2 ** -(1 / 4)
    near = nearness(np.array([0.0, 3.0, 6.0, 1.5]), 3.0)

    np.testing.assert_allclose(near, [1.0, 0.5, 1.0 / 16.0, 0.8408964152537145])


def test_a_volume_that_is_a_point_holds_only_that_point() -> None:
    assert nearness(np.array([0.0, 1e-9, 1e30]), 0.0).tolist() == [1.0, 0.0, 0.0]


def test_the_witness_decides_about_a_bag_in_every_view() -> None:
    disc = placed(PLAIN, Ellipsoid(np.zeros(2), np.eye(2), 2.0, 1, 0.1))
    strip = placed(TURNED, Ellipsoid(np.ones(1), np.eye(1), 1.0, 1, 0.1))
    points = np.array([[9.0, 9.0], [0.0, 2.0], [4.0, 0.0]])
    near = bag_nearness([disc, strip, strip], points, np.array([0, 2, 3]))

    # Distances of the witnesses: 2 and 4 from the disc's centre, 1 and 1 from the strip's.
    np.testing.assert_allclose(near, [[0.5, 0.5, 0.5], [2.0**-4, 0.5, 0.5]])
    assert strip.centre.tolist() == [0.0, 1.0]


def test_balls_ask_for_the_nearest_instance_and_for_the_mean() -> None:
    weights = np.array([1.0, 0.0, 0.0])
    balls = Balls(
        PLAIN, np.array([[0.0, 0.0], [5.0, 0.0], [7.0, 7.0]]), 1.0, 2.0, weights, weights[[1, 0, 2]]
    )
    near, shares = balls.bag_nearness(np.array([[1.0, 0.0], [0.0, 2.0], [5.0, 0.0]]), np.array([0, 2, 3]))

    # Bag 0 has the squared distances 1 and 4 from ball 0: the nearer gives 2 ** -1; with radius 2 the
    # exponents are 1/4 and 1.
    assert near[0, 0] == pytest.approx(0.5)
    assert shares[0, 0] == pytest.approx((2.0**-0.25 + 0.5) / 2.0)
    assert near[1, 1] == shares[1, 1] == pytest.approx(1.0)
    assert balls.without_idle().centres.tolist() == [[0.0, 0.0], [5.0, 0.0]]


def test_blocks_cover_all_bags_and_are_small_where_bags_are() -> None:
    sizes = np.array([1000, 1000, 1000, 5000, 10, 10])
    starts = np.concatenate([[0], np.cumsum(sizes)])

    assert bag_blocks(starts) == [(0, 2), (2, 3), (3, 4), (4, 6)]


def test_typical_distance() -> None:
    # Squared distances 0, 0, 0 and twice 1, 4, 9: the median of the nine is 1.
    assert typical_squared_distance(np.array([[0.0], [1.0], [3.0]])) == pytest.approx(1.0)
    assert typical_squared_distance(np.zeros((4, 2))) == 1.0
