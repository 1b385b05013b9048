"""How far each scene is from satisfying each condition, and how many choices of objects satisfy it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from relforest.forests.evaluation import excess, following
from relforest.forests.forms import FORM, IS, NEAR, SECOND, WEIGHT
from relforest.forests.packing import BEGIN, COUNT, END, N_FREE, Packed
from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray


@kernel
def _margin(
    packed: Packed,
    condition: int,
    matrix: NDArray[np.float64],
    bound: NDArray[np.int64],
    point: NDArray[np.float64],
) -> float:
    """How far the bound objects are from making all statements true, at most 0 if they do.

    It is the largest excess of any statement. A category cannot be nearly right: NaN if one is wrong, or
    anything is undefined; -1 or 1 if all statements are about categories.
    """
    worst, is_wrong, has_number = -np.inf, False, False
    for statement in range(packed.conditions[condition, BEGIN], packed.conditions[condition, END]):
        x, numbers = excess(packed, statement, matrix, bound, point), packed.numbers[statement]
        if math.isnan(x):
            return np.nan
        if numbers[FORM] >= IS:
            is_wrong |= x > 0.0
            continue
        has_number = True
        if numbers[FORM] >= NEAR:
            # The distance beyond the end of an interval, or about that beyond an ellipse.
            area = numbers[WEIGHT] * (numbers[WEIGHT] if numbers[SECOND] < 0 else numbers[WEIGHT + 1])
            x = (math.sqrt(x + 1.0) - 1.0) / math.sqrt(math.sqrt(area))
        worst = max(worst, x)
    if has_number:
        return np.nan if is_wrong else worst
    return 1.0 if is_wrong else -1.0


@kernel
def _keep(smallest: NDArray[np.float64], x: float) -> bool:
    """Insert a number other than NaN into the ascending list; return whether it is at most 0."""
    place = len(smallest) - 1
    if x < smallest[place]:
        while place > 0 and x < smallest[place - 1]:
            smallest[place] = smallest[place - 1]
            place -= 1
        smallest[place] = x
    return x <= 0.0


@kernel
def _measure(
    packed: Packed,
    condition: int,
    matrix: NDArray[np.float64],
    objects: NDArray[np.int64],
    arguments: NDArray[np.int64],
    bound: NDArray[np.int64],
    point: NDArray[np.float64],
    stop: NDArray[np.bool_],
) -> tuple[float, int]:
    n_arguments, n_free = len(arguments), packed.conditions[condition, N_FREE]
    every = packed.conditions[condition, COUNT] == 0
    smallest = np.full(max(packed.conditions[condition, COUNT], 1), np.inf)
    bound[:n_arguments] = arguments
    bound[n_arguments:] = -1
    count, farthest = 0, -np.inf
    if n_free == 0:
        count += _keep(smallest, _margin(packed, condition, matrix, bound, point))
    first = following(objects, arguments, -1, -1) if n_free > 0 else len(objects)
    while first < len(objects) and not stop[0]:
        bound[n_arguments] = objects[first]
        second = following(objects, arguments, -1, first) if n_free == 2 else 0
        n_before = count
        while second < len(objects):
            if n_free == 2:
                bound[n_arguments + 1] = objects[second]
            count += _keep(smallest, _margin(packed, condition, matrix, bound, point))
            second = following(objects, arguments, second, first) if n_free == 2 else len(objects)
        if every:
            farthest, smallest[0] = max(farthest, smallest[0]), np.inf
            count = min(count, n_before + 1)
        first = following(objects, arguments, first, -1)
    margin = farthest if every and farthest > -np.inf else smallest[len(smallest) - 1]
    return (margin if margin < np.inf else np.nan), count


@kernel
def measures(
    packed: Packed,
    matrix: NDArray[np.float64],
    scenes: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]],
    begin: int,
    end: int,
    margins: NDArray[np.float64],
    counts: NDArray[np.float64],
    stop: NDArray[np.bool_],
) -> None:
    """Write margins and counts (n_scenes, n_conditions) for scenes from `begin` up to `end`, unless stopped.

    The margin of a scene is that of the last choice that is needed: of the best one, or of the k-th best if k
    are required; NaN if fewer have one. For every first object, it is the largest of their own margins, and
    the first objects are counted.
    """
    rows, starts, sizes, arguments = scenes
    bound = np.empty(arguments.shape[1] + 2, dtype=np.int64)
    point = np.empty((1, max(matrix.shape[1], 2)))
    for i in range(begin, end):
        objects = rows[starts[i] : starts[i] + sizes[i]]
        for condition in range(len(packed.conditions)):
            margins[i, condition], counts[i, condition] = _measure(
                packed, condition, matrix, objects, arguments[i], bound, point, stop
            )
