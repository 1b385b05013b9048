from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.distance import pdist

from relforest.volumes.principal_axes import principal_axes

Floats = NDArray[np.float64]


def cloud(rng: np.random.Generator, n_points: int, rank: int, dim: int) -> Floats:
    """Points of a flat of this rank, somewhere in space."""
    points: Floats = rng.standard_normal((n_points, rank)) @ rng.standard_normal((rank, dim))
    return points + 5 * rng.standard_normal(dim)


@pytest.mark.parametrize(("n_points", "rank", "dim"), [(40, 6, 6), (40, 2, 6), (4, 3, 6), (1, 0, 6)])
def test_positive_points_lie_along_their_axes(n_points: int, rank: int, dim: int) -> None:
    points = cloud(np.random.default_rng(rank), n_points, rank, dim)
    axes = principal_axes(points, points)

    assert axes.axes.shape == (dim, rank)
    assert axes.coordinates.shape == (n_points, rank + (rank < dim))
    covariance = np.cov(axes.coordinates, rowvar=False, bias=True).reshape(2 * [axes.coordinates.shape[1]])
    np.testing.assert_allclose(covariance if n_points > 1 else 0.0, np.diag(axes.variances), atol=1e-12)
    np.testing.assert_allclose(pdist(axes.coordinates), pdist(points), rtol=1e-12)


def test_other_points_keep_their_distances_to_positive_ones() -> None:
    rng = np.random.default_rng(0)
    points = np.vstack([cloud(rng, 10, 3, 8), rng.standard_normal((20, 8))])
    in_positive = np.arange(30) < 10
    coordinates = principal_axes(points, points[in_positive]).coordinates

    assert coordinates.shape == (30, 4)
    for here, there in zip(points[:10], coordinates[:10], strict=True):
        np.testing.assert_allclose(
            np.linalg.norm(coordinates - there, axis=1), np.linalg.norm(points - here, axis=1), atol=1e-12
        )


def test_equal_points_have_equal_coordinates() -> None:
    # Minus zero equals zero.
    rng = np.random.default_rng(0)
    points = rng.standard_normal((7, 20))[rng.integers(7, size=101)]
    points[:, 3] = np.where(np.arange(101) % 2, 0.0, -0.0)
    coordinates = principal_axes(points, points[::3]).coordinates

    assert len(np.unique(coordinates, axis=0)) == 7


def test_mean_and_covariance_are_turned_back() -> None:
    rng = np.random.default_rng(0)
    points = cloud(rng, 30, 4, 6)
    axes = principal_axes(points, points)
    keys = axes.coordinates[:3]
    mean, covariance = axes.back(keys.mean(axis=0), np.cov(keys, rowvar=False))

    np.testing.assert_allclose(mean, points[:3].mean(axis=0))
    np.testing.assert_allclose(covariance, np.cov(points[:3], rowvar=False), atol=1e-12)
    np.testing.assert_array_equal(covariance, covariance.T)
