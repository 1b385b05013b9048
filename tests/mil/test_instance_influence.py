"""What the best and the mean of a bag lose without one of its points."""

from __future__ import annotations

import numpy as np

from relforest.mil.instance_influence import excess, lead

STARTS = np.array([0, 3, 4, 6])
VALUES = np.array([0.2, 0.9, 0.5, 0.7, 0.4, 0.4])


def test_only_the_best_point_leads() -> None:
    # .9 - .5; alone: all of it; two equal ones: neither is missed.
    np.testing.assert_allclose(lead(VALUES[:, None], STARTS)[:, 0], [0, 0.4, 0, 0.7, 0, 0])


def test_the_mean_without_a_point() -> None:
    # Mean 1.6 / 3; without the points .7, .35, .55.
    mean = 1.6 / 3.0
    expected = [mean - 0.7, mean - 0.35, mean - 0.55, 0.7, 0.0, 0.0]

    np.testing.assert_allclose(excess(VALUES, STARTS), expected, atol=1e-15)
