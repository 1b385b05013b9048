"""Compiled inner loops of reinforcement learning."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from relforest.support.jit import kernel
from relforest.trees.kernels import BEST_PATH, MOST_STEPS, PAUSE, STEPS, UNFINISHED, QueryWork, query_scene


@kernel
def segment_argmax(values: NDArray[np.float64], starts: NDArray[np.int64], out: NDArray[np.int64]) -> None:
    """Write to ``out[i]`` the position in `values` of the largest of segment i, or -1 if it is empty.

    Segment i is ``values[starts[i] : starts[i + 1]]``; the first of equal values wins.
    """
    for i in range(len(out)):
        best = -1
        for j in range(starts[i], starts[i + 1]):
            if best < 0 or values[j] > values[best]:
                best = j
        out[i] = best


class ForestArrays(NamedTuple):
    """The trees of one action type end to end, and the contributions of their leaves to the value."""

    nodes: NDArray[np.int64]  # packed nodes of all trees, links counted from the first tree's root
    numbers: NDArray[np.float64]  # volumes of all trees
    trees: NDArray[np.int64]  # (n_trees, 2): row of the root in `nodes`, row of the first leaf in `leaves`
    leaves: NDArray[np.int64]  # (n_leaves, 2): where the leaf's entries in `added` begin, number of densities
    added: NDArray[
        np.float64
    ]  # for each leaf a constant, then the weight of each density above it, root first
    bias: float
    sizes: tuple[int, int, int]  # of the buffers: variables, questions on a branch, dimensions


@kernel
def forest_values(
    forest: ForestArrays,
    matrix: NDArray[np.float64],
    objects: NDArray[np.int64],
    arguments: NDArray[np.int64],
    work: QueryWork,
    out: NDArray[np.float64],
    place: NDArray[np.int64],
) -> bool:
    """Write the value of each action of one type in one state to `out` (m,).

    Returns whether all values are complete. If not, `place` (2,), the action and tree to begin with, has
    advanced; called again with it, the computation continues.

    `matrix` (n_rows, width) holds the attribute values, `objects` (n_objects,) the rows of the objects that
    all actions share, and `arguments` (m, arity) the rows bound by each action, whether or not they are
    shared; `work` comes from `query_work` with the forest's sizes.
    """
    work.integers[PAUSE, STEPS] = MOST_STEPS
    for i in range(place[0], len(out)):
        value = forest.bias if place[1] == 0 else out[i]
        for tree in range(place[1], len(forest.trees)):
            root, first_leaf = forest.trees[tree]
            leaf = query_scene(forest.nodes, forest.numbers, root, matrix, objects, arguments[i], work)
            if leaf == UNFINISHED:
                out[i], place[0], place[1] = value, i, tree
                return False
            start, n_densities = forest.leaves[first_leaf + leaf]
            value += forest.added[start]
            for j in range(n_densities):
                value += forest.added[start + 1 + j] * math.exp(work.numbers[BEST_PATH, j])
        out[i], place[1] = value, 0
    return True


@kernel
def forest_rows(
    forest: ForestArrays,
    columns: NDArray[np.int64],
    matrix: NDArray[np.float64],
    objects: NDArray[np.int64],
    asked: tuple[NDArray[np.int64], NDArray[np.int64]],
    work: QueryWork,
    out: NDArray[np.float64],
    place: NDArray[np.int64],
) -> bool:
    """Write what the leaves that decide add, one by one, instead of the sum as in `forest_values`.

    Letters: m actions of one type. `asked` are their rows in `out` (m,) and their `arguments` (m, arity);
    `columns` (n_leaves,) is where in a row of `out` (n_actions, k), zeros at first, a leaf begins.
    """
    work.integers[PAUSE, STEPS] = MOST_STEPS
    rows, arguments = asked
    for i in range(place[0], len(rows)):
        for tree in range(place[1], len(forest.trees)):
            root, first_leaf = forest.trees[tree]
            leaf = query_scene(forest.nodes, forest.numbers, root, matrix, objects, arguments[i], work)
            if leaf == UNFINISHED:
                place[0], place[1] = i, tree
                return False
            start, n_densities = forest.leaves[first_leaf + leaf]
            column = columns[first_leaf + leaf]
            out[rows[i], column] = forest.added[start]
            for j in range(n_densities):
                out[rows[i], column + 1 + j] = forest.added[start + 1 + j] * math.exp(
                    work.numbers[BEST_PATH, j]
                )
        place[1] = 0
    return True
