"""How far each scene is from a Yes to each question of a SMRF tree, and how many sequences are answered Yes.

The sequences that arrive at a question are gone through one by one, except for variables that only the
questions right after their instantiation ask about: it is enough to know which objects these may be bound
to. A chain of "is there a C ...? if not, is there a D ...?" then costs as much as each question alone.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.mappings.kernels import wrap_angle
from relforest.support.jit import kernel
from relforest.support.threads import in_threads
from relforest.trees import Question
from relforest.trees.kernels import ERROR, YES, ask
from relforest.trees.nodes import children
from relforest.trees.packing import CIRCULAR, DIM, VARIABLES, VOLUME

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.scenes import Scenes
    from relforest.scenes.arrays import FloatArray
    from relforest.trees import Tree

    _Columns = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]

# The ways to bind that many variables are counted at once; the time is exponential in the number.
_MOST_SPARE: Final = 6
# Instead of an object: any of those that a variable may be bound to.
_ANY: Final = -2


class Route(NamedTuple):
    """The questions on the way to a question, itself the last, and what their answers must be.

    A variable of which no later question asks has a number in `spare`.
    """

    asked: NDArray[np.int64]  # (n_asked, 3): node, variables bound there, answer
    spare: NDArray[np.int64]  # (n_variables,): -1 = not spare


class _Work(NamedTuple):
    """Space for one scene at a time."""

    bound: NDArray[np.int64]  # (n_variables,) object rows
    places: NDArray[np.int64]  # (n_variables,) their places in the scene, -1 = none yet
    options: NDArray[np.int64]  # (n_objects,) bits: the spare variables that may be bound to an object
    tally: NDArray[np.int64]  # (2^n_spare,) how many objects have these bits
    ways: NDArray[np.float64]  # (2^n_spare,)
    point: NDArray[np.float64]  # (1, d)


def question_measures(tree: Tree, scenes: Scenes, *, n_jobs: int = 1) -> tuple[FloatArray, FloatArray]:
    """Return margins and counts of all questions, two arrays (n, n_questions) in the order of the nodes.

    Time grows exponentially with the number of variables that later questions on a branch ask about again,
    memory does not. The call can be interrupted (Ctrl-C) at any time.

    Margins are the least distance from the volume's mean of any instantiation sequence that meets the
    question, less the volume's radius: at most 0 if one is answered Yes; NaN if the point of none is defined.
    Counts are how many sequences are answered Yes.
    """
    routes = _routes(tree)
    out = np.empty((2, len(scenes), len(routes)))
    packed = (tree.packed.nodes, tree.packed.numbers)
    width = max(scenes.schema.width, tree.packed.n_dims, 2)
    largest = int(scenes.counts.max(initial=0))

    def columns(part: slice) -> _Columns:
        return scenes.rows, scenes.starts[part], scenes.counts[part], scenes.arguments[part]

    def evaluate(begin: int, end: int, stop: NDArray[np.bool_]) -> None:
        for number, route in enumerate(routes):
            n, n_bits = len(route.spare), 1 << (int(route.spare.max()) + 1)
            work = _Work(
                np.empty(n, dtype=np.int64),
                np.empty(n, dtype=np.int64),
                np.empty(largest, dtype=np.int64),
                np.empty(n_bits, dtype=np.int64),
                np.empty(n_bits),
                np.empty((1, width)),
            )
            found = out[:, begin:end, number]
            _measure(packed, route, scenes.matrix, columns(slice(begin, end)), work, found, stop)

    in_threads(evaluate, len(scenes), n_jobs)
    return out[0], out[1]


def _routes(tree: Tree) -> list[Route]:
    """Return the route to each question of a tree."""
    above: dict[int, list[tuple[int, int, int]]] = {0: []}
    routes = []
    for index, node in enumerate(tree.nodes):
        so_far = above.pop(index)
        for answer, child in enumerate(children(node)):
            step = [(index, tree.n_bound[index], answer)] if isinstance(node, Question) else []
            above[child] = so_far + step
        if isinstance(node, Question):
            asked = [*so_far, (index, tree.n_bound[index], -1)]
            routes.append(Route(np.array(asked, dtype=np.int64), _spare(tree, asked)))
    return routes


def _spare(tree: Tree, asked: list[tuple[int, int, int]]) -> NDArray[np.int64]:
    n_bound = asked[-1][1]
    last = np.zeros(n_bound, dtype=np.int64)
    for index, bound, _ in asked:
        node = tree.nodes[index]
        if isinstance(node, Question):
            last[list(node.variables)] = bound
    spare = np.full(n_bound, -1, dtype=np.int64)
    free = np.arange(tree.schema.n_parameters, n_bound - 1)
    chosen = free[last[free] <= free + 1][:_MOST_SPARE]
    spare[chosen] = np.arange(len(chosen))
    return spare


@kernel
def _measure(
    tree: tuple[NDArray[np.int64], NDArray[np.float64]],
    route: Route,
    matrix: NDArray[np.float64],
    scenes: _Columns,
    work: _Work,
    out: NDArray[np.float64],
    stop: NDArray[np.bool_],
) -> None:
    """Write the margins and counts (2, n_scenes) of the last question of a route, until stopped."""
    rows, starts, counts, arguments = scenes
    n = len(route.spare)
    for i in range(len(starts)):
        objects = rows[starts[i] : starts[i] + counts[i]]
        least, count, depth = np.inf, 0.0, 0
        work.options[:] = 0
        work.places[:] = -1
        while depth >= 0 and not stop[0]:
            if depth < n:
                if _bind(tree, route, depth, (matrix, objects, arguments[i]), work):
                    depth += 1
                    continue
            else:
                n_ways = _n_ways(route, len(arguments[i]), work)
                if n_ways > 0.0:
                    margin, is_yes = _margin(tree, route.asked[-1, 0], matrix, work)
                    least = min(least, margin)
                    count += n_ways * is_yes
            # Try the next object for the variable before.
            if depth < n:
                work.places[depth] = -1
            depth -= 1
        out[0, i], out[1, i] = (least if least < np.inf else np.nan), count


@kernel
def _bind(
    tree: tuple[NDArray[np.int64], NDArray[np.float64]],
    route: Route,
    variable: int,
    scene: tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]],
    work: _Work,
) -> bool:
    """Bind a variable to its next object for which the questions have the answers of the route, if any."""
    matrix, objects, arguments = scene
    bound, spare = work.bound, route.spare[variable]
    place = work.places[variable] + 1
    work.places[variable] = place
    if variable < len(arguments) or _n_left(variable, objects, arguments) <= 0:
        bound[variable] = arguments[variable] if variable < len(arguments) else -1
        return place == 0 and _as_needed(tree, route, variable, matrix, work)
    if spare < 0:
        while place < len(objects):
            if not _is_bound(objects[place], bound, variable):
                bound[variable] = objects[place]
                if _as_needed(tree, route, variable, matrix, work):
                    work.places[variable] = place
                    return True
            place += 1
        return False
    n_options = 0
    work.tally[:] = 0
    for other in range(len(objects) if place == 0 else 0):
        work.options[other] &= ~(1 << spare)
        if not _is_bound(objects[other], bound, variable):
            bound[variable] = objects[other]
            if _as_needed(tree, route, variable, matrix, work):
                work.options[other] |= 1 << spare
                n_options += 1
        work.tally[work.options[other]] += 1
    bound[variable] = _ANY
    return n_options > 0


@kernel
def _n_left(variable: int, objects: NDArray[np.int64], arguments: NDArray[np.int64]) -> int:
    """How many objects are not yet in a sequence when a free variable is bound."""
    n = len(objects) - (variable - len(arguments))
    for row in objects:
        is_argument = False
        for argument in arguments:
            is_argument |= argument == row
        n -= is_argument
    return n


@kernel
def _is_bound(row: int, bound: NDArray[np.int64], n: int) -> bool:
    found = False
    for i in range(n):
        found |= bound[i] == row
    return found


@kernel
def _as_needed(
    tree: tuple[NDArray[np.int64], NDArray[np.float64]],
    route: Route,
    variable: int,
    matrix: NDArray[np.float64],
    work: _Work,
) -> bool:
    """Whether the questions that follow the instantiation of a variable have the answers of the route."""
    for i in range(len(route.asked) - 1):
        node, n_bound, needed = route.asked[i, 0], route.asked[i, 1], route.asked[i, 2]
        if n_bound == variable + 1 and _answer(tree, node, matrix, work) != needed:
            return False
    return True


@kernel
def _answer(
    tree: tuple[NDArray[np.int64], NDArray[np.float64]], node: int, matrix: NDArray[np.float64], work: _Work
) -> int:
    nodes, numbers = tree
    a, b, c = nodes[node, VARIABLES], nodes[node, VARIABLES + 1], nodes[node, VARIABLES + 2]
    objects = (work.bound[a], work.bound[b] if b >= 0 else -1, work.bound[c] if c >= 0 else -1)
    answer, _ = ask(nodes, node, numbers, matrix, objects, work.point, 0)
    return int(answer)


@kernel
def _margin(
    tree: tuple[NDArray[np.int64], NDArray[np.float64]], node: int, matrix: NDArray[np.float64], work: _Work
) -> tuple[float, bool]:
    """Return how far the point is beyond the volume, infinite if undefined, and whether it is inside."""
    nodes, numbers = tree
    answer = _answer(tree, node, matrix, work)
    if answer == ERROR:
        return np.inf, False
    at, dim = nodes[node, VOLUME], nodes[node, DIM]
    squared = 0.0
    for i in range(dim):
        for j in range(dim):
            a, b = work.point[0, i] - numbers[at + 2 + i], work.point[0, j] - numbers[at + 2 + j]
            if nodes[node, CIRCULAR] == 1:
                a = b = wrap_angle(a)
            squared += a * numbers[at + 2 + dim + i * dim + j] * b
    return math.sqrt(max(squared, 0.0)) - math.sqrt(numbers[at]), answer == YES


@kernel
def _n_ways(route: Route, n_arguments: int, work: _Work) -> float:
    """How many ways there are to bind the spare variables, the others being bound."""
    wanted, n_bits = 0, len(work.ways)
    for variable in range(n_arguments, len(route.spare)):
        if work.bound[variable] == _ANY:
            wanted |= 1 << route.spare[variable]
    if wanted == 0:
        return 1.0
    work.ways[:] = 0.0
    work.ways[0] = 1.0
    # Objects that may stand for the same variables are alike; those that others are bound to are missing.
    for options in range(1, n_bits):
        n_alike = work.tally[options]
        for variable in range(n_arguments, len(route.spare)):
            if work.bound[variable] >= 0 and work.options[work.places[variable]] == options:
                n_alike -= 1
        for filled in range(n_bits - 1, 0, -1):
            some = filled & options
            while some > 0:
                product, size, rest = work.ways[filled & ~some], 0, some
                while rest > 0:
                    product *= max(n_alike - size, 0)
                    size += 1
                    rest &= rest - 1
                work.ways[filled] += product
                some = (some - 1) & filled & options
    return float(work.ways[wanted])
