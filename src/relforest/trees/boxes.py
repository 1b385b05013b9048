"""Boxes around the objects of one scene, which rule out many of them at once.

For every attribute that a tree compares, the objects of a scene are split in halves again and again, and
every part has a box, the ranges of its values. A box bounds the points that the next question will ask about,
hence their distance from the centre of the volume. If neither a more probable leaf nor a larger density can
come of that, the whole part is skipped. The bounds hold for the numbers that `ask` computes, rounding
included, so the answer is that of the search through all objects.

Boxes help where a question follows the instantiation of one of its variables, asks for identity, difference
or distance in a Euclidean attribute of any dimension, and its No cannot lead to a more probable leaf than the
best so far. A question about two of n objects then costs about n log(n) instead of n^2. In the plane it is
about n^1.5 if the centre is a circle (a distance other than zero), or if many pairs lie inside a volume
whose outside wins.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.mappings.operations import DISTANCE, IDENTITY
from relforest.support.jit import inlined, kernel
from relforest.trees.packing import (
    ATTRIBUTE_DIM,
    CHILDREN,
    DIM,
    FIRST,
    OPERATION,
    RANK,
    SLOT,
    VARIABLES,
    VOLUME,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.trees.packing import PackedTree

FEWEST: Final = 32
"""Scenes of at most so many objects are searched one object after the other."""

# Making boxes takes as long as a few searches through all objects.
_PATIENCE: Final = 3

# Squares of larger values might overflow, and nothing follows from a bound that is not a number.
_LARGEST: Final = 1e70

# Allowance for each component of a point; every rounding errs by at most 1.1e-16.
_ROUNDING: Final = 1e-15

_SIZE: Final = 0
_PLACE: Final = 1
_ORDER: Final = 2


class Boxes(NamedTuple):
    """Space for the boxes of one scene; the first axis counts the attributes that a tree compares.

    Parts are numbered depth first: a part of m objects is followed by its two halves, which end before
    number ``2 * m - 1`` from it. Objects with an undefined value have parts of their own at the end. Since n
    objects have at most ``2 * n - 1`` parts, the last entries are free: ``parts[slot, _SIZE, -1]`` counts the
    searches, ``parts[slot, _PLACE, -1]`` is the number of parts, and ``corners[slot, -1]`` is scratch.
    """

    parts: NDArray[np.int64]  # (n_slots, 3, 2 * n): how many objects, the place of the only one, scratch
    corners: NDArray[np.float64]  # (n_slots, 2 * n, 2, dim): smallest and largest values, NaN = undefined
    fewest: int  # boxes are for scenes with more objects than this


def make_boxes(packed: PackedTree, n_objects: int, fewest: int = FEWEST) -> Boxes:
    """Return space for the boxes of scenes of up to `n_objects` objects."""
    n_slots, dim = packed.boxed
    return Boxes(
        np.empty((n_slots, 3, 2 * n_objects), dtype=np.int64),
        np.empty((n_slots, 2 * n_objects, 2, dim)),
        # With more objects than variables, one is always left to be bound.
        max(fewest, packed.n_variables),
    )


@kernel
def forget(boxes: Boxes) -> None:
    """Forget the boxes of the scene before."""
    boxes.parts[:, _SIZE, -1] = 0


@kernel
def first_part(
    nodes: NDArray[np.int64],
    instantiation: int,
    best_rank: int,
    scene: tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]],
    boxes: Boxes,
) -> int:
    """Return the part with which a search for the next variable begins, or -1 to go through all objects.

    `scene` is its matrix, the rows of its objects and those of the arguments.
    """
    matrix, objects, arguments = scene
    slot, question = nodes[instantiation, SLOT], nodes[instantiation, CHILDREN]
    if slot < 0 or nodes[nodes[question, CHILDREN + 1], RANK] < best_rank:
        return -1
    parts = boxes.parts[slot]
    parts[_SIZE, -1] += 1
    if parts[_SIZE, -1] == _PATIENCE:
        span = (nodes[question, FIRST], nodes[question, ATTRIBUTE_DIM])
        parts[_PLACE, -1] = 0
        if max(_largest(span, matrix, objects), _largest(span, matrix, arguments)) <= _LARGEST:
            parts[_PLACE, -1] = _split(span, matrix, objects, parts, boxes.corners[slot])
    return 0 if parts[_SIZE, -1] >= _PATIENCE and parts[_PLACE, -1] > 0 else -1


@kernel
def next_place(
    tree: tuple[NDArray[np.int64], NDArray[np.float64]],
    instantiation: int,
    part: int,
    bound: NDArray[np.int64],
    scene: tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]],
    stand: tuple[float, tuple[int, float, bool]],
    boxes: Boxes,
) -> tuple[int, int, int]:
    """Return the place of the next object worth asking about (-1 = none), the part after it, and parts seen.

    `tree` is its nodes and numbers, `bound` the object rows of the variables so far, `scene` as for
    `first_part`, `stand` the sum of log densities so far, and the best so far as `_may_win` takes it.
    """
    nodes, numbers = tree
    matrix, objects, _ = scene
    slot, question = nodes[instantiation, SLOT], nodes[instantiation, CHILDREN]
    total, best = stand
    yes, no, error = nodes[question, CHILDREN], nodes[question, CHILDREN + 1], nodes[question, CHILDREN + 2]
    ranks = (nodes[yes, RANK], nodes[no, RANK], nodes[error, RANK])
    squared_radius = numbers[nodes[question, VOLUME]]
    slope = -0.5 * numbers[nodes[question, VOLUME] + 1]
    is_first = nodes[question, VARIABLES] == len(bound)
    other = -1
    if nodes[question, OPERATION] != IDENTITY:
        other = bound[nodes[question, VARIABLES + 1]] if is_first else bound[nodes[question, VARIABLES]]
    parts, corners = boxes.parts[slot], boxes.corners[slot]
    seen = 0
    while part < parts[_PLACE, -1]:
        seen += 1
        low, high = _squared_distances(tree, question, matrix, (other, is_first), corners, part)
        if math.isnan(low):
            may_win = _may_win(ranks[2], total, best)
        else:
            may_win = low <= squared_radius and _may_win(ranks[0], total + slope * low, best)
            if not may_win and high > squared_radius:
                may_win = _may_win(ranks[1], total + slope * max(low, squared_radius), best)
        size = parts[_SIZE, part]
        if not may_win:
            part += 2 * size - 1
            continue
        part += 1
        if size == 1:
            place, repeated = parts[_PLACE, part - 1], False
            for earlier in bound:
                repeated |= earlier == objects[place]
            if not repeated:
                return place, part, seen
    return -1, part, seen


@inlined
def _may_win(rank: int, total: float, best: tuple[int, float, bool]) -> bool:
    """Whether a sequence may replace the best if it has at best this rank and this sum of log densities.

    `best` is the rank and the sum of the best, and whether an equal sum would win, being earlier in order.
    """
    best_rank, best_total, ties_win = best
    return rank < best_rank or (
        rank == best_rank and (total > best_total or (ties_win and total == best_total))
    )


@inlined
def _squared_distances(
    tree: tuple[NDArray[np.int64], NDArray[np.float64]],
    question: int,
    matrix: NDArray[np.float64],
    pair: tuple[int, bool],
    corners: NDArray[np.float64],
    part: int,
) -> tuple[float, float]:
    """Return bounds of the squared distance to a volume's centre within the box of a part; NaN if undefined.

    `pair` is the row of the other object in the question, and whether the one in the box comes first.
    """
    nodes, numbers = tree
    other, is_first = pair
    operation, first = nodes[question, OPERATION], nodes[question, FIRST]
    mean, dim = nodes[question, VOLUME] + 2, nodes[question, DIM]
    scratch, low_sum, high_sum = len(corners) - 1, 0.0, 0.0
    is_defined = operation == IDENTITY or other >= 0
    # Offsets from the centre. Every step is one of `ask`, and rounding keeps numbers in order.
    for i in range(nodes[question, ATTRIBUTE_DIM] if is_defined else 0):
        low, high = corners[part, 0, i], corners[part, 1, i]
        if operation != IDENTITY:
            value = matrix[other, first + i]
            low, high = (value - high, value - low) if is_first else (low - value, high - value)
        is_defined &= not math.isnan(low)
        if operation == DISTANCE:
            near, far = max(low, -high, 0.0), max(-low, high)
            low_sum += near * near
            high_sum += far * far
        else:
            low, high = low - numbers[mean + i], high - numbers[mean + i]
            corners[scratch, 0, i], corners[scratch, 1, i] = 0.5 * (low + high), 0.5 * (high - low)
    if operation == DISTANCE:
        low, high = math.sqrt(low_sum) - numbers[mean], math.sqrt(high_sum) - numbers[mean]
        corners[scratch, 0, 0], corners[scratch, 1, 0] = 0.5 * (low + high), 0.5 * (high - low)
    # By the triangle inequality, no distance differs from that of the box's middle by more than the longest
    # half diagonal.
    middle, half, error = 0.0, 0.0, 0.0
    for i in range(dim):
        a, b = corners[scratch, 0, i], corners[scratch, 1, i]
        for j in range(dim):
            c, d = corners[scratch, 0, j], corners[scratch, 1, j]
            factor = numbers[mean + dim + i * dim + j]
            middle += factor * a * c
            half += abs(factor) * b * d
            error += abs(factor) * (abs(a) + b) * (abs(c) + d)
    error *= _ROUNDING * (dim + 10)
    half = math.sqrt(half)
    low = max(math.sqrt(max(middle - error, 0.0)) - half, 0.0)
    high = math.sqrt(max(middle, 0.0) + error) + half
    return (low * low - error, high * high + error) if is_defined else (np.nan, np.nan)


@kernel
def _largest(span: tuple[int, int], matrix: NDArray[np.float64], rows: NDArray[np.int64]) -> float:
    """Return the largest absolute value of an attribute in some rows, -1 = none."""
    first, dim = span
    largest = 0.0
    for row in rows:
        for i in range(dim):
            # False for NaN.
            if row >= 0 and abs(matrix[row, first + i]) > largest:
                largest = abs(matrix[row, first + i])
    return largest


@kernel
def _split(
    span: tuple[int, int],
    matrix: NDArray[np.float64],
    objects: NDArray[np.int64],
    parts: NDArray[np.int64],
    corners: NDArray[np.float64],
) -> int:
    """Write the parts of the objects and their boxes; return how many parts there are."""
    order = parts[_ORDER]
    n_defined = _defined_first(span, matrix, objects, order)
    end = 0
    for begin, size in ((0, n_defined), (n_defined, len(objects) - n_defined)):
        if size > 0:
            parts[_SIZE, end], parts[_PLACE, end] = size, begin
            end += 2 * size - 1
    for part in range(end):
        # Until it is split, a part says in the place of its object where it begins in the order.
        size, begin = parts[_SIZE, part], parts[_PLACE, part]
        chosen = order[begin : begin + size]
        axis = _enclose(span, matrix, objects, chosen, corners[part])
        if begin >= n_defined:
            corners[part] = np.nan
        if size == 1:
            parts[_PLACE, part] = chosen[0]
        else:
            middle = 0.5 * (corners[part, 0, axis] + corners[part, 1, axis])
            half = _divide(matrix[:, span[0] + axis], objects, chosen, middle)
            parts[_SIZE, part + 1], parts[_PLACE, part + 1] = half, begin
            parts[_SIZE, part + 2 * half], parts[_PLACE, part + 2 * half] = size - half, begin + half
    return end


@kernel
def _defined_first(
    span: tuple[int, int],
    matrix: NDArray[np.float64],
    objects: NDArray[np.int64],
    order: NDArray[np.int64],
) -> int:
    """Write the places of all objects, those with an undefined value last; return how many are defined."""
    first, dim = span
    defined, undefined = 0, len(objects)
    for place in range(len(objects)):
        total = 0.0
        for i in range(dim):
            total += matrix[objects[place], first + i]
        if math.isnan(total):
            undefined -= 1
            order[undefined] = place
        else:
            order[defined] = place
            defined += 1
    return defined


@kernel
def _enclose(
    span: tuple[int, int],
    matrix: NDArray[np.float64],
    objects: NDArray[np.int64],
    chosen: NDArray[np.int64],
    corners: NDArray[np.float64],
) -> int:
    """Write the box of the objects at the chosen places; return its longest axis."""
    first, dim = span
    widest, axis = -1.0, 0
    for i in range(dim):
        low, high = np.inf, -np.inf
        for place in chosen:
            value = matrix[objects[place], first + i]
            low, high = min(low, value), max(high, value)
        corners[0, i], corners[1, i] = low, high
        if high - low > widest:
            widest, axis = high - low, i
    return axis


@kernel
def _divide(
    values: NDArray[np.float64], objects: NDArray[np.int64], chosen: NDArray[np.int64], middle: float
) -> int:
    """Sort places into those with values up to the middle and the others; return how many are first."""
    left, right = 0, len(chosen)
    while left < right:
        if values[objects[chosen[left]]] <= middle:
            left += 1
        else:
            right -= 1
            chosen[left], chosen[right] = chosen[right], chosen[left]
    # Objects in the same place cannot be told apart.
    return left if 0 < left < len(chosen) else len(chosen) // 2
