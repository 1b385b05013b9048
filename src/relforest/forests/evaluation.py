"""Compiled evaluation of trees of conditions, scene by scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from relforest.forests.forms import FIRST, LIMIT, SECOND, value
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
from relforest.mappings.related import RELATED
from relforest.scenes.pairs import is_related, is_related_to_any
from relforest.support.jit import hold, inlined, kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Facts(NamedTuple):
    """What is known about object rows, and which of them belong to a scene."""

    matrix: NDArray[np.float64]  # (n_rows, width)
    pairs: NDArray[np.int64]  # (n_pairs, 3), see `relforest.scenes.Scenes.pairs`
    objects: NDArray[np.int64]  # (n_objects,); before a scene is chosen, those of all scenes


@inlined
def look(
    row: NDArray[np.int64],
    facts: Facts,
    bound: NDArray[np.int64],
    points: NDArray[np.float64],
    place: int,
) -> bool:
    """Write the value of a mapping of bound object rows into ``points[place]``; False if it is undefined."""
    a, b, c = row[VARIABLES], row[VARIABLES + 1], row[VARIABLES + 2]
    objects = (bound[a], bound[b] if b >= 0 else -1, bound[c] if c >= 0 else -1)
    if row[OPERATION] == RELATED:
        if row[DIM] == 1:
            is_true = is_related_to_any(facts.pairs, row[OFFSET], objects[0], facts.objects)
        else:
            is_true = is_related(facts.pairs, row[OFFSET], objects[0], objects[1])
        points[place, 0] = 1.0 if is_true else 0.0
        is_defined = objects[0] >= 0 and (row[DIM] == 1 or objects[1] >= 0)
    else:
        span = (row[OFFSET], row[DIM])
        is_defined = map_point(row[OPERATION], row[CIRCULAR] == 1, span, facts.matrix, objects, points, place)
    hold(facts.matrix, facts.pairs)
    return bool(is_defined)


@inlined
def excess(
    packed: Packed,
    statement: int,
    facts: Facts,
    bound: NDArray[np.int64],
    point: NDArray[np.float64],
) -> float:
    """By how much a statement about the bound object rows fails: it is true if this is at most 0.

    For `Bound` in the units of the mapping, for `Near` the sum of squares less 1, for `Is` 0.5 or -0.5; NaN
    if the mapping is undefined. `point` (1, d) is space for its value.
    """
    numbers, result = packed.numbers[statement], np.nan
    if look(packed.statements[statement], facts, bound, point, 0):
        second = int(numbers[SECOND])
        y = point[0, second] if second >= 0 else 0.0
        result = value(numbers, point[0, int(numbers[FIRST])], y) - numbers[LIMIT]
    return float(result)


@kernel
def _all_true(
    packed: Packed,
    condition: int,
    facts: Facts,
    bound: NDArray[np.int64],
    point: NDArray[np.float64],
) -> bool:
    for statement in range(packed.conditions[condition, BEGIN], packed.conditions[condition, END]):
        if not excess(packed, statement, facts, bound, point) <= 0.0:
            return False
    return True


@inlined
def following(objects: NDArray[np.int64], arguments: NDArray[np.int64], place: int, other: int) -> int:
    """Return the first place after `place` but not `other` whose object is not one of the arguments.

    With -1 for `place` it is the first one of all; the number of objects means that there is none.
    """
    found = place + 1
    while found < len(objects):
        is_free = found != other
        for argument in arguments:
            is_free &= argument != objects[found]
        if is_free:
            break
        found += 1
    return found


@kernel
def condition_holds(
    packed: Packed,
    condition: int,
    facts: Facts,
    arguments: NDArray[np.int64],
    bound: NDArray[np.int64],
    point: NDArray[np.float64],
    stop: NDArray[np.bool_],
) -> bool:
    """Whether a condition holds in a scene; `bound` (n_arguments + 2,) is the choice that decided.

    `facts` are about the objects of this scene. Choices are tried in the order of the objects, and the
    search ends with the one that completes the required number, or for every first object, with the first
    that has no second one. It also ends, with any answer, once another thread sets ``stop[0]``.
    """
    n_arguments, objects = len(arguments), facts.objects
    n_free, needed = packed.conditions[condition, N_FREE], packed.conditions[condition, COUNT]
    bound[:n_arguments] = arguments
    bound[n_arguments:] = -1
    if n_free == 0:
        return _all_true(packed, condition, facts, bound, point)
    found, needs_every = 0, needed == 0
    first = following(objects, arguments, -1, -1)
    while first < len(objects) and not stop[0]:
        if needs_every:
            if found < needed:
                return False
            needed += 1
        bound[n_arguments] = objects[first]
        second = following(objects, arguments, -1, first) if n_free == 2 else 0
        while second < len(objects):
            if n_free == 2:
                bound[n_arguments + 1] = objects[second]
            if _all_true(packed, condition, facts, bound, point):
                found += 1
                if found >= needed:
                    if needs_every:
                        break
                    return True
            second = following(objects, arguments, second, first) if n_free == 2 else len(objects)
        first = following(objects, arguments, first, -1)
    return bool(needs_every and 0 < needed <= found)


@kernel
def leaves(
    packed: Packed,
    facts: Facts,
    scenes: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]],
    begin: int,
    end: int,
    out: NDArray[np.int32],
    stop: NDArray[np.bool_],
) -> None:
    """Write the leaf of every tree (n_scenes, n_trees) for scenes from `begin` to `end`, unless stopped."""
    rows, starts, counts, arguments = scenes
    bound = np.empty(arguments.shape[1] + 2, dtype=np.int64)
    point = np.empty((1, max(facts.matrix.shape[1], 2)))
    for i in range(begin, end):
        here = Facts(facts.matrix, facts.pairs, rows[starts[i] : starts[i] + counts[i]])
        for tree in range(len(packed.roots)):
            node = packed.roots[tree]
            while packed.nodes[node, CONDITION] >= 0:
                asked = packed.nodes[node, CONDITION]
                is_true = condition_holds(packed, asked, here, arguments[i], bound, point, stop)
                node = packed.nodes[node, YES if is_true else NO]
            out[i, tree] = packed.nodes[node, LEAF]
