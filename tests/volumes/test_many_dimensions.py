"""The search along principal axes against its plain twin, which knows nothing of them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from reference import covagg as twin
from relforest.volumes import CovAggSettings, Ellipsoid, aggregate

Floats = NDArray[np.float64]
DIMS = [4, 8, 12, 30, 60]


def bags(
    rng: np.random.Generator, dim: int, n_bags: int
) -> tuple[Floats, NDArray[np.int64], NDArray[np.bool_]]:
    """Bags of 1 to 3 points of an oblique cloud; every positive bag holds a point near one place."""
    starts = np.concatenate([[0], np.cumsum(rng.integers(1, 4, size=n_bags))])
    labels = np.arange(n_bags) % 2 == 0
    turn = np.linalg.qr(rng.standard_normal((dim, dim)))[0]
    points = rng.standard_normal((starts[-1], dim)) @ (turn * np.geomspace(0.1, 1, dim))
    place = points[0].copy()
    for bag in np.flatnonzero(labels):
        points[starts[bag]] = place + 0.3 * (points[starts[bag]] - place)
    return points, starts, labels


def check(
    points: Floats,
    starts: NDArray[np.int64],
    labels: NDArray[np.bool_],
    *,
    max_condition: float = 1e5,
    window: int = 8,
) -> int:
    """Assert that both searches find the same; the number of key points."""
    options = {"max_condition": max_condition, "window": window, "restarts": 2}
    settings, plain = CovAggSettings(**options), twin.Settings(**options)  # type: ignore[arg-type]
    found = aggregate(points, starts, labels, settings=settings, rng=np.random.default_rng(0))
    expected = twin.aggregate(points, starts, labels, settings=plain, rng=np.random.default_rng(0))
    assert found is not None
    assert expected is not None
    assert isinstance(found.volume, Ellipsoid)
    size = np.abs(expected.covariance).max()
    assert found.score == expected.score
    assert found.volume.n_keys == len(expected.keys)
    assert found.volume.radius == pytest.approx(expected.radius, rel=1e-7)
    np.testing.assert_allclose(found.volume.mean, expected.mean, rtol=1e-9, atol=1e-9 * np.sqrt(size))
    np.testing.assert_allclose(found.volume.covariance, expected.covariance, rtol=1e-8, atol=1e-12 * size)
    return found.volume.n_keys


@pytest.mark.parametrize("max_condition", [5.0, 1e5, 1e7])
@pytest.mark.parametrize("dim", DIMS)
def test_the_ridge_may_be_active_or_not(dim: int, max_condition: float) -> None:
    # The spread of the cloud has the condition number 100 where there are enough points.
    check(*bags(np.random.default_rng(dim), dim, 60), max_condition=max_condition)


@pytest.mark.parametrize("dim", DIMS)
def test_constant_dimensions(dim: int) -> None:
    # Some are constant in all bags, some only in the positive ones.
    points, starts, labels = bags(np.random.default_rng(dim), dim, 40)
    points[:, ::4] = 7.0
    points[np.repeat(labels, np.diff(starts)), 1] = 3.0

    check(points, starts, labels)


@pytest.mark.parametrize("dim", DIMS)
def test_fewer_positive_points_than_dimensions(dim: int) -> None:
    check(*bags(np.random.default_rng(dim), dim, 6))


@pytest.mark.parametrize("dim", DIMS)
def test_units_that_differ_by_nine_decades(dim: int) -> None:
    points, starts, labels = bags(np.random.default_rng(dim), dim, 40)

    check(points * np.geomspace(1e-3, 1e6, dim), starts, labels)


@pytest.mark.parametrize("dim", [4, 8, 12])
def test_more_keys_than_dimensions(dim: int) -> None:
    # Every volume around the positives is perfect, so that a run lasts as long as its window.
    rng = np.random.default_rng(dim)
    labels = np.arange(60) % 2 == 0
    points = rng.standard_normal((60, dim))
    points[~labels] += 20.0

    assert check(points, np.arange(61), labels, window=25) == 26


@pytest.mark.parametrize("dim", DIMS)
def test_equal_points_in_both_classes_are_not_separated(dim: int) -> None:
    rng = np.random.default_rng(dim)
    points, starts, labels = bags(rng, dim, 40)
    copies = points[starts[:-1]][rng.permutation(40)]
    everything = np.vstack([copies, copies, points])
    both = np.concatenate([np.ones(40, dtype=np.bool_), np.zeros(40, dtype=np.bool_), labels])
    found = aggregate(
        everything, np.concatenate([np.arange(80), 80 + starts]), both, rng=np.random.default_rng(0)
    )

    assert found is not None
    inside = found.volume.contains(copies)
    # Whatever is inside, of each copy one bag is right and one is wrong.
    nearest = np.minimum.reduceat(found.volume.distance(points), starts[:-1])
    assert found.score == 40 + ((nearest <= found.volume.radius) == labels).sum()
    assert inside.any()
