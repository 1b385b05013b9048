"""The choices of objects for which compiled statements are true."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.forests.forms import FIRST, LIMIT, SECOND, value
from relforest.support.jit import inlined, kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Instead of a number of choices: one for every first of two free objects.
EVERY: Final = 0


class Table(NamedTuple):
    """The choices of a number of free variables, and what statements can be made of.

    `bounds` lists (form, column) of the half-lines, `categories` (form, column, category), `discs` (form,
    column, second column or -1). In each list those about all free variables come first, and `firsts` is
    their number: a condition begins with one of them. `scales` contains the standard deviation of each
    column. `least` and `order` are what a search needs at every node: the least value of each first half-line
    in every scene, infinite if there is none, and the scenes in the order of these values.
    """

    values: NDArray[np.float64]  # (n_columns, n_choices)
    starts: NDArray[np.int64]  # (n_scenes + 1,)
    bounds: NDArray[np.int64]  # (n, 2)
    categories: NDArray[np.int64]  # (n, 3)
    discs: NDArray[np.int64]  # (n, 3)
    firsts: NDArray[np.int64]  # (3,)
    scales: NDArray[np.float64]  # (n_columns,)
    least: NDArray[np.float64]  # (firsts[0], n_scenes)
    order: NDArray[np.int64]  # (firsts[0], n_scenes)


class Choices(NamedTuple):
    """The choices that are still possible: those of scene i are ``rows[starts[i]:starts[i + 1]]``."""

    rows: NDArray[np.int64]
    starts: NDArray[np.int64]


@inlined
def value_of(table: Table, choice: int, statement: NDArray[np.float64]) -> float:
    """The value of a statement, whose numbers are columns of the table, for one choice."""
    second = int(statement[SECOND])
    y = table.values[second, choice] if second >= 0 else 0.0
    return value(statement, table.values[int(statement[FIRST]), choice], y)


@kernel
def allow_all(table: Table, scenes: NDArray[np.int64], allowed: Choices) -> None:
    """Allow all choices of the scenes."""
    n = 0
    allowed.starts[0] = 0
    for i in range(len(scenes)):
        for choice in range(table.starts[scenes[i]], table.starts[scenes[i] + 1]):
            allowed.rows[n] = choice
            n += 1
        allowed.starts[i + 1] = n


@kernel
def restrict(table: Table, statement: NDArray[np.float64], allowed: Choices) -> None:
    """Disallow the choices for which a statement is false."""
    n, begin = 0, 0
    for i in range(len(allowed.starts) - 1):
        end = allowed.starts[i + 1]
        for place in range(begin, end):
            choice = allowed.rows[place]
            if value_of(table, choice, statement) <= statement[LIMIT]:
                allowed.rows[n] = choice
                n += 1
        begin = end
        allowed.starts[i + 1] = n


@inlined
def n_second_objects(n_choices: int) -> int:
    """How many choices of two objects begin with the same one, if there are n (n - 1) of n objects."""
    return int(math.sqrt(n_choices))


@kernel
def least_values(
    table: Table,
    scenes: NDArray[np.int64],
    allowed: Choices,
    statement: NDArray[np.float64],
    at_least: int,
    least: NDArray[np.float64],
) -> None:
    """Write each scene's `at_least`-th smallest value of the allowed choices, infinite if there are fewer.

    For `EVERY`, it is the largest of the smallest values of each first object.
    """
    if at_least == EVERY:
        _largest_of_least(table, scenes, allowed, statement, least)
        return
    smallest = np.empty(at_least)
    for i in range(len(scenes)):
        smallest[:] = np.inf
        for place in range(allowed.starts[i], allowed.starts[i + 1]):
            x = value_of(table, allowed.rows[place], statement)
            if x < smallest[at_least - 1]:
                rank = at_least - 1
                while rank > 0 and x < smallest[rank - 1]:
                    smallest[rank] = smallest[rank - 1]
                    rank -= 1
                smallest[rank] = x
        least[scenes[i]] = smallest[at_least - 1]


@kernel
def _largest_of_least(
    table: Table,
    scenes: NDArray[np.int64],
    allowed: Choices,
    statement: NDArray[np.float64],
    least: NDArray[np.float64],
) -> None:
    for i in range(len(scenes)):
        begin, end = table.starts[scenes[i]], table.starts[scenes[i] + 1]
        n_seconds, place = n_second_objects(end - begin), allowed.starts[i]
        largest = -np.inf if begin < end else np.inf
        for first in range(begin, end, max(n_seconds, 1)):
            nearest = np.inf
            while place < allowed.starts[i + 1] and allowed.rows[place] < first + n_seconds:
                x = value_of(table, allowed.rows[place], statement)
                if x < nearest:  # noqa: PLR1730 - min() may return NaN
                    nearest = x
                place += 1
            largest = max(largest, nearest)
        least[scenes[i]] = largest


@kernel
def holds(
    table: Table,
    scenes: NDArray[np.int64],
    statements: NDArray[np.float64],
    at_least: int,
    out: NDArray[np.bool_],
) -> None:
    """Write for which scenes so many choices, or `EVERY`, make all statements (n, N_NUMBERS) true."""
    for i in range(len(scenes)):
        begin, end = table.starts[scenes[i]], table.starts[scenes[i] + 1]
        size = n_second_objects(end - begin) if at_least == EVERY else end - begin
        needed = 1 if at_least == EVERY else at_least
        out[i] = begin < end
        for first in range(begin, end, max(size, 1)):
            n, choice = 0, first
            while n < needed and choice < first + size:
                is_true = True
                for j in range(len(statements)):
                    if not value_of(table, choice, statements[j]) <= statements[j, LIMIT]:
                        is_true = False
                        break
                n += is_true
                choice += 1
            out[i] &= n >= needed
