"""Boxes around the objects of one scene, which rule out many of them at once.

For every attribute that a tree compares, the objects of a scene are split in halves again and again, and every
part has a bounding box of its values. From a box follow bounds of the point that a question is about to ask,
hence of the squared distance to the centre of its volume. If neither a more probable leaf nor a larger
density can come of that, the whole part is skipped. The bounds hold for the numbers as `ask` computes them,
rounding included, so the answer is that of the search that goes through all objects.

Covered is a variable whose instantiation is followed by a question about that very variable: identity,
difference or distance of a Euclidean attribute of any dimension. With two variables and n objects, a question
costs about n log(n) instead of n^2; it may take that much only where nearly all sequences lead to different leaves.
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

_SEARCHES: Final = 0
_END: Final = 1

# Splitting costs as much as a few searches through all objects.
_PATIENCE: Final = 3

# Larger values could overflow, and what is not a number cannot be compared with a bound.
_LARGEST: Final = 1e70


# Per component; each rounding may err by 1.1e-16.
_ROUNDING: Final = 1e-15


class Boxes(NamedTuple):
    """Space for the boxes of one scene; the first axis counts the attributes that a tree compares.

    Parts are numbered depth first, so that what follows a part is its halves, and those of part i
    with m objects end before ``i + 2 * m - 1``. Objects with an undefined value are last, in parts of their own.
    As n objects have at most 2n - 1 parts, the last entries are free for other purposes.
    """

    parts: NDArray[np.int64]  # (n_slots, 3, 2 * n): number of objects; the only one's place; scratch
    corners: NDArray[np.float64]  # (n_slots, 2 * n, 2, dim): smallest and largest values, NaN = undefined
    fewest: int  # scenes with at most so many objects are not split


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
    boxes.parts[:, _SEARCHES, -1] = 0


@kernel
def first_part(
    nodes: NDArray[np.int64],
    instantiation: int,
    best_rank: int,
    matrix: NDArray[np.float64],
    objects: NDArray[np.int64],
    arguments: NDArray[np.int64],
    boxes: Boxes,
) -> int:
    """Return the part with which a search for the next variable begins: 0, or -1 to go through all objects.

    Boxes help only if objects outside the volume cannot lead to a more probable leaf any more.
    """
    slot, question = nodes[instantiation, SLOT], nodes[instantiation, CHILDREN]
    if slot < 0 or nodes[nodes[question, CHILDREN + 1], RANK] < best_rank:
        return -1
    parts = boxes.parts[slot]
    parts[_SEARCHES, -1] += 1
    if parts[_SEARCHES, -1] == _PATIENCE:
        span = (nodes[question, FIRST], nodes[question, ATTRIBUTE_DIM])
        parts[_END, -1] = 0
        if max(_largest(span, matrix, objects), _largest(span, matrix, arguments)) <= _LARGEST:
            parts[_END, -1] = _split(span, matrix, objects, parts, boxes.corners[slot])
    return 0 if parts[_SEARCHES, -1] >= _PATIENCE and parts[_END, -1] > 0 else -1


@kernel
def next_place(
    nodes: NDArray[np.int64],
    numbers: NDArray[np.float64],
    instantiation: int,
    part: int,
    bound: NDArray[np.int64],
    matrix: NDArray[np.float64],
    objects: NDArray[np.int64],
    stand: tuple[float, int, float, bool],
    boxes: Boxes,
) -> tuple[int, int, int]:
    """Return the place of the next object worth asking about (-1 = none), the part after it, and parts seen.

    `bound` are the object rows of the variables so far; `stand` is the sum of log densities so far,
    the rank of the best leaf found, its sum, and whether an equal sum may come earlier in the order of sequences.
    """
    slot, question = nodes[instantiation, SLOT], nodes[instantiation, CHILDREN]
    total, best_rank, best_total, tie_wins = stand
    children = nodes[question, CHILDREN : CHILDREN + 3]
    ranks = (nodes[children[0], RANK], nodes[children[1], RANK], nodes[children[2], RANK])
    squared_radius = numbers[nodes[question, VOLUME]]
    sharpness = numbers[nodes[question, VOLUME] + 1]
    a, b = nodes[question, VARIABLES], nodes[question, VARIABLES + 1]
    other = -1
    if nodes[question, OPERATION] != IDENTITY:
        other = bound[b] if a == len(bound) else bound[a]
    sizes, places = boxes.parts[slot, 0], boxes.parts[slot, 1]
    end, seen = boxes.parts[slot, _END, -1], 0
    while part < end:
        seen += 1
        low, high = _squared_distances(nodes, question, numbers, matrix, other, a == len(bound), boxes, slot, part)
        if math.isnan(low):
            hopeful = _may_win(ranks[2], total, best_rank, best_total, tie_wins)
        else:
            inside = total - 0.5 * sharpness * low
            outside = total - 0.5 * sharpness * max(low, squared_radius)
            hopeful = (
                low <= squared_radius and _may_win(ranks[0], inside, best_rank, best_total, tie_wins)
            ) or (high > squared_radius and _may_win(ranks[1], outside, best_rank, best_total, tie_wins))
        size = sizes[part]
        if not hopeful:
            part += 2 * size - 1
            continue
        part += 1
        if size == 1:
            place, repeated = places[part - 1], False
            for earlier in bound:
                repeated |= earlier == objects[place]
            if not repeated:
                return place, part, seen
    return -1, part, seen


@inlined
def _may_win(rank: int, total: float, best_rank: int, best_total: float, tie_wins: bool) -> bool:
    """Whether a leaf of at best this rank and this sum of log densities may replace the best so far."""
    return rank < best_rank or (
        rank == best_rank and (total > best_total or (tie_wins and total == best_total))
    )


@inlined
def _squared_distances(
    nodes: NDArray[np.int64],
    question: int,
    numbers: NDArray[np.float64],
    matrix: NDArray[np.float64],
    other: int,
    is_first: bool,
    boxes: Boxes,
    slot: int,
    part: int,
) -> tuple[float, float]:
    """Return bounds of the squared distance to a volume's centre within a box; NaN if undefined.

    `other` is the row of the object that the question compares with the one in the box, which `is_first`
    of the two. Every step towards the point is one of `ask`, and rounding preserves order.
    """
    corners, point = boxes.corners, boxes.corners[slot, -1]
    operation, first = nodes[question, OPERATION], nodes[question, FIRST]
    mean, dim = nodes[question, VOLUME] + 2, nodes[question, DIM]
    precision = mean + dim
    if operation != IDENTITY and other < 0:
        return np.nan, np.nan
    least, most = 0.0, 0.0
    for i in range(nodes[question, ATTRIBUTE_DIM]):
        low, high = corners[slot, part, 0, i], corners[slot, part, 1, i]
        if operation != IDENTITY:
            value = matrix[other, first + i]
            low, high = (value - high, value - low) if is_first else (low - value, high - value)
        if math.isnan(low):
            return np.nan, np.nan
        if operation == DISTANCE:
            near, far = max(low, -high, 0.0), max(-low, high)
            least += near * near
            most += far * far
        else:
            low, high = low - numbers[mean + i], high - numbers[mean + i]
            point[0, i], point[1, i] = 0.5 * (low + high), 0.5 * (high - low)
    if operation == DISTANCE:
        low, high = math.sqrt(least) - numbers[mean], math.sqrt(most) - numbers[mean]
        point[0, 0], point[1, 0] = 0.5 * (low + high), 0.5 * (high - low)
    # By the triangle inequality, a distance differs from the one of the box's middle by at most the
    # length of half a diagonal.
    middle, half, error = 0.0, 0.0, 0.0
    for i in range(dim):
        a, b = point[0, i], point[1, i]
        for j in range(dim):
            c, d = point[0, j], point[1, j]
            factor = numbers[precision + i * dim + j]
            middle += factor * a * c
            half += abs(factor) * b * d
            error += abs(factor) * (abs(a) + b) * (abs(c) + d)
    error *= _ROUNDING * (dim + 10)
    half = math.sqrt(half)
    low = max(math.sqrt(max(middle - error, 0.0)) - half, 0.0)
    high = math.sqrt(middle + error) + half
    return low * low - error, high * high + error


@kernel
def _largest(
    span: tuple[int, int], matrix: NDArray[np.float64], rows: NDArray[np.int64]
) -> float:
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
    """Write the parts of the objects and their boxes; return how many there are."""
    first, dim = span
    sizes, begins, order = parts[0], parts[1], parts[2]
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
    end = 0
    for begin, size in ((0, defined), (defined, len(objects) - defined)):
        if size > 0:
            sizes[end], begins[end] = size, begin
            end += 2 * size - 1
    for part in range(end):
        begin, size = begins[part], sizes[part]
        widest, axis = -1.0, 0
        for i in range(dim):
            low = high = matrix[objects[order[begin]], first + i]
            for at in range(begin + 1, begin + size):
                value = matrix[objects[order[at]], first + i]
                low, high = min(low, value), max(high, value)
            corners[part, 0, i], corners[part, 1, i] = low, high
            if high - low > widest:
                widest, axis = high - low, i
        if begin >= defined:
            corners[part, 0, :] = np.nan
        if size == 1:
            begins[part] = order[begin]
            continue
        middle = corners[part, 0, axis] + 0.5 * widest
        left, right = begin, begin + size
        while left < right:
            if matrix[objects[order[left]], first + axis] <= middle:
                left += 1
            else:
                right -= 1
                order[left], order[right] = order[right], order[left]
        half = left - begin
        if half in (0, size):
            half = size // 2
        sizes[part + 1], begins[part + 1] = half, begin
        sizes[part + 2 * half], begins[part + 2 * half] = size - half, begin + half
    return end
