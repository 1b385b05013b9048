"""Compiled answering of trees: one scene at a time, depth first, without allocation."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.mappings.kernels import map_point, wrap_angle
from relforest.support.jit import kernel
from relforest.trees.packing import (
    ATTRIBUTE_DIM,
    CHILDREN,
    CIRCULAR,
    DIM,
    FIRST,
    INSTANTIATION,
    KIND,
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
_CURSOR: Final = 4

_PATH: Final = 0
BEST_PATH: Final = 1
_TOTAL: Final = 2
_POINT: Final = 3


class QueryWork(NamedTuple):
    """Buffers and results of `query_scene`.

    Results: ``integers[WITNESSES]``, the object rows of the most representative sequence (-1 = none),
    and ``numbers[BEST_PATH]``, the logarithm of its density at each question on its branch, root
    first (-inf = error, and beyond the branch).
    """

    integers: NDArray[np.int64]  # (5, n_variables)
    numbers: NDArray[np.float64]  # (4, max(questions on a branch, n_variables, n_dims))


def query_work(n_variables: int, n_asked: int, n_dims: int) -> QueryWork:
    """Buffers large enough for trees of these sizes."""
    return QueryWork(
        np.full((5, max(n_variables, 1)), -1, dtype=np.int64),
        np.zeros((4, max(n_asked, n_variables, n_dims, 1))),
    )


@kernel
def ask(
    node: NDArray[np.int64],
    numbers: NDArray[np.float64],
    matrix: NDArray[np.float64],
    objects: tuple[int, int, int],
    point: NDArray[np.float64],
) -> tuple[int, float]:
    """Answer one question for one tuple of object rows: (answer, log density relative to the peak)."""
    circular = node[CIRCULAR] == 1
    span = (node[FIRST], node[ATTRIBUTE_DIM])
    if not map_point(node[OPERATION], circular, span, matrix, objects, point):
        return ERROR, -np.inf
    at, dim = node[VOLUME], node[DIM]
    if circular:
        offset = wrap_angle(point[0] - numbers[at + 2])
        answer = YES if offset * offset <= numbers[at] else NO
        return answer, numbers[at + 1] * (math.cos(offset) - 1.0)
    mean, precision = at + 2, at + 2 + dim
    squared = 0.0
    for i in range(dim):
        offset = point[i] - numbers[mean + i]
        row = precision + i * dim
        product = 0.0
        for j in range(dim):
            product += numbers[row + j] * (point[j] - numbers[mean + j])
        squared += offset * product
    answer = YES if squared <= numbers[at] else NO
    return answer, -0.5 * numbers[at + 1] * squared


@kernel
def query_scene(
    nodes: NDArray[np.int64],
    numbers: NDArray[np.float64],
    root: int,
    matrix: NDArray[np.float64],
    objects: NDArray[np.int64],
    arguments: NDArray[np.int64],
    work: QueryWork,
) -> int:
    """Ordinal of the leaf that decides a scene; see `QueryWork` for what else is found.

    Of all instantiation sequences those in the most probable leaf count, and of these the one with
    the largest product of densities (sections 4.1 and 6.4). Branches that cannot reach a leaf as
    probable as the best so far are skipped.

    Parameters
    ----------
    nodes, numbers
        One or several packed trees, end to end.
    root : int
        Row of `nodes` to begin at.
    matrix : ndarray (n_rows, width)
        Attribute values of all objects.
    objects : int64 ndarray (n_objects,)
        Rows of the scene's objects.
    arguments : int64 ndarray (k,)
        Rows of the objects bound to action arguments, -1 = none.
    work : QueryWork
        Buffers from `query_work`.
    """
    state, floats = work.integers, work.numbers
    bound = state[BOUND]
    winner, best_rank, best_total = -1, nodes.shape[0], -np.inf
    node, depth, asked, total = root, 0, 0, 0.0
    while True:
        kind = nodes[node, KIND]
        if kind == QUESTION:
            row = nodes[node]
            a, b, c = row[VARIABLES], row[VARIABLES + 1], row[VARIABLES + 2]
            bound_objects = (bound[a], bound[b] if b >= 0 else -1, bound[c] if c >= 0 else -1)
            answer, density = ask(row, numbers, matrix, bound_objects, floats[_POINT])
            floats[_PATH, asked] = density
            if answer != ERROR:
                total += density
            asked += 1
            node = row[CHILDREN + answer]
            if nodes[node, RANK] <= best_rank:
                continue
        elif kind == INSTANTIATION:
            state[_NODE, depth], state[_ASKED, depth], state[_CURSOR, depth] = node, asked, -1
            floats[_TOTAL, depth] = total
            depth += 1
        elif nodes[node, RANK] < best_rank or total > best_total:
            best_rank, best_total = nodes[node, RANK], total
            winner = nodes[node, ORDINAL]
            for i in range(floats.shape[1]):
                floats[BEST_PATH, i] = floats[_PATH, i] if i < asked else -np.inf
            for i in range(len(bound)):
                state[WITNESSES, i] = bound[i] if i < depth else -1
        # Go on with the next object of the innermost variable that has one left.
        while depth > 0:
            above = state[_NODE, depth - 1]
            if nodes[above, RANK] <= best_rank and _bind_next(depth - 1, state, objects, arguments):
                node, asked = nodes[above, CHILDREN], state[_ASKED, depth - 1]
                total = floats[_TOTAL, depth - 1]
                break
            depth -= 1
        if depth == 0:
            return winner


@kernel
def _bind_next(
    variable: int, state: NDArray[np.int64], objects: NDArray[np.int64], arguments: NDArray[np.int64]
) -> bool:
    """Bind the variable to its next object; False when there is none left.

    The first variables belong to the action's arguments. Later ones go through all objects not yet
    in the sequence. If there is none at all, the variable is bound to "no object" once.
    """
    place = state[_CURSOR, variable]
    if variable < len(arguments):
        state[BOUND, variable] = arguments[variable]
        state[_CURSOR, variable] = 0
        return bool(place < 0)
    never_bound = bool(place < 0)
    for i in range(place + 1, len(objects)):
        candidate = objects[i]
        repeated = False
        for earlier in range(variable):
            repeated |= state[BOUND, earlier] == candidate
        if not repeated:
            state[BOUND, variable] = candidate
            state[_CURSOR, variable] = i
            return True
    state[BOUND, variable] = -1
    state[_CURSOR, variable] = len(objects)
    return never_bound


@kernel
def query_batch(
    nodes: NDArray[np.int64],
    numbers: NDArray[np.float64],
    matrix: NDArray[np.float64],
    scenes: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]],
    work: QueryWork,
    out: tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.int64]],
) -> None:
    """Query every scene of a batch.

    `scenes` are the arrays (rows, starts, counts, arguments) of `Scenes`; `out` receives leaf (n,),
    densities (n, questions on a branch) and witnesses (n, n_variables).
    """
    rows, starts, counts, arguments = scenes
    leaf, densities, witnesses = out
    for i in range(len(starts)):
        objects = rows[starts[i] : starts[i] + counts[i]]
        leaf[i] = query_scene(nodes, numbers, 0, matrix, objects, arguments[i], work)
        for j in range(densities.shape[1]):
            densities[i, j] = math.exp(work.numbers[BEST_PATH, j])
        for j in range(witnesses.shape[1]):
            witnesses[i, j] = work.integers[WITNESSES, j]


@kernel
def answer_tuples(
    node: NDArray[np.int64],
    numbers: NDArray[np.float64],
    matrix: NDArray[np.float64],
    rows: NDArray[np.int64],
    answers: NDArray[np.int8],
) -> None:
    """Answer one packed question for each tuple of object rows (n, arity)."""
    point = np.empty(max(node[DIM], 1))
    arity = rows.shape[1]
    for i in range(len(rows)):
        objects = (rows[i, 0], rows[i, 1] if arity > 1 else -1, rows[i, 2] if arity > 2 else -1)
        answers[i] = ask(node, numbers, matrix, objects, point)[0]
