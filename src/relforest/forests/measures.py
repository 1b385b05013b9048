"""How far each scene is from satisfying each condition, and how many choices of objects satisfy it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from relforest.forests.evaluation import excess, is_argument
from relforest.forests.packing import BEGIN, COUNT, END, IS, N_COMPONENTS, N_FREE, NEAR, TEST, Packed
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
        x, kind = excess(packed, statement, matrix, bound, point), packed.statements[statement, TEST]
        if math.isnan(x):
            return np.nan
        if kind >= IS:
            is_wrong |= x > 0.0
            continue
        has_number = True
        if kind == NEAR:
            a, b = packed.numbers[statement, 2], packed.numbers[statement, 3]
            # The distance beyond the end of an interval, or about that beyond an ellipse.
            scale = a if packed.statements[statement, N_COMPONENTS] == 1 else math.sqrt(a * b)
            x = (math.sqrt(x + 1.0) - 1.0) * scale
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
) -> tuple[float, int]:
    n_arguments, n_free = len(arguments), packed.conditions[condition, N_FREE]
    smallest = np.full(max(packed.conditions[condition, COUNT], 1), np.inf)
    bound[:n_arguments] = arguments
    bound[n_arguments:] = -1
    count, farthest = 0, -np.inf
    if n_free == 0:
        count += _keep(smallest, _margin(packed, condition, matrix, bound, point))
    else:
        for first in objects:
            if is_argument(first, arguments):
                continue
            bound[n_arguments] = first
            if n_free == 1:
                count += _keep(smallest, _margin(packed, condition, matrix, bound, point))
                continue
            n_before = count
            for second in objects:
                if second != first and not is_argument(second, arguments):
                    bound[n_arguments + 1] = second
                    count += _keep(smallest, _margin(packed, condition, matrix, bound, point))
            if packed.conditions[condition, COUNT] == 0:
                farthest, smallest[0] = max(farthest, smallest[0]), np.inf
                count = min(count, n_before + 1)
        if packed.conditions[condition, COUNT] == 0 and farthest > -np.inf:
            smallest[0] = farthest
    margin = smallest[len(smallest) - 1]
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
) -> None:
    """Write margins and counts (n_scenes, n_conditions) for scenes from `begin` up to `end`.

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
                packed, condition, matrix, objects, arguments[i], bound, point
            )
