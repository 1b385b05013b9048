"""Bounds that divide the training points like the volume, without those that divide none."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.trees.bounds import Bounds, needed_bounds
from relforest.volumes import Arc, Ellipsoid, Slab

INF = math.inf


def ball(*centre: float, radius: float = 2.0) -> Ellipsoid:
    return Ellipsoid(np.array(centre), np.eye(len(centre)), radius, 3, 0.1)


def column(*values: float) -> NDArray[np.float64]:
    return np.array(values)[:, None]


@pytest.mark.parametrize(
    ("points", "expected"),
    [
        ((1.0, 4.0, 6.9), (Bounds(0, 3.0, INF),)),
        ((4.0, 9.0), (Bounds(0, -INF, 7.0),)),
        # Both ends count, or none.
        ((1.0, 4.0, 9.0), ()),
        ((4.0, 5.0), ()),
        ((1.0, 9.0), ()),
    ],
)
def test_ends_of_an_interval(points: tuple[float, ...], expected: tuple[Bounds, ...]) -> None:
    assert needed_bounds(ball(5.0), column(*points)) == expected
    beside = np.hstack([np.zeros((len(points), 1)), column(*points)])
    assert needed_bounds(Slab(ball(5.0), 1, 2), beside) == tuple(Bounds(1, b.low, b.high) for b in expected)


def test_ends_have_as_many_digits_as_they_need() -> None:
    volume = ball(5.0, radius=2.000123)

    assert needed_bounds(volume, column(4.0, 8.0)) == (Bounds(0, -INF, 7.0),)
    assert needed_bounds(volume, column(7.0001, 8.0)) == (Bounds(0, -INF, 7.0001),)


def test_half_planes_and_corners() -> None:
    disc = ball(0.0, 0.0)
    inside = [(0.0, 0.0), (1.0, 1.0), (-1.9, 0.0)]

    assert needed_bounds(disc, np.array([*inside, (5.0, 0.0), (4.0, 4.0)])) == (Bounds(0, -INF, 2.0),)
    # The disc reaches beyond the nearest point outside: midway.
    assert needed_bounds(disc, np.array([*inside, (1.5, -1.5)])) == (Bounds(1, -0.75, INF),)
    assert needed_bounds(disc, np.array([*inside, (5.0, 0.0), (0.0, -3.0)])) == (
        Bounds(0, -INF, 2.0),
        Bounds(1, -2.0, INF),
    )
    # All four sides, and a corner that no bound of a coordinate cuts off.
    assert needed_bounds(disc, np.array([*inside, (3, 0), (-3, 0), (0, 3), (0, -3)])) == ()
    assert needed_bounds(disc, np.array([(1.9, 0.0), (0.0, 1.9), (1.8, 1.8)])) == ()


def test_an_arc_counts_as_a_whole() -> None:
    assert needed_bounds(Arc(0.0, 0.1, 1.0), column(0.0, 1.0)) == ()


@pytest.mark.parametrize("seed", range(40))
def test_bounds_divide_the_points_like_the_volume(seed: int) -> None:
    rng = np.random.default_rng(seed)
    dim = seed % 4 + 1
    factor = rng.normal(size=(dim, dim))
    volume = Ellipsoid(
        rng.normal(size=dim), factor @ factor.T + 0.1 * np.eye(dim), 1.0 + rng.random(), 3, 0.1
    )
    points = rng.normal(size=(6, dim)) * 2
    bounds = needed_bounds(volume, points)

    if bounds:
        within = [(each.low <= points[:, each.axis]) & (points[:, each.axis] <= each.high) for each in bounds]
        assert np.array_equal(np.all(within, axis=0), volume.contains(points))
        assert sum(math.isfinite(end) for each in bounds for end in (each.low, each.high)) <= min(
            3, 2 * dim - 1
        )
