"""Distances by the Woodbury identity against an inverted matrix."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.volumes.bag_layout import NO_EVIDENCE, Instances, SlotMajor, slot_major
from relforest.volumes.low_rank import low_rank_distances, low_rank_metric, low_rank_nearest

Floats = NDArray[np.float64]


def layout(rng: np.random.Generator, points: Floats) -> tuple[SlotMajor, NDArray[np.int64]]:
    """Bags of 1 to 4 points, largest first."""
    sizes = np.sort(rng.integers(1, 5, size=len(points)))[::-1]
    sizes = sizes[np.cumsum(sizes) <= len(points)]
    starts = np.concatenate([[0], np.cumsum(sizes)])
    return slot_major(
        Instances(points[: starts[-1]], starts, np.ones(len(sizes), dtype=np.bool_), NO_EVIDENCE)
    )[0], starts


def metric_of(variances: Floats, steps: Floats) -> Floats:
    metric = np.full((len(variances), len(variances)), np.nan)
    low_rank_metric(variances, steps, metric)
    return metric


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e6])
@pytest.mark.parametrize(("dim", "rank"), [(4, 0), (4, 3), (12, 1), (12, 11), (40, 7)])
def test_witnesses_agree_with_the_inverse(dim: int, rank: int, scale: float) -> None:
    rng = np.random.default_rng([dim, rank])
    variances = scale**2 * 10.0 ** rng.uniform(-4, 0, size=dim)
    steps = np.sqrt(variances) * rng.standard_normal((rank, dim)) * 10
    points, centre = scale * rng.standard_normal((150, dim)), scale * rng.standard_normal(dim)
    made, starts = layout(rng, points)
    metric, squared = metric_of(variances, steps), np.empty(len(starts) - 1)
    low_rank_distances(made, centre, metric, rank, squared)

    inverse = np.linalg.inv(np.diag(variances) + steps.T @ steps)
    expected = np.einsum("ij,jk,ik->i", points - centre, inverse, points - centre)
    np.testing.assert_allclose(squared, np.minimum.reduceat(expected[: starts[-1]], starts[:-1]), rtol=1e-7)
    columns = made.offsets[: starts[1]]
    nearest = low_rank_nearest(made, columns, centre, metric, rank)
    np.testing.assert_array_equal(made.points[:, nearest], points[expected[: starts[1]].argmin()])


def test_equal_points_are_equally_far() -> None:
    rng = np.random.default_rng(0)
    points = np.repeat(rng.standard_normal((1, 30)), 203, axis=0)
    made, starts = layout(rng, points)
    metric, squared = metric_of(rng.uniform(size=30), rng.standard_normal((9, 30))), np.empty(len(starts) - 1)
    low_rank_distances(made, rng.standard_normal(30), metric, 9, squared)

    assert len(np.unique(squared)) == 1


def test_the_only_key_is_at_no_distance() -> None:
    rng = np.random.default_rng(0)
    made, starts = layout(rng, rng.standard_normal((50, 12)))
    squared = np.empty(len(starts) - 1)
    low_rank_distances(
        made, made.points[:, 2].copy(), metric_of(np.full(12, 1e-5), np.empty((0, 12))), 0, squared
    )

    assert squared[2] == 0
    assert (np.delete(squared, 2) > 0).all()
