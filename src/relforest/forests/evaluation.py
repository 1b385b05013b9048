"""Compiled evaluation of trees of conditions, scene by scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from relforest.forests.packing import (
    AT_LEAST,
    AT_MOST,
    BEGIN,
    CIRCULAR,
    COMPONENT,
    CONDITION,
    COUNT,
    DIM,
    END,
    FIRST,
    IS,
    LARGE,
    LEAF,
    N_COMPONENTS,
    N_FREE,
    NEAR,
    NO,
    OPERATION,
    SMALL,
    TEST,
    VARIABLES,
    YES,
    Packed,
)
from relforest.mappings.kernels import map_point, wrap_angle
from relforest.support.jit import inlined, kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray


@inlined
def excess(
    packed: Packed,
    statement: int,
    matrix: NDArray[np.float64],
    bound: NDArray[np.int64],
    point: NDArray[np.float64],
) -> float:
    """By how much a statement about the bound object rows fails: it is true if this is at most 0.

    For `Bound` in the units of the mapping, for `Near` the sum of squares less 1, for `Is` 1 or -1; NaN if
    the mapping is undefined. `point` (1, d) is space for its value.
    """
    row, numbers = packed.statements[statement], packed.numbers[statement]
    a, b, c = row[VARIABLES], row[VARIABLES + 1], row[VARIABLES + 2]
    objects = (bound[a], bound[b] if b >= 0 else -1, bound[c] if c >= 0 else -1)
    span = (row[FIRST], row[DIM])
    result = np.nan
    if map_point(row[OPERATION], row[CIRCULAR] == 1, span, matrix, objects, point, 0):
        kind, x = row[TEST], point[0, row[COMPONENT]]
        if kind == AT_MOST:
            result = x - numbers[0]
        elif kind == AT_LEAST:
            result = numbers[0] - x
        elif kind == SMALL:
            result = abs(x) - numbers[0]
        elif kind == LARGE:
            result = numbers[0] - abs(x)
        elif kind == NEAR:
            squared = 0.0
            for i in range(row[N_COMPONENTS]):
                away = point[0, row[COMPONENT] + i] - numbers[i]
                if row[CIRCULAR] == 1:
                    away = wrap_angle(away)
                away /= numbers[2 + i]
                squared += away * away
            result = squared - 1.0
        else:
            result = -1.0 if (x == numbers[0]) == (kind == IS) else 1.0
    return float(result)


@kernel
def _all_true(
    packed: Packed,
    condition: int,
    matrix: NDArray[np.float64],
    bound: NDArray[np.int64],
    point: NDArray[np.float64],
) -> bool:
    for statement in range(packed.conditions[condition, BEGIN], packed.conditions[condition, END]):
        if not excess(packed, statement, matrix, bound, point) <= 0.0:
            return False
    return True


@kernel
def is_argument(row: int, arguments: NDArray[np.int64]) -> bool:
    """Whether an object row is one of the action's arguments."""
    found = False
    for argument in arguments:
        found |= argument == row
    return found


@kernel
def condition_holds(
    packed: Packed,
    condition: int,
    matrix: NDArray[np.float64],
    objects: NDArray[np.int64],
    arguments: NDArray[np.int64],
    bound: NDArray[np.int64],
    point: NDArray[np.float64],
) -> bool:
    """Whether a condition holds in a scene; `bound` (n_arguments + 2,) is the choice that decided.

    `objects` and `arguments` are rows of `matrix`. Choices are tried in the order of the objects, and the
    search ends with the one that completes the required number, or for every first object, with the first
    that has no second one.
    """
    n_arguments = len(arguments)
    n_free, needed = packed.conditions[condition, N_FREE], packed.conditions[condition, COUNT]
    bound[:n_arguments] = arguments
    bound[n_arguments:] = -1
    if n_free == 0:
        return _all_true(packed, condition, matrix, bound, point)
    found, needs_every = 0, needed == 0
    for first in objects:
        if is_argument(first, arguments):
            continue
        bound[n_arguments] = first
        if needs_every:
            if found < needed:
                return False
            needed += 1
        if n_free == 1:
            found += _all_true(packed, condition, matrix, bound, point)
            if found >= needed:
                return True
            continue
        for second in objects:
            if second != first and not is_argument(second, arguments):
                bound[n_arguments + 1] = second
                found += _all_true(packed, condition, matrix, bound, point)
                if found >= needed:
                    if needs_every:
                        break
                    return True
    return bool(needs_every and 0 < needed <= found)


@kernel
def leaves(
    packed: Packed,
    matrix: NDArray[np.float64],
    scenes: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]],
    begin: int,
    end: int,
    out: NDArray[np.int32],
) -> None:
    """Write the leaf of every tree (n_scenes, n_trees) for scenes from `begin` up to `end`."""
    rows, starts, counts, arguments = scenes
    bound = np.empty(arguments.shape[1] + 2, dtype=np.int64)
    point = np.empty((1, max(matrix.shape[1], 2)))
    for i in range(begin, end):
        objects = rows[starts[i] : starts[i] + counts[i]]
        for tree in range(len(packed.roots)):
            node = packed.roots[tree]
            while packed.nodes[node, CONDITION] >= 0:
                asked = packed.nodes[node, CONDITION]
                is_true = condition_holds(packed, asked, matrix, objects, arguments[i], bound, point)
                node = packed.nodes[node, YES if is_true else NO]
            out[i, tree] = packed.nodes[node, LEAF]
