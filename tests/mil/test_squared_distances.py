"""Squared distances by one product of matrices."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from relforest.mil.squared_distances import squared_distances


def test_distances_by_hand() -> None:
    # (3, 4) to (0, 4) and (1, 0): 9 + 0 and 4 + 16.
    points, centres = np.array([[0.0, 0.0], [3.0, 4.0]]), np.array([[0.0, 4.0], [1.0, 0.0]])

    assert squared_distances(points, centres).tolist() == [[16, 1], [9, 20]]


@given(st.integers(0, 100), st.integers(1, 6), st.integers(1, 4))
def test_they_agree_with_a_loop(seed: int, n: int, d: int) -> None:
    rng = np.random.default_rng(seed)
    points, centres = rng.normal(size=(n, d)), rng.normal(size=(3, d))

    expected = [[np.sum((x - c) ** 2) for c in centres] for x in points]
    np.testing.assert_allclose(squared_distances(points, centres), expected, atol=1e-12)


def test_rounding_leaves_none_below_0() -> None:
    x, c = 5.7, np.nextafter(5.7, 6.0)

    assert (-2 * (x * c) + x * x) + c * c < 0
    assert squared_distances(np.array([[x]]), np.array([[c]])).tolist() == [[0.0]]


def test_there_may_be_no_points() -> None:
    assert squared_distances(np.empty((0, 2)), np.ones((3, 2))).shape == (0, 3)
