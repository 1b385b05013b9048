"""Compiled evaluation of trees: one scene at a time, depth first, without allocation.

The first variables of a sequence belong to the action's arguments. Later ones go through all objects not yet
in the sequence, or are bound to "no object" once if there is none.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.mappings.kernels import map_point, wrap_angle
from relforest.support.jit import hold, inlined, kernel
from relforest.trees.boxes import Boxes, first_part, forget, next_place
from relforest.trees.packing import (
    ATTRIBUTE_DIM,
    CHILDREN,
    CIRCULAR,
    DIM,
    FIRST,
    INSTANTIATION,
    NODE_TYPE,
    OPERATION,
    ORDINAL,
    QUESTION,
    RANK,
    VARIABLES,
    VOLUME,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

YES: Final = 0
NO: Final = 1
ERROR: Final = 2

BOUND: Final = 0
WITNESSES: Final = 1
_NODE: Final = 2
_ASKED: Final = 3
_PLACE: Final = 4
PAUSE: Final = 5
_PART: Final = 6
_BEST_PLACE: Final = 7

_PATH: Final = 0
BEST_PATH: Final = 1
_TOTAL: Final = 2
_POINT: Final = 3
_TOTALS: Final = 4

# Columns of the row `PAUSE`; the columns after them store the state of a paused search.
STEPS: Final = 0
_PAUSED: Final = 1
_STANDS: Final = 2
_N_STANDS: Final = 5

MOST_STEPS: Final = 200_000
"""Most nodes visited in one call, a few milliseconds: Python can be interrupted between calls."""

UNFINISHED: Final = -1
"""Instead of a leaf, when no steps remain: called again with the same arguments, the search continues."""


class QueryWork(NamedTuple):
    """Buffers and results of `query_scene`.

    Results: ``integers[WITNESSES]``, the object rows of the most representative sequence (-1 = none),
    and ``numbers[BEST_PATH]``, the logarithm of its density at each question on its branch, root
    first (-inf = error, and beyond the branch). ``integers[PAUSE, STEPS]`` is the number of nodes that may be
    visited before the search pauses; the rest of that row and the last row of `numbers` store its state.
    """

    integers: NDArray[np.int64]  # (8, n_variables)
    numbers: NDArray[np.float64]  # (5, max(questions on a branch, n_variables, n_dims))


def query_work(n_variables: int, n_asked: int, n_dims: int) -> QueryWork:
    """Return buffers large enough for trees of these sizes."""
    work = QueryWork(
        np.full((8, max(n_variables, _STANDS + _N_STANDS)), -1, dtype=np.int64),
        np.zeros((5, max(n_asked, n_variables, n_dims, 2))),
    )
    work.integers[PAUSE] = 0
    return work


@inlined
def ask(
    nodes: NDArray[np.int64],
    node: int,
    numbers: NDArray[np.float64],
    matrix: NDArray[np.float64],
    objects: tuple[int, int, int],
    points: NDArray[np.float64],
    place: int,
) -> tuple[int, float]:
    """Answer one question for one tuple of object rows: (answer, log density relative to the peak).

    ``points[place]`` serves as space for the mapped point.
    """
    circular = nodes[node, CIRCULAR] == 1
    span = (nodes[node, FIRST], nodes[node, ATTRIBUTE_DIM])
    answer, density = ERROR, -np.inf
    if map_point(nodes[node, OPERATION], circular, span, matrix, objects, points, place):
        at, dim = nodes[node, VOLUME], nodes[node, DIM]
        mean, precision = at + 2, at + 2 + dim
        squared = 0.0
        if circular:
            offset = wrap_angle(points[place, 0] - numbers[mean])
            squared = offset * offset
            density = numbers[at + 1] * (math.cos(offset) - 1.0)
        else:
            for i in range(dim):
                product = 0.0
                for j in range(dim):
                    product += numbers[precision + i * dim + j] * (points[place, j] - numbers[mean + j])
                squared += product * (points[place, i] - numbers[mean + i])
            density = -0.5 * numbers[at + 1] * squared
        answer = YES if squared <= numbers[at] else NO
    hold(nodes, numbers)
    hold(matrix, points)
    return answer, density


@kernel
def query_scene(  # noqa: C901, PLR0912, PLR0915 - see the comment inside
    nodes: NDArray[np.int64],
    numbers: NDArray[np.float64],
    root: int,
    matrix: NDArray[np.float64],
    objects: NDArray[np.int64],
    arguments: NDArray[np.int64],
    work: QueryWork,
    boxes: Boxes | None = None,
) -> int:
    """Return the ordinal of the leaf that decides a scene, or `UNFINISHED`; the other results are in `work`.

    Of all instantiation sequences those in the most probable leaf count, and of these the first with the
    largest product of densities (sections 4.1 and 6.4). What cannot win any more is skipped: branches, and
    with `boxes` also objects. `nodes` and `numbers` hold one or several packed trees, the one to ask at row
    `root`; `objects` and `arguments` are rows of `matrix`, -1 = none.
    """
    state, floats = work.integers, work.numbers
    tree, scene = (nodes, numbers), (matrix, objects, arguments)
    winner, best_rank, node, depth, asked = -1, nodes.shape[0], root, 0, 0
    best_total, total, steps = -np.inf, 0.0, state[PAUSE, STEPS]
    if state[PAUSE, _PAUSED] == 1:
        (winner, best_rank, node, depth, asked), (best_total, total) = _resume(state, floats)
    elif boxes is not None:  # compiled separately, so that a search without boxes pays nothing for them
        forget(boxes)
    while True:
        if steps <= 0:
            _pause(state, floats, (winner, best_rank, node, depth, asked), (best_total, total))
            return UNFINISHED
        steps -= 1
        node_type, rank = nodes[node, NODE_TYPE], nodes[node, RANK]
        if node_type == QUESTION:
            a, b, c = nodes[node, VARIABLES], nodes[node, VARIABLES + 1], nodes[node, VARIABLES + 2]
            bound = (state[BOUND, a], state[BOUND, b] if b >= 0 else -1, state[BOUND, c] if c >= 0 else -1)
            answer, density = ask(nodes, node, numbers, matrix, bound, floats, _POINT)
            floats[_PATH, asked] = density
            total += density if answer != ERROR else 0.0
            asked, node = asked + 1, nodes[node, CHILDREN + answer]
            if nodes[node, RANK] <= best_rank:
                continue
        elif node_type == INSTANTIATION:
            if rank < best_rank or total >= best_total:  # further densities only lower the sum
                state[_NODE, depth], state[_ASKED, depth], state[_PLACE, depth] = node, asked, -1
                floats[_TOTAL, depth] = total
                if boxes is not None:
                    state[_PART, depth] = first_part(nodes, node, best_rank, scene, boxes)
                depth += 1
        elif rank < best_rank or total > best_total or _wins_tie(state, depth, total == best_total, boxes):
            winner, best_rank, best_total = nodes[node, ORDINAL], rank, total
            _remember(state, floats, depth, asked)
        # Bind the innermost variable that has objects left. Not a function: a third of the speed is at stake.
        while depth > 0:
            variable = depth - 1
            above, place = state[_NODE, variable], state[_PLACE, variable]
            found = place < 0
            if variable < len(arguments):
                state[BOUND, variable], state[_PLACE, variable] = arguments[variable], 0
            elif boxes is not None and state[_PART, variable] >= 0:
                stand = (variable, best_rank, best_total)
                found, steps = _bind_by_boxes(tree, state, floats, stand, scene, steps, boxes)
            else:
                place += 1
                while place < len(objects):
                    repeated = False
                    for earlier in range(variable):
                        repeated |= state[BOUND, earlier] == objects[place]
                    if not repeated:
                        found = True
                        break
                    place += 1
                state[BOUND, variable] = objects[place] if place < len(objects) else -1
                state[_PLACE, variable] = place
            if found:
                node = nodes[above, CHILDREN]
                asked, total = state[_ASKED, variable], floats[_TOTAL, variable]
                break
            depth -= 1
        if depth == 0:
            state[PAUSE, STEPS] = steps
            return winner


@kernel
def _bind_by_boxes(
    tree: tuple[NDArray[np.int64], NDArray[np.float64]],
    state: NDArray[np.int64],
    floats: NDArray[np.float64],
    stand: tuple[int, int, float],
    scene: tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]],
    steps: int,
    boxes: Boxes,
) -> tuple[bool, int]:
    """Bind a variable to the next object that boxes leave; return whether there is one and the steps left."""
    variable, best_rank, best_total = stand
    best = (best_rank, best_total, _order(state, variable) <= 0)
    above, part, before = state[_NODE, variable], state[_PART, variable], state[BOUND, :variable]
    total = floats[_TOTAL, variable]
    place, part, seen = next_place(tree, above, part, before, scene, (total, best), boxes)
    state[_PART, variable] = part
    if place >= 0:
        state[BOUND, variable], state[_PLACE, variable] = scene[1][place], place
    return place >= 0, steps - seen


@kernel
def _wins_tie(state: NDArray[np.int64], depth: int, is_tie: bool, boxes: Boxes | None) -> bool:
    """Whether a sequence as good as the best replaces it; without boxes, the best always comes first."""
    return boxes is not None and is_tie and _order(state, depth) < 0


@kernel
def _order(state: NDArray[np.int64], depth: int) -> int:
    """Return -1, 0 or 1: the first variables bind objects before those of the best, the same, or later."""
    for i in range(depth):
        if state[_PLACE, i] != state[_BEST_PLACE, i]:
            return -1 if state[_PLACE, i] < state[_BEST_PLACE, i] else 1
    return 0


@kernel
def _pause(
    state: NDArray[np.int64],
    floats: NDArray[np.float64],
    stands: tuple[int, int, int, int, int],
    totals: tuple[float, float],
) -> None:
    """Store the state of a search that has no steps left."""
    state[PAUSE, STEPS], state[PAUSE, _PAUSED] = 0, 1
    for i in range(_N_STANDS):
        state[PAUSE, _STANDS + i] = stands[i]
    floats[_TOTALS, 0], floats[_TOTALS, 1] = totals


@kernel
def _resume(
    state: NDArray[np.int64], floats: NDArray[np.float64]
) -> tuple[tuple[int, int, int, int, int], tuple[float, float]]:
    """Return the state that `_pause` stored."""
    state[PAUSE, _PAUSED] = 0
    at = state[PAUSE, _STANDS:]
    return (at[0], at[1], at[2], at[3], at[4]), (floats[_TOTALS, 0], floats[_TOTALS, 1])


@inlined
def _remember(state: NDArray[np.int64], floats: NDArray[np.float64], depth: int, asked: int) -> None:
    """Store the current sequence and its densities as the best so far."""
    for i in range(floats.shape[1]):
        floats[BEST_PATH, i] = floats[_PATH, i] if i < asked else -np.inf
    for i in range(state.shape[1]):
        state[WITNESSES, i] = state[BOUND, i] if i < depth else -1
        state[_BEST_PLACE, i] = state[_PLACE, i]


@kernel
def query_batch(
    nodes: NDArray[np.int64],
    numbers: NDArray[np.float64],
    matrix: NDArray[np.float64],
    scenes: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]],
    first: int,
    work: QueryWork,
    out: tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.int64]],
    boxes: Boxes | None,
) -> int:
    """Query the scenes of a batch from number `first`; return the number of the first scene left unanswered.

    That is the number of scenes, or less if `MOST_STEPS` did not suffice; called again with it as
    `first`, the search continues. `scenes` are the arrays (rows, starts, counts, arguments) of `Scenes`;
    `out` receives leaf (n,), densities (n, questions on a branch) and witnesses (n, n_variables);
    `boxes` are for scenes with more than `Boxes.fewest` objects.
    """
    rows, starts, counts, arguments = scenes
    leaf, densities, witnesses = out
    work.integers[PAUSE, STEPS] = MOST_STEPS
    for i in range(first, len(starts)):
        objects = rows[starts[i] : starts[i] + counts[i]]
        if boxes is not None and len(objects) > boxes.fewest:
            winner = query_scene(nodes, numbers, 0, matrix, objects, arguments[i], work, boxes)
        else:
            winner = query_scene(nodes, numbers, 0, matrix, objects, arguments[i], work)
        if winner == UNFINISHED:
            return i
        leaf[i] = winner
        for j in range(densities.shape[1]):
            densities[i, j] = math.exp(work.numbers[BEST_PATH, j])
        for j in range(witnesses.shape[1]):
            witnesses[i, j] = work.integers[WITNESSES, j]
    return len(starts)


@inlined
def row_at(rows: NDArray[np.int64], begin: int, place: int) -> int:
    """Return the row of the object at a place of the scene whose objects begin there; -1 = none."""
    return int(rows[begin + place]) if place >= 0 else -1


@kernel
def answer_tuples(
    nodes: NDArray[np.int64],
    numbers: NDArray[np.float64],
    scenes: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]],
    asked: tuple[NDArray[np.int64], NDArray[np.int64]],
    answers: NDArray[np.int8],
    present: NDArray[np.bool_],
) -> None:
    """Answer the question in the first of the packed `nodes` for tuples of objects.

    `scenes` are the arrays (rows, starts, matrix) of `Scenes`; `asked` says the scene (n,) of each tuple and
    the places (n, arity) of its objects, -1 = none. `answers` (n,) receives the answers, and what is true in
    `present` (3, n_scenes) after it which answers a scene has.
    """
    rows, starts, matrix = scenes
    scene, objects = asked
    point = np.empty((1, nodes[0, DIM]))
    arity = objects.shape[1]
    for i in range(len(scene)):
        begin = starts[scene[i]]
        found = (
            row_at(rows, begin, objects[i, 0]),
            row_at(rows, begin, objects[i, 1]) if arity > 1 else -1,
            row_at(rows, begin, objects[i, 2]) if arity > 2 else -1,
        )
        answers[i] = ask(nodes, 0, numbers, matrix, found, point, 0)[0]
        present[answers[i], scene[i]] = True
