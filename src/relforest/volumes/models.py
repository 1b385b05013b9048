"""Models under trial: key points, the centre and metric they imply, and how they cut the bags."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.support.jit import inlined, kernel
from relforest.volumes.conditioning import condition, extreme_eigenvalues, ridge, whiten
from relforest.volumes.low_rank import low_rank_metric
from relforest.volumes.witnesses import CIRCLE, DIAGONAL

if TYPE_CHECKING:
    from numpy.typing import NDArray

CURRENT: Final = 0
CHOSEN: Final = 1
TRIAL: Final = 2
BEST: Final = 3

SCORE: Final = 0
EDGE: Final = 1
COUNT: Final = 2


# Up to here the matrices are so small that products of low rank would take longer; beyond, points
# stand along the principal axes of the prior.
FEW_DIMENSIONS: Final = 10


class Models(NamedTuple):
    """Four models side by side, in rows `CURRENT`, `CHOSEN`, `TRIAL` and `BEST`.

    One array per quantity rather than one object per model: what is passed between kernels must
    stay small, because every array in it costs reference counting.
    """

    numbers: NDArray[np.float64]  # (4, 3) score, squared edge of the cut, number of key points
    sums: NDArray[np.float64]  # (4, d) sum of the keys; on the circle (4, 2), of cosines and sines
    scatters: NDArray[np.float64]  # (4, d, d) ncov of eq. 3.4
    steps: NDArray[np.float64]  # (4, d - 1, d) up to d keys: scatter = steps.T @ steps; few d, diagonal: none
    centres: NDArray[np.float64]  # (4, d); on the circle the mean direction
    metrics: NDArray[np.float64]  # (4, d, d) see `whiten`, or `low_rank_metric` if `low_rank` >= 0
    squared: NDArray[np.float64]  # (4, n_bags) squared witness distances


@kernel
def new_models(space: int, dim: int, n_bags: int) -> Models:
    """Four models without key points, that score minus infinity."""
    numbers = np.zeros((4, 3))
    numbers[:, SCORE] = -np.inf
    return Models(
        numbers,
        np.zeros((4, 2 if space == CIRCLE else dim)),
        np.zeros((4, dim, dim)),
        np.zeros((4, dim - 1 if dim > FEW_DIMENSIONS and space != DIAGONAL else 0, dim)),
        np.zeros((4, dim)),
        np.zeros((4, dim, dim)),
        np.zeros((4, n_bags)),
    )


@inlined
def low_rank(models: Models, row: int) -> int:
    """Rank beside the diagonal where the metric is one of `low_rank`, otherwise -1."""
    dim, n_keys = models.centres.shape[1], int(models.numbers[row, COUNT])
    if dim > FEW_DIMENSIONS and models.steps.shape[1] == 0:
        return 0
    return n_keys - 1 if dim > FEW_DIMENSIONS and n_keys <= dim else -1


@kernel
def copy_model(models: Models, source: int, target: int) -> None:
    """Make row `target` equal to row `source`."""
    # Plain loops: slice assignment checks for overlap, which costs more than these short copies.
    for i in range(models.numbers.shape[1]):
        models.numbers[target, i] = models.numbers[source, i]
    for i in range(models.sums.shape[1]):
        models.sums[target, i] = models.sums[source, i]
    for i in range(models.centres.shape[1]):
        models.centres[target, i] = models.centres[source, i]
        for j in range(models.centres.shape[1]):
            models.scatters[target, i, j] = models.scatters[source, i, j]
            models.metrics[target, i, j] = models.metrics[source, i, j]
    for i in range(min(models.steps.shape[1], int(models.numbers[source, COUNT]) - 1)):
        for j in range(models.steps.shape[2]):
            models.steps[target, i, j] = models.steps[source, i, j]
    for i in range(models.squared.shape[1]):
        models.squared[target, i] = models.squared[source, i]


@inlined
def add_key(
    space: int,
    models: Models,
    base: int,
    point: NDArray[np.float64],
    regularisation: tuple[NDArray[np.float64], float],
) -> bool:
    """Give `TRIAL` the key points of row `base` and `point` (d,), by rank-one updates.

    `base` -1 stands for no key points; `regularisation` is the prior (d, d) of eq. 3.5 and the
    largest condition number of eq. 3.6. Returns False if the keys define no centre.
    """
    is_defined = add_to_scatter(space, models, base, point)
    if space != CIRCLE:
        set_metric(models, regularisation)
    return is_defined


@kernel
def add_to_scatter(space: int, models: Models, base: int, point: NDArray[np.float64]) -> bool:
    """Do the part of `add_key` that depends on each key; `base` may be `TRIAL` itself."""
    n = 1.0 if base < 0 else models.numbers[base, COUNT] + 1.0
    models.numbers[TRIAL, COUNT] = n
    if space == CIRCLE:
        return _add_angle(models, base, point[0], n)
    dim = len(point)
    source = max(base, 0)
    # Without a base, both factors drop whatever `source` holds.
    growth, kept = (n - 1.0) / n, 0.0 if base < 0 else 1.0
    for i in range(dim):
        offset = point[i] - models.centres[source, i]
        for j in range(dim):
            product = offset * (point[j] - models.centres[source, j])
            models.scatters[TRIAL, i, j] = kept * models.scatters[source, i, j] + growth * product
    if space == DIAGONAL:
        _drop_correlations(models.scatters[TRIAL])
    if low_rank(models, TRIAL) > 0:
        _add_step(models, source, point)
    for i in range(dim):
        # The mean comes from the sum, since a running mean would part points at equal distances.
        models.sums[TRIAL, i] = kept * models.sums[source, i] + point[i]
        models.centres[TRIAL, i] = models.sums[TRIAL, i] / n
    return True


@kernel
def _drop_correlations(matrix: NDArray[np.float64]) -> None:
    for i in range(len(matrix)):
        for j in range(len(matrix)):
            if i != j:
                matrix[i, j] = 0.0


@kernel
def _add_step(models: Models, source: int, point: NDArray[np.float64]) -> None:
    """Keep in `steps` of `TRIAL` what `point` adds to the scatter of row `source`."""
    last = int(models.numbers[TRIAL, COUNT]) - 2
    for i in range(len(point)):
        for row in range(last):
            models.steps[TRIAL, row, i] = models.steps[source, row, i]
        offset = point[i] - models.centres[source, i]
        models.steps[TRIAL, last, i] = math.sqrt((last + 1.0) / (last + 2.0)) * offset


@kernel
def set_metric(models: Models, regularisation: tuple[NDArray[np.float64], float]) -> None:
    """Give `TRIAL` the metric of its scatter, with the prior and the largest condition number."""
    prior, max_condition = regularisation
    dim = len(prior)
    covariance = models.metrics[TRIAL]
    for i in range(dim):
        for j in range(dim):
            covariance[i, j] = models.scatters[TRIAL, i, j] + prior[i, j]
    rank = low_rank(models, TRIAL)
    if rank >= 0:
        _set_low_rank_metric(models, rank, regularisation)
        return
    condition(covariance, max_condition)
    whiten(covariance, covariance)


@kernel
def _set_low_rank_metric(
    models: Models, rank: int, regularisation: tuple[NDArray[np.float64], float]
) -> None:
    """Replace the covariance in the metric of `TRIAL` by a metric of low rank beside the diagonal."""
    prior, max_condition = regularisation
    dim = len(prior)
    # Without steps, all of the covariance is on the diagonal.
    alone = prior if rank > 0 else models.metrics[TRIAL]
    diagonal = np.empty(dim)
    largest, smallest = alone[0, 0], alone[0, 0]
    for i in range(dim):
        diagonal[i] = alone[i, i]
        largest, smallest = max(largest, alone[i, i]), min(smallest, alone[i, i])
    if rank > 0:
        largest, smallest = extreme_eigenvalues(models.metrics[TRIAL])
    added = ridge(largest, smallest, max_condition)
    vanishes = added < 0.0
    for i in range(dim):
        diagonal[i] = 1.0 if vanishes else diagonal[i] + added
        for row in range(rank if vanishes else 0):
            models.steps[TRIAL, row, i] = 0.0
    low_rank_metric(diagonal, models.steps[TRIAL, :rank], models.metrics[TRIAL])


@kernel
def _add_angle(models: Models, base: int, angle: float, n: float) -> bool:
    cosine, sine = math.cos(angle), math.sin(angle)
    if base >= 0:
        cosine += models.sums[base, 0]
        sine += models.sums[base, 1]
    models.sums[TRIAL, 0] = cosine
    models.sums[TRIAL, 1] = sine
    models.centres[TRIAL, 0] = math.atan2(sine, cosine)
    return math.hypot(cosine, sine) >= 1e-12 * n
