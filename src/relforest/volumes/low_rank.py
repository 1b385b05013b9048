"""Squared distances for fewer key points than dimensions, without a d x d matrix per point.

Along the principal axes of the prior (`principal_axes`) V of eq. 3.6 is a diagonal plus the scatter of
the keys, whose rank is below their number. With A the diagonal and S the rows that add up to the
scatter, ``S.T @ S``, the Woodbury identity gives ``inv(V) = inv(A) - T.T @ T``, where
``T = inv(L) @ S @ inv(A)`` and ``L @ L.T = I + S @ inv(A) @ S.T``. A metric (d, d) of this form holds T
in its first rows and the diagonal of ``inv(A)`` in its last.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from relforest.support.jit import kernel
from relforest.volumes.bag_layout import SlotMajor


@kernel
def low_rank_metric(
    diagonal: NDArray[np.float64], steps: NDArray[np.float64], metric: NDArray[np.float64]
) -> None:
    """Write the metric of a diagonal (d,) plus ``steps.T @ steps``, (rank, d), rank < d, into `metric`."""
    rank, dim = steps.shape
    inverse = metric[dim - 1]
    scaled = np.empty((rank, dim))
    for i in range(dim):
        inverse[i] = 1.0 / diagonal[i]
        for row in range(rank):
            scaled[row, i] = steps[row, i] * inverse[i]
    if rank == 0:
        return
    gram = np.dot(scaled, steps.T)
    for row in range(rank):
        gram[row, row] += 1.0
    factor = np.linalg.cholesky(gram)
    for row in range(rank):
        for i in range(dim):
            metric[row, i] = scaled[row, i]
        for earlier in range(row):
            for i in range(dim):
                metric[row, i] -= factor[row, earlier] * metric[earlier, i]
        for i in range(dim):
            metric[row, i] /= factor[row, row]


@kernel
def low_rank_distances(
    bags: SlotMajor,
    centre: NDArray[np.float64],
    metric: NDArray[np.float64],
    rank: int,
    squared: NDArray[np.float64],
) -> None:
    """Write the squared witness distance of every bag into `squared` (n_bags,)."""
    everything = _all_squared(bags.points, centre, metric, rank)
    columns = np.arange(len(squared))
    for slot in range(1, len(bags.offsets) - 1):
        for bag in range(bags.offsets[slot + 1] - bags.offsets[slot]):
            column = bags.offsets[slot] + bag
            if everything[column] < everything[columns[bag]]:
                columns[bag] = column
    # A product of matrices may round equal points differently, so it only tells who the witness is.
    _squared(bags.points, columns, centre, metric, rank, squared)


@kernel
def low_rank_nearest(
    bags: SlotMajor,
    columns: NDArray[np.int64],
    centre: NDArray[np.float64],
    metric: NDArray[np.float64],
    rank: int,
) -> int:
    """Which of some columns of `bags.points` is nearest to the centre, the first one of equals."""
    squared = np.empty(len(columns))
    _squared(bags.points, columns, centre, metric, rank, squared)
    nearest = 0
    for p in range(len(columns)):
        if squared[p] < squared[nearest]:
            nearest = p
    return int(columns[nearest])


@kernel
def _all_squared(
    points: NDArray[np.float64], centre: NDArray[np.float64], metric: NDArray[np.float64], rank: int
) -> NDArray[np.float64]:
    """Squared distances (n_points,) of all points (d, n_points)."""
    dim, n_points = points.shape
    totals = np.zeros(n_points)
    for i in range(dim):
        factor, middle, coordinate = metric[dim - 1, i], centre[i], points[i]
        for p in range(n_points):
            offset = coordinate[p] - middle
            totals[p] += factor * offset * offset
    if rank > 0:
        components = np.dot(metric[:rank], points)
        for row in range(rank):
            middle, component = 0.0, components[row]
            for i in range(dim):
                middle += metric[row, i] * centre[i]
            for p in range(n_points):
                offset = component[p] - middle
                totals[p] -= offset * offset
    return totals


@kernel
def _squared(
    points: NDArray[np.float64],
    columns: NDArray[np.int64],
    centre: NDArray[np.float64],
    metric: NDArray[np.float64],
    rank: int,
    squared: NDArray[np.float64],
) -> None:
    """Write the squared distances of some columns, by loops that round equal points equally."""
    dim, width = len(centre), len(columns)
    offsets = np.empty((dim, width))
    squared[:] = 0.0
    for i in range(dim):
        factor = metric[dim - 1, i]
        for p in range(width):
            offset = points[i, columns[p]] - centre[i]
            offsets[i, p] = offset
            squared[p] += factor * offset * offset
    component = np.empty(width)
    for row in range(rank):
        component[:] = 0.0
        for i in range(dim):
            factor = metric[row, i]
            for p in range(width):
                component[p] += factor * offsets[i, p]
        for p in range(width):
            squared[p] -= component[p] * component[p]
    for p in range(width):
        squared[p] = max(squared[p], 0.0)
