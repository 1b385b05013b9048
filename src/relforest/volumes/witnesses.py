"""Squared distance of every bag's witness, its instance nearest to the centre (eq. 3.7)."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.mappings.kernels import wrap_angle
from relforest.support.jit import kernel
from relforest.volumes.bag_layout import SlotMajor

EUCLIDEAN: Final = 0
CIRCLE: Final = 1
DIAGONAL: Final = 2  # Euclidean, with matrices that are diagonal

_TILE: Final = 64


@kernel
def witness_distances(
    space: int,
    bags: SlotMajor,
    centre: NDArray[np.float64],
    whitening: NDArray[np.float64],
    squared: NDArray[np.float64],
) -> None:
    """Write the squared witness distance of every bag into `squared` (n_bags,)."""
    dim = bags.points.shape[0]
    if dim > 3:
        _distances_general(bags, centre, whitening, squared)
        return
    squared[:] = np.inf
    if space == CIRCLE:
        _nearest_angles(bags, centre[0], squared)
    elif dim == 1:
        _nearest_1(bags, centre[0], whitening[0, 0], squared)
    elif dim == 2:
        _nearest_2(bags, centre, whitening, squared)
    else:
        _nearest_3(bags, centre, whitening, squared)


# In these loops slices of single rows stay contiguous, which the compiler needs to vectorise. Adding zero
# changes nothing, but keeps it from storing under a mask what is smaller, which takes some processors longer
# than all else.


@kernel
def _nearest_angles(bags: SlotMajor, centre: float, squared: NDArray[np.float64]) -> None:
    for slot in range(len(bags.offsets) - 1):
        angles = bags.points[0, bags.offsets[slot] : bags.offsets[slot + 1]]
        for i in range(len(angles)):
            offset = wrap_angle(angles[i] - centre)
            squared[i] = min(squared[i], offset * offset) + 0.0


@kernel
def _nearest_1(bags: SlotMajor, centre: float, scale: float, squared: NDArray[np.float64]) -> None:
    for slot in range(len(bags.offsets) - 1):
        x = bags.points[0, bags.offsets[slot] : bags.offsets[slot + 1]]
        for i in range(len(x)):
            offset = x[i] - centre
            squared[i] = min(squared[i], scale * offset * offset) + 0.0


@kernel
def _nearest_2(
    bags: SlotMajor, centre: NDArray[np.float64], inverse: NDArray[np.float64], squared: NDArray[np.float64]
) -> None:
    cx, cy = centre[0], centre[1]
    a, b, c = inverse[0, 0], 2.0 * inverse[0, 1], inverse[1, 1]
    for slot in range(len(bags.offsets) - 1):
        first, last = bags.offsets[slot], bags.offsets[slot + 1]
        x, y = bags.points[0, first:last], bags.points[1, first:last]
        for i in range(len(x)):
            dx = x[i] - cx
            dy = y[i] - cy
            squared[i] = min(squared[i], dx * (a * dx + b * dy) + c * dy * dy) + 0.0


@kernel
def _nearest_3(
    bags: SlotMajor, centre: NDArray[np.float64], inverse: NDArray[np.float64], squared: NDArray[np.float64]
) -> None:
    cx, cy, cz = centre[0], centre[1], centre[2]
    a, b, c = inverse[0, 0], inverse[1, 1], inverse[2, 2]
    d, e, f = 2.0 * inverse[0, 1], 2.0 * inverse[0, 2], 2.0 * inverse[1, 2]
    for slot in range(len(bags.offsets) - 1):
        first, last = bags.offsets[slot], bags.offsets[slot + 1]
        x, y, z = bags.points[0, first:last], bags.points[1, first:last], bags.points[2, first:last]
        for i in range(len(x)):
            dx = x[i] - cx
            dy = y[i] - cy
            dz = z[i] - cz
            value = dx * (a * dx + d * dy + e * dz) + dy * (b * dy + f * dz) + c * dz * dz
            squared[i] = min(squared[i], value) + 0.0


@kernel
def _distances_general(
    bags: SlotMajor,
    centre: NDArray[np.float64],
    whitening: NDArray[np.float64],
    squared: NDArray[np.float64],
) -> None:
    """Any dimension: whiten a tile of points at a time, so that the inner loop vectorises."""
    dim = bags.points.shape[0]
    offsets = np.empty((dim, _TILE))
    totals = np.empty(_TILE)
    component = np.empty(_TILE)
    squared[:] = np.inf
    for slot in range(len(bags.offsets) - 1):
        n_bags = bags.offsets[slot + 1] - bags.offsets[slot]
        for begin in range(0, n_bags, _TILE):
            width = min(_TILE, n_bags - begin)
            first = bags.offsets[slot] + begin
            for i in range(dim):
                for p in range(width):
                    offsets[i, p] = bags.points[i, first + p] - centre[i]
            totals[:] = 0.0
            for i in range(dim):
                component[:] = 0.0
                for j in range(i + 1):
                    factor = whitening[i, j]
                    for p in range(width):
                        component[p] += factor * offsets[j, p]
                for p in range(width):
                    totals[p] += component[p] * component[p]
            for p in range(width):
                squared[begin + p] = min(squared[begin + p], totals[p])


@kernel
def n_instances(bags: SlotMajor, bag: int) -> int:
    """Number of instances of `bag`."""
    slot = 0
    while slot + 1 < len(bags.offsets) and bags.offsets[slot] + bag < bags.offsets[slot + 1]:
        slot += 1
    return slot


@kernel
def nearest_instance(
    space: int,
    bags: SlotMajor,
    bag: int,
    centre: NDArray[np.float64],
    whitening: NDArray[np.float64],
) -> int:
    """Column in `bags.points` of the witness of `bag`, the first one of equals."""
    dim = bags.points.shape[0]
    nearest, best = bags.offsets[0] + bag, np.inf
    for slot in range(n_instances(bags, bag)):
        column = bags.offsets[slot] + bag
        total = 0.0
        if space == CIRCLE:
            offset = wrap_angle(bags.points[0, column] - centre[0])
            total = offset * offset
        else:
            for i in range(dim):
                component = 0.0
                for j in range(i + 1 if dim > 3 else dim):
                    component += whitening[i, j] * (bags.points[j, column] - centre[j])
                total += component * (component if dim > 3 else bags.points[i, column] - centre[i])
        if total < best:
            nearest, best = column, total
    return int(nearest)
