"""How far each scene is from satisfying each condition, and how many choices of objects satisfy it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from relforest.forests.evaluation import Facts, following, look
from relforest.forests.forms import FIRST, FORM, IS, LIMIT, NEAR, SECOND, WEIGHT, value
from relforest.forests.packing import BEGIN, COUNT, END, N_FREE, Packed
from relforest.support.jit import inlined, kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Work(NamedTuple):
    """Space for one choice of objects and for what all choices of a scene have shown."""

    bound: NDArray[np.int64]  # (n_arguments + 2,): the choice
    points: NDArray[np.float64]  # (n_points, width): the mappings' values
    is_defined: NDArray[np.bool_]  # (n_points,)
    is_used: NDArray[np.bool_]  # (3, n_points): by conditions with 0, 1 and 2 free variables
    smallest: NDArray[np.float64]  # (n_conditions, most): the smallest margins, ascending
    farthest: NDArray[np.float64]  # (n_conditions,): the largest margin of any first object
    n_before: NDArray[np.int64]  # (n_conditions,): the count before the present first object


def work_space(packed: Packed, n_arguments: int, width: int) -> Work:
    """Return space for scenes with so many arguments and columns."""
    n_points, n_conditions = len(packed.points), len(packed.conditions)
    is_used = np.zeros((3, n_points), dtype=np.bool_)
    for begin, end, n_free, _ in packed.conditions.tolist():
        is_used[n_free, packed.point_of[begin:end]] = True
    most = int(packed.conditions[:, COUNT].max(initial=1))
    return Work(
        np.empty(n_arguments + 2, dtype=np.int64),
        np.empty((n_points, max(width, 2))),
        np.empty(n_points, dtype=np.bool_),
        is_used,
        np.empty((n_conditions, max(most, 1))),
        np.empty(n_conditions),
        np.empty(n_conditions, dtype=np.int64),
    )


@inlined
def _margin(packed: Packed, condition: int, work: Work) -> float:
    """How far the bound objects are from making all statements true, at most 0 if they do.

    It is the largest excess of any statement. A category cannot be nearly right: NaN if one is wrong, or
    anything is undefined; -1 or 1 if all statements are about categories.
    """
    worst, is_wrong, has_number, is_defined = -np.inf, False, False, True
    for statement in range(packed.conditions[condition, BEGIN], packed.conditions[condition, END]):
        place, numbers = packed.point_of[statement], packed.numbers[statement]
        is_defined &= work.is_defined[place]
        if not is_defined or (is_wrong and has_number):
            break
        second = int(numbers[SECOND])
        y = work.points[place, second] if second >= 0 else 0.0
        x = value(numbers, work.points[place, int(numbers[FIRST])], y) - numbers[LIMIT]
        if numbers[FORM] >= IS:
            is_wrong |= x > 0.0
            continue
        has_number = True
        if numbers[FORM] >= NEAR:
            # The distance beyond the end of an interval, or about that beyond an ellipse.
            area = numbers[WEIGHT] * (numbers[WEIGHT] if second < 0 else numbers[WEIGHT + 1])
            x = (math.sqrt(x + 1.0) - 1.0) / math.sqrt(math.sqrt(area))
        worst = max(worst, x)
    if not has_number:
        worst = 1.0 if is_wrong else -1.0
    elif is_wrong:
        worst = np.nan
    return worst if is_defined else np.nan


@inlined
def _keep(smallest: NDArray[np.float64], row: int, n: int, x: float) -> None:
    """Insert a number other than NaN into the ascending list of the first `n` of a row."""
    place = n - 1
    if x < smallest[row, place]:
        while place > 0 and x < smallest[row, place - 1]:
            smallest[row, place] = smallest[row, place - 1]
            place -= 1
        smallest[row, place] = x


@kernel
def _look(packed: Packed, n_free: int, facts: Facts, work: Work, counts: NDArray[np.float64]) -> None:
    """Take the bound objects into account for all conditions with so many free variables."""
    for place in range(len(packed.points)):
        if work.is_used[n_free, place]:
            work.is_defined[place] = look(packed.points[place], facts, work.bound, work.points, place)
    for condition in range(len(packed.conditions)):
        if packed.conditions[condition, N_FREE] == n_free:
            margin = _margin(packed, condition, work)
            _keep(work.smallest, condition, max(packed.conditions[condition, COUNT], 1), margin)
            counts[condition] += margin <= 0.0


@kernel
def _begin_first(packed: Packed, work: Work, counts: NDArray[np.float64]) -> None:
    """Begin with another first object, for conditions on every one."""
    for condition in range(len(packed.conditions)):
        if packed.conditions[condition, COUNT] == 0:
            work.smallest[condition, 0] = np.inf
            work.n_before[condition] = int(counts[condition])


@kernel
def _end_first(packed: Packed, work: Work, counts: NDArray[np.float64]) -> None:
    """Note how near the first object came, and count it once."""
    for condition in range(len(packed.conditions)):
        if packed.conditions[condition, COUNT] == 0:
            work.farthest[condition] = max(work.farthest[condition], work.smallest[condition, 0])
            counts[condition] = min(int(counts[condition]), work.n_before[condition] + 1)


@kernel
def measures(
    packed: Packed,
    facts: Facts,
    scenes: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]],
    begin: int,
    end: int,
    work: Work,
    out: NDArray[np.float64],
    stop: NDArray[np.bool_],
) -> None:
    """Write margins and counts (2, n_scenes, n_conditions) of scenes from `begin` to `end`, unless stopped.

    The margin of a scene is that of the last choice that is needed: of the best one, or of the k-th best if k
    are required; NaN if fewer have one. For every first object, it is the largest of their own margins, and
    the first objects are counted.
    """
    (rows, starts, sizes, arguments), margins, counts = scenes, out[0], out[1]
    n_arguments = arguments.shape[1]
    for i in range(begin, end):
        objects = rows[starts[i] : starts[i] + sizes[i]]
        here = Facts(facts.matrix, facts.pairs, objects)
        counts[i] = 0.0
        work.smallest[:] = np.inf
        work.farthest[:] = -np.inf
        work.bound[:n_arguments] = arguments[i]
        work.bound[n_arguments:] = -1
        if work.is_used[0].any():
            _look(packed, 0, here, work, counts[i])
        has_pairs = work.is_used[2].any()
        first = following(objects, arguments[i], -1, -1)
        if not has_pairs and not work.is_used[1].any():
            first = len(objects)
        while first < len(objects) and not stop[0]:
            work.bound[n_arguments] = objects[first]
            work.bound[n_arguments + 1] = -1
            if work.is_used[1].any():
                _look(packed, 1, here, work, counts[i])
            if has_pairs:
                _begin_first(packed, work, counts[i])
                second = following(objects, arguments[i], -1, first)
                while second < len(objects):
                    work.bound[n_arguments + 1] = objects[second]
                    _look(packed, 2, here, work, counts[i])
                    second = following(objects, arguments[i], second, first)
                _end_first(packed, work, counts[i])
            first = following(objects, arguments[i], first, -1)
        for condition in range(len(packed.conditions)):
            needed = packed.conditions[condition, COUNT]
            if needed == 0 and work.farthest[condition] > -np.inf:
                margin = work.farthest[condition]
            else:
                margin = work.smallest[condition, max(needed, 1) - 1]
            margins[i, condition] = margin if margin < np.inf else np.nan
