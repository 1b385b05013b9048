"""Models under trial: key points, the centre and metric they imply, and how they cut the bags."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.support.jit import kernel
from relforest.volumes.conditioning import condition, whiten
from relforest.volumes.witnesses import CIRCLE

if TYPE_CHECKING:
    from numpy.typing import NDArray

CURRENT: Final = 0
CHOSEN: Final = 1
TRIAL: Final = 2
BEST: Final = 3

SCORE: Final = 0
EDGE: Final = 1
COUNT: Final = 2


class Models(NamedTuple):
    """Four models side by side, in rows `CURRENT`, `CHOSEN`, `TRIAL` and `BEST`.

    One array per quantity rather than one object per model: what is passed between kernels must
    stay small, because every array in it costs reference counting.
    """

    numbers: NDArray[np.float64]  # (4, 3) score, squared edge of the cut, number of key points
    sums: NDArray[np.float64]  # (4, d) sum of the keys; on the circle (4, 2), of cosines and sines
    scatters: NDArray[np.float64]  # (4, d, d) ncov of eq. 3.4
    centres: NDArray[np.float64]  # (4, d); on the circle the mean direction
    metrics: NDArray[np.float64]  # (4, d, d) see `whiten`
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
        np.zeros((4, dim)),
        np.zeros((4, dim, dim)),
        np.zeros((4, n_bags)),
    )


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
    for i in range(models.squared.shape[1]):
        models.squared[target, i] = models.squared[source, i]


@kernel
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
    n = 1.0 if base < 0 else models.numbers[base, COUNT] + 1.0
    models.numbers[TRIAL, COUNT] = n
    if space == CIRCLE:
        return _add_angle(models, base, point[0], n)
    prior, max_condition = regularisation
    dim = len(point)
    source = max(base, 0)
    # Without a base, both factors drop whatever `source` holds.
    growth, kept = (n - 1.0) / n, 0.0 if base < 0 else 1.0
    covariance = models.metrics[TRIAL]
    for i in range(dim):
        offset = point[i] - models.centres[source, i]
        for j in range(dim):
            product = offset * (point[j] - models.centres[source, j])
            models.scatters[TRIAL, i, j] = kept * models.scatters[source, i, j] + growth * product
            covariance[i, j] = models.scatters[TRIAL, i, j] + prior[i, j]
    for i in range(dim):
        # The mean comes from the sum, since a running mean would part points at equal distances.
        models.sums[TRIAL, i] = kept * models.sums[source, i] + point[i]
        models.centres[TRIAL, i] = models.sums[TRIAL, i] / n
    condition(covariance, max_condition)
    whiten(covariance, covariance)
    return True


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
