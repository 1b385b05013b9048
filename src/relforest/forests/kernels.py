"""Compiled search for the condition that separates scenes best."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.support.jit import inlined, kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

# A statement as a row of numbers, by these columns. It is true where its value is at most the limit.
KIND: Final = 0
FIRST: Final = 1  # column of the table
SECOND: Final = 2  # another column, -1 = none
CENTRE: Final = 3  # two numbers
WEIGHT: Final = 5  # two numbers, 1 / radius^2
LIMIT: Final = 7
N_NUMBERS: Final = 8

AT_MOST: Final = 0
AT_LEAST: Final = 1
SMALL: Final = 2  # the absolute value is at most ...
LARGE: Final = 3
NEAR: Final = 4
NEAR_ANGLE: Final = 5
IS: Final = 6
IS_NOT: Final = 7

# Instead of a number of choices: one for every first of two free objects.
EVERY: Final = 0

_TURN: Final = 2.0 * math.pi


class Table(NamedTuple):
    """The choices of a number of free variables, and what statements can be made of.

    `bounds` lists (kind, column) of the half-lines, `categories` (kind, column, category), `discs` (kind,
    column, second column or -1). In each list those about all free variables come first, and `firsts` is
    their number: a condition begins with one of them. `scales` contains the standard deviation of each
    column.
    """

    values: NDArray[np.float64]  # (n_columns, n_choices)
    starts: NDArray[np.int64]  # (n_scenes + 1,)
    bounds: NDArray[np.int64]  # (n, 2)
    categories: NDArray[np.int64]  # (n, 3)
    discs: NDArray[np.int64]  # (n, 3)
    firsts: NDArray[np.int64]  # (3,)
    scales: NDArray[np.float64]  # (n_columns,)


class Targets(NamedTuple):
    """First and second derivatives of the loss, one row per scene of the table."""

    gradients: NDArray[np.float64]  # (n_scenes, n_outputs)
    curvatures: NDArray[np.float64]  # (n_scenes, n_outputs)


class Plan(NamedTuple):
    """How much is tried at one node; see `GrowthSettings`."""

    most_statements: int
    most_counted: int
    n_discs: int
    least_scenes: int
    first_share: float
    share: float
    penalty: float  # lambda, added to the sum of curvatures
    every: bool = False


class Search(NamedTuple):
    """Work space for n scenes and one table."""

    least: NDArray[np.float64]  # (n,) value of the choice that decides
    inside: NDArray[np.bool_]  # (n_choices,) all statements so far are true
    others: NDArray[np.bool_]  # (n_choices,) all but one
    sums: NDArray[np.float64]  # (2, 2, n_outputs) of all scenes; of those inside


@inlined
def value(values: NDArray[np.float64], choice: int, statement: NDArray[np.float64]) -> float:
    """The value of a statement for one choice; NaN where undefined."""
    kind = int(statement[KIND])
    x = values[int(statement[FIRST]), choice]
    result = x
    if kind == AT_LEAST:
        result = -x
    elif kind == SMALL:
        result = abs(x)
    elif kind == LARGE:
        result = -abs(x)
    elif kind == NEAR_ANGLE:
        away = x - statement[CENTRE]
        away -= _TURN * np.rint(away / _TURN)
        result = statement[WEIGHT] * away * away
    elif kind == NEAR:
        away = x - statement[CENTRE]
        result = statement[WEIGHT] * away * away
        if statement[SECOND] >= 0.0:
            away = values[int(statement[SECOND]), choice] - statement[CENTRE + 1]
            result += statement[WEIGHT + 1] * away * away
    elif kind >= IS:
        same = x == statement[CENTRE]
        result = np.nan if math.isnan(x) else (0.0 if same == (kind == IS) else 1.0)
    return float(result)


@inlined
def n_second_objects(n_choices: int) -> int:
    """How many choices of two objects begin with the same one, if there are n (n - 1) of n objects."""
    return int(math.sqrt(n_choices))


@kernel
def least_values(
    table: Table,
    scenes: NDArray[np.int64],
    allowed: NDArray[np.bool_],
    statement: NDArray[np.float64],
    at_least: int,
    least: NDArray[np.float64],
) -> None:
    """Write each scene's `at_least`-th smallest value of the allowed choices, infinite if there are fewer.

    For `EVERY`, it is the largest of the smallest values of each first object.
    """
    if at_least == EVERY:
        for i in range(len(scenes)):
            begin, end = table.starts[scenes[i]], table.starts[scenes[i] + 1]
            n_seconds = n_second_objects(end - begin)
            least[i] = -np.inf if begin < end else np.inf
            for first in range(begin, end, max(n_seconds, 1)):
                nearest = np.inf
                for choice in range(first, first + n_seconds):
                    if allowed[choice]:
                        x = value(table.values, choice, statement)
                        if x < nearest:  # noqa: PLR1730 - min() may return NaN
                            nearest = x
                least[i] = max(least[i], nearest)
        return
    smallest = np.empty(at_least)
    for i in range(len(scenes)):
        smallest[:] = np.inf
        for choice in range(table.starts[scenes[i]], table.starts[scenes[i] + 1]):
            if allowed[choice]:
                x = value(table.values, choice, statement)
                if x < smallest[at_least - 1]:
                    place = at_least - 1
                    while place > 0 and x < smallest[place - 1]:
                        smallest[place] = smallest[place - 1]
                        place -= 1
                    smallest[place] = x
        least[i] = smallest[at_least - 1]


@inlined
def _score(sums: NDArray[np.float64], row: int, penalty: float) -> float:
    """Twice the loss that the best constant takes away, over all outputs: sum G^2 / (H + lambda)."""
    total = 0.0
    for k in range(sums.shape[2]):
        total += sums[row, 0, k] * sums[row, 0, k] / (sums[row, 1, k] + penalty)
    return total


@kernel
def best_limit(
    scenes: NDArray[np.int64], targets: Targets, is_category: bool, plan: Plan, work: Search
) -> tuple[float, float]:
    """Return the gain of the best limit for ``work.least``, and the limit; gain 0 if there is none.

    The limit lies midway between two values.
    """
    least, sums = work.least, work.sums
    n, n_outputs = len(scenes), sums.shape[2]
    sums[0] = 0.0
    for i in range(n):
        for k in range(n_outputs):
            sums[0, 0, k] += targets.gradients[scenes[i], k]
            sums[0, 1, k] += targets.curvatures[scenes[i], k]
    base = _score(sums, 0, plan.penalty)
    best, limit = 0.0, 0.0
    sums[1] = 0.0
    order = np.argsort(least)
    for rank in range(n - plan.least_scenes):
        i = order[rank]
        # A category is right (0) or wrong (1).
        if least[i] == np.inf or (is_category and least[i] > 0.5):
            break
        for k in range(n_outputs):
            sums[1, 0, k] += targets.gradients[scenes[i], k]
            sums[1, 1, k] += targets.curvatures[scenes[i], k]
        following = least[order[rank + 1]]
        if following == least[i] or rank + 1 < plan.least_scenes:
            continue
        gain = _score(sums, 1, plan.penalty) - base
        for k in range(n_outputs):
            g = sums[0, 0, k] - sums[1, 0, k]
            gain += g * g / (sums[0, 1, k] - sums[1, 1, k] + plan.penalty)
        if gain > best:
            best = gain
            if is_category:
                limit = 0.5
            elif following < np.inf:
                limit = 0.5 * (least[i] + following)
            else:
                limit = least[i] + 1e-9 * (1.0 + abs(least[i]))
    return best, limit


@kernel
def _restrict(
    table: Table, scenes: NDArray[np.int64], statement: NDArray[np.float64], allowed: NDArray[np.bool_]
) -> None:
    """Disallow the choices for which a statement is false."""
    for i in range(len(scenes)):
        for choice in range(table.starts[scenes[i]], table.starts[scenes[i] + 1]):
            if allowed[choice]:
                allowed[choice] = value(table.values, choice, statement) <= statement[LIMIT]


@kernel
def _allow_all(table: Table, scenes: NDArray[np.int64], allowed: NDArray[np.bool_]) -> None:
    for i in range(len(scenes)):
        allowed[table.starts[scenes[i]] : table.starts[scenes[i] + 1]] = True


@kernel
def _try(
    table: Table,
    scenes: NDArray[np.int64],
    targets: Targets,
    trial: NDArray[np.float64],
    best: NDArray[np.float64],
    state: tuple[float, int],
    plan: Plan,
    work: Search,
) -> float:
    """Keep the trial statement as the best if its best limit gains more; return the larger gain."""
    gain, at_least = state
    least_values(table, scenes, work.inside, trial, at_least, work.least)
    found, limit = best_limit(scenes, targets, trial[KIND] >= IS, plan, work)
    if found > gain:
        best[:] = trial
        best[LIMIT] = limit
        return found
    return gain


@kernel
def _centre(
    table: Table,
    scenes: NDArray[np.int64],
    targets: Targets,
    inside: NDArray[np.bool_],
    disc: tuple[int, int],
    rng: np.random.Generator,
) -> int:
    """Return a random allowed choice of a scene whose gradient has a random sign, -1 if none is found."""
    sign = 1.0 if rng.random() < 0.5 else -1.0
    output = int(rng.random() * targets.gradients.shape[1])
    for _ in range(30):
        scene = scenes[int(rng.random() * len(scenes))]
        n = table.starts[scene + 1] - table.starts[scene]
        if n == 0 or targets.gradients[scene, output] * sign <= 0.0:
            continue
        choice = table.starts[scene] + int(rng.random() * n)
        defined = not math.isnan(table.values[disc[0], choice])
        if disc[1] >= 0:
            defined &= not math.isnan(table.values[disc[1], choice])
        if inside[choice] and defined:
            return int(choice)
    return -1


@kernel
def _best_statement(
    table: Table,
    scenes: NDArray[np.int64],
    targets: Targets,
    plan: Plan,
    order: tuple[int, int],
    rng: np.random.Generator,
    best: NDArray[np.float64],
    work: Search,
) -> float:
    """Write the best of a random selection of statements about the allowed choices; return its gain.

    `order` contains how many statements there are already, and how many choices are counted.
    """
    n_before, at_least = order
    trial = np.zeros(N_NUMBERS)
    gain = 0.0
    trial[SECOND] = -1.0
    n_bounds, n_categories, n_discs = len(table.bounds), len(table.categories), len(table.discs)
    if n_before == 0:
        n_bounds, n_categories, n_discs = table.firsts
    for i in range(n_bounds):
        if rng.random() < (plan.share if n_before else plan.first_share):
            trial[KIND], trial[FIRST] = table.bounds[i, 0], table.bounds[i, 1]
            gain = _try(table, scenes, targets, trial, best, (gain, at_least), plan, work)
    for i in range(n_categories):
        # There are few of them, and they decide which objects the others are about.
        if rng.random() < max(plan.share, 0.5):
            trial[KIND], trial[FIRST], trial[CENTRE] = table.categories[i]
            gain = _try(table, scenes, targets, trial, best, (gain, at_least), plan, work)
    for _ in range(plan.n_discs if n_discs else 0):
        kind, first, second = table.discs[int(rng.random() * n_discs)]
        choice = _centre(table, scenes, targets, work.inside, (first, second), rng)
        radius = table.scales[first] * math.exp(0.5 * rng.standard_normal())
        other = table.scales[second] * math.exp(0.5 * rng.standard_normal()) if second >= 0 else 1.0
        if choice >= 0:
            trial[KIND], trial[FIRST], trial[SECOND] = kind, first, second
            trial[CENTRE], trial[WEIGHT] = table.values[first, choice], 1.0 / radius**2
            trial[CENTRE + 1] = table.values[second, choice] if second >= 0 else 0.0
            trial[WEIGHT + 1] = 1.0 / other**2
            gain = _try(table, scenes, targets, trial, best, (gain, at_least), plan, work)
    return gain


@kernel
def best_condition(
    table: Table,
    scenes: NDArray[np.int64],
    targets: Targets,
    plan: Plan,
    rng: np.random.Generator,
    statements: NDArray[np.float64],
    work: Search,
) -> tuple[float, int, int]:
    """Write the statements of a good condition; return its gain, their number, and how many it counts.

    Statements are added greedily while the gain grows; after each, the limits of the earlier ones are chosen
    again. The gain is twice the decrease of the loss by one Newton step on either side.
    """
    at_least = 1
    if plan.most_counted > 1 and rng.random() < 0.4:
        at_least = 1 + int(rng.random() * plan.most_counted)
    if plan.every and rng.random() < 0.4:
        at_least = EVERY
    gain, n = 0.0, 0
    _allow_all(table, scenes, work.inside)
    while n < plan.most_statements:
        found = _best_statement(table, scenes, targets, plan, (n, at_least), rng, statements[n], work)
        if found <= gain:
            break
        gain, n = found, n + 1
        for changed in range(n - 1):
            if statements[changed, KIND] >= IS:
                continue
            _allow_all(table, scenes, work.others)
            for other in range(n):
                if other != changed:
                    _restrict(table, scenes, statements[other], work.others)
            least_values(table, scenes, work.others, statements[changed], at_least, work.least)
            found, limit = best_limit(scenes, targets, statements[changed, KIND] >= IS, plan, work)
            if found > gain:
                gain = found
                statements[changed, LIMIT] = limit
        _allow_all(table, scenes, work.inside)
        for each in range(n):
            _restrict(table, scenes, statements[each], work.inside)
    return gain, n, at_least


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
                    if not value(table.values, choice, statements[j]) <= statements[j, LIMIT]:
                        is_true = False
                        break
                n += is_true
                choice += 1
            out[i] &= n >= needed
