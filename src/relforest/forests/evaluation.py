"""Compiled evaluation of trees of conditions, scene by scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from relforest.forests.kinds import FIRST, LIMIT, SECOND, value
from relforest.forests.packing import (
    BEGIN,
    CIRCULAR,
    CONDITION,
    COUNT,
    DIM,
    END,
    LEAF,
    N_FREE,
    NO,
    OFFSET,
    OPERATION,
    VARIABLES,
    YES,
    Packed,
)
from relforest.mappings.kernels import map_point
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

    For `Bound` in the units of the mapping, for `Near` the sum of squares less 1, for `Is` 0.5 or -0.5; NaN
    if the mapping is undefined. `point` (1, d) is space for its value.
    """
    row, numbers = packed.statements[statement], packed.numbers[statement]
    a, b, c = row[VARIABLES], row[VARIABLES + 1], row[VARIABLES + 2]
    objects = (bound[a], bound[b] if b >= 0 else -1, bound[c] if c >= 0 else -1)
    result = np.nan
    if map_point(row[OPERATION], row[CIRCULAR] == 1, (row[OFFSET], row[DIM]), matrix, objects, point, 0):
        second = int(numbers[SECOND])
        y = point[0, second] if second >= 0 else 0.0
        result = value(numbers, point[0, int(numbers[FIRST])], y) - numbers[LIMIT]
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
def _following(objects: NDArray[np.int64], arguments: NDArray[np.int64], place: int, other: int) -> int:
    """Return the first place after `place` but not `other` whose object is not one of the arguments."""
    for following in range(place + 1, len(objects)):
        is_free = following != other
        for argument in arguments:
            is_free &= argument != objects[following]
        if is_free:
            return following
    return len(objects)


@inlined
def next_choice(
    objects: NDArray[np.int64], arguments: NDArray[np.int64], n_free: int, choice: tuple[int, int]
) -> tuple[int, int]:
    """Return the places of the one or two free objects that come after a choice, -1 if there are none.

    The first choice follows (-1, -1). From a choice whose second place is the number of objects, the search
    goes on with the next first object.
    """
    first, second = choice
    n = len(objects)
    second = _following(objects, arguments, second, first) if n_free == 2 and first >= 0 else n
    if second >= n:
        first = _following(objects, arguments, first, -1)
        second = _following(objects, arguments, -1, first) if n_free == 2 else 0
    return (first, second) if first < n and second < n else (-1, -1)


@kernel
def condition_holds(
    packed: Packed,
    condition: int,
    matrix: NDArray[np.float64],
    objects: NDArray[np.int64],
    arguments: NDArray[np.int64],
    bound: NDArray[np.int64],
    point: NDArray[np.float64],
    stop: NDArray[np.bool_],
) -> bool:
    """Whether a condition holds in a scene; `bound` (n_arguments + 2,) is the choice that decided.

    `objects` and `arguments` are rows of `matrix`. Choices are tried in the order of the objects, and the
    search ends with the one that completes the required number, or for every first object, with the first
    that has no second one. It also ends, with any answer, once another thread sets ``stop[0]``.
    """
    n_arguments = len(arguments)
    n_free, needed = packed.conditions[condition, N_FREE], packed.conditions[condition, COUNT]
    bound[:n_arguments] = arguments
    bound[n_arguments:] = -1
    if n_free == 0:
        return _all_true(packed, condition, matrix, bound, point)
    found, needs_every = 0, needed == 0
    before, choice = -1, next_choice(objects, arguments, n_free, (-1, -1))
    while choice[0] >= 0 and not stop[0]:
        if needs_every and choice[0] != before:
            if found < needed:
                return False
            needed += 1
        before = choice[0]
        bound[n_arguments] = objects[choice[0]]
        if n_free == 2:
            bound[n_arguments + 1] = objects[choice[1]]
        if _all_true(packed, condition, matrix, bound, point):
            found += 1
            if needs_every:
                choice = (choice[0], len(objects))
            elif found >= needed:
                return True
        choice = next_choice(objects, arguments, n_free, choice)
    return bool(needs_every and 0 < needed <= found)


@kernel
def leaves(
    packed: Packed,
    matrix: NDArray[np.float64],
    scenes: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]],
    begin: int,
    end: int,
    out: NDArray[np.int32],
    stop: NDArray[np.bool_],
) -> None:
    """Write the leaf of every tree (n_scenes, n_trees) for scenes from `begin` to `end`, unless stopped."""
    rows, starts, counts, arguments = scenes
    bound = np.empty(arguments.shape[1] + 2, dtype=np.int64)
    point = np.empty((1, max(matrix.shape[1], 2)))
    for i in range(begin, end):
        objects = rows[starts[i] : starts[i] + counts[i]]
        for tree in range(len(packed.roots)):
            node = packed.roots[tree]
            while packed.nodes[node, CONDITION] >= 0:
                asked = packed.nodes[node, CONDITION]
                is_true = condition_holds(packed, asked, matrix, objects, arguments[i], bound, point, stop)
                node = packed.nodes[node, YES if is_true else NO]
            out[i, tree] = packed.nodes[node, LEAF]
