"""Compiled search for the condition that separates scenes best."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from relforest.forests.forms import CENTRE, FIRST, FORM, IS, LIMIT, N_NUMBERS, SECOND, WEIGHT
from relforest.forests.rows import EVERY, Choices, Table, allow_all, least_values, restrict
from relforest.support.jit import inlined, kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Targets(NamedTuple):
    """First and second derivatives of the loss, one row per scene of the table."""

    gradients: NDArray[np.float64]  # (n_scenes, n_outputs)
    curvatures: NDArray[np.float64]  # (n_scenes, n_outputs)


class Plan(NamedTuple):
    """The `GrowthSettings` that the search at one node needs."""

    max_statements: int
    max_count: int
    n_discs: int
    min_scenes: int
    first_share: float
    share: float
    penalty: float  # lambda, added to the sum of curvatures
    pair_gain: float
    every: bool = False


class Search(NamedTuple):
    """Work space for n scenes of one table."""

    least: NDArray[np.float64]  # (n_scenes,) of the table: value of the choice that decides
    order: NDArray[np.int64]  # (n,) scenes by that value
    chosen: NDArray[np.bool_]  # (n_scenes,) whether a scene is one of the n
    inside: Choices  # all statements so far are true
    others: Choices  # all but one
    sums: NDArray[np.float64]  # (2, 2, n_outputs) of all scenes; of those inside


def work_space(table: Table, scenes: NDArray[np.int64], n_outputs: int) -> Search:
    """Return work space for the search among some scenes of a table."""
    n_scenes = len(table.starts) - 1
    chosen = np.zeros(n_scenes, dtype=np.bool_)
    chosen[scenes] = True
    n_choices = int((table.starts[scenes + 1] - table.starts[scenes]).sum())
    inside, others = (
        Choices(np.empty(n_choices, dtype=np.int64), np.empty(len(scenes) + 1, dtype=np.int64))
        for _ in range(2)
    )
    return Search(
        np.empty(n_scenes),
        np.empty(len(scenes), dtype=np.int64),
        chosen,
        inside,
        others,
        np.empty((2, 2, n_outputs)),
    )


@inlined
def _score(sums: NDArray[np.float64], row: int, penalty: float) -> float:
    """Twice the loss that the best constant takes away, over all outputs: sum G^2 / (H + lambda)."""
    total = 0.0
    for k in range(sums.shape[2]):
        total += sums[row, 0, k] * sums[row, 0, k] / (sums[row, 1, k] + penalty)
    return total


@kernel
def order_scenes(scenes: NDArray[np.int64], work: Search) -> None:
    """Write the scenes in the order of their least values; the infinite ones are not sorted."""
    n, last = 0, len(scenes)
    for i in range(len(scenes)):
        if work.least[scenes[i]] < np.inf:
            work.order[n] = scenes[i]
            n += 1
        else:
            last -= 1
            work.order[last] = scenes[i]
    finite = work.order[:n].copy()
    by_value = np.argsort(work.least[finite])
    for rank in range(n):
        work.order[rank] = finite[by_value[rank]]


@kernel
def _recall(table: Table, half_line: int, work: Search) -> None:
    """Write the least values of a first half-line, and the scenes in their order."""
    n = 0
    for rank in range(table.order.shape[1]):
        scene = table.order[half_line, rank]
        if work.chosen[scene]:
            work.order[n] = scene
            work.least[scene] = table.least[half_line, scene]
            n += 1


@kernel
def best_limit(
    scenes: NDArray[np.int64], targets: Targets, is_category: bool, plan: Plan, work: Search
) -> tuple[float, float]:
    """Return the gain of the best limit for ``work.least``, and the limit; gain 0 if there is none.

    ``work.order`` contains the scenes in the order of these values. The limit lies midway between two.
    """
    least, order, sums = work.least, work.order, work.sums
    n, n_outputs = len(scenes), sums.shape[2]
    sums[0] = 0.0
    for i in range(n):
        for k in range(n_outputs):
            sums[0, 0, k] += targets.gradients[scenes[i], k]
            sums[0, 1, k] += targets.curvatures[scenes[i], k]
    base = _score(sums, 0, plan.penalty)
    best, limit = 0.0, 0.0
    sums[1] = 0.0
    for rank in range(n - plan.min_scenes):
        i = order[rank]
        # A category is right (0) or wrong (1).
        if least[i] == np.inf or (is_category and least[i] > 0.5):
            break
        for k in range(n_outputs):
            sums[1, 0, k] += targets.gradients[i, k]
            sums[1, 1, k] += targets.curvatures[i, k]
        following = least[order[rank + 1]]
        if following == least[i] or rank + 1 < plan.min_scenes:
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
def _try(
    table: Table,
    scenes: NDArray[np.int64],
    targets: Targets,
    trial: NDArray[np.float64],
    best: NDArray[np.float64],
    state: tuple[float, int, int],
    plan: Plan,
    work: Search,
) -> float:
    """Keep the trial statement as the best if its best limit gains more; return the larger gain.

    `state` contains the gain so far, how many choices are counted, and the number of a first half-line whose
    least values are known, or -1.
    """
    gain, at_least, half_line = state
    if half_line >= 0:
        _recall(table, half_line, work)
    else:
        least_values(table, scenes, work.inside, trial, at_least, work.least)
        order_scenes(scenes, work)
    found, limit = best_limit(scenes, targets, trial[FORM] >= IS, plan, work)
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
    allowed: Choices,
    disc: tuple[int, int],
    rng: np.random.Generator,
) -> int:
    """Return a random allowed choice of a scene whose gradient has a random sign, -1 if none is found."""
    sign = 1.0 if rng.random() < 0.5 else -1.0
    output = int(rng.random() * targets.gradients.shape[1])
    for _ in range(30):
        i = int(rng.random() * len(scenes))
        n = allowed.starts[i + 1] - allowed.starts[i]
        if n == 0 or targets.gradients[scenes[i], output] * sign <= 0.0:
            continue
        choice = allowed.rows[allowed.starts[i] + int(rng.random() * n)]
        defined = not math.isnan(table.values[disc[0], choice])
        if disc[1] >= 0:
            defined &= not math.isnan(table.values[disc[1], choice])
        if defined:
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
            trial[FORM], trial[FIRST] = table.bounds[i, 0], table.bounds[i, 1]
            # Looking up is linear in all scenes of the table.
            known = n_before == 0 and at_least == 1 and len(table.starts) < 16 * len(scenes)
            gain = _try(table, scenes, targets, trial, best, (gain, at_least, i if known else -1), plan, work)
    for i in range(n_categories):
        # There are few of them, and they decide which objects the others are about.
        if rng.random() < max(plan.share, 0.5):
            trial[FORM], trial[FIRST], trial[CENTRE] = table.categories[i]
            gain = _try(table, scenes, targets, trial, best, (gain, at_least, -1), plan, work)
    for _ in range(plan.n_discs if n_discs else 0):
        form, first, second = table.discs[int(rng.random() * n_discs)]
        choice = _centre(table, scenes, targets, work.inside, (first, second), rng)
        radius = table.scales[first] * math.exp(0.5 * rng.standard_normal())
        other = table.scales[second] * math.exp(0.5 * rng.standard_normal()) if second >= 0 else 1.0
        if choice >= 0:
            trial[FORM], trial[FIRST], trial[SECOND] = form, first, second
            trial[CENTRE], trial[WEIGHT] = table.values[first, choice], 1.0 / radius**2
            trial[CENTRE + 1] = table.values[second, choice] if second >= 0 else 0.0
            trial[WEIGHT + 1] = 1.0 / other**2
            gain = _try(table, scenes, targets, trial, best, (gain, at_least, -1), plan, work)
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
    category: int,
) -> tuple[float, int, int]:
    """Write the statements of a good condition; return its gain, their number, and how many it counts.

    Statements are added greedily while the gain grows; after each, the limits of the earlier ones are chosen
    again. The gain is twice the decrease of the loss by one Newton step on either side. With the number of a
    `category`, -1 for none, only objects of this category, or related like this, are looked for: that there
    is one rarely tells anything, so that a greedy search would not begin with it.
    """
    at_least = 1
    if plan.max_count > 1 and rng.random() < 0.4:
        at_least = 1 + int(rng.random() * plan.max_count)
    if plan.every and rng.random() < 0.4:
        at_least = EVERY
    gain, n = 0.0, 0
    allow_all(table, scenes, work.inside)
    if category >= 0:
        statements[0, FORM], statements[0, FIRST], statements[0, CENTRE] = table.categories[category]
        statements[0, SECOND], statements[0, LIMIT] = -1.0, 0.5
        restrict(table, statements[0], work.inside)
        n = 1
    while n < plan.max_statements:
        found = _best_statement(table, scenes, targets, plan, (n, at_least), rng, statements[n], work)
        if found <= gain:
            break
        gain, n = found, n + 1
        for changed in range(n - 1):
            if statements[changed, FORM] >= IS:
                continue
            allow_all(table, scenes, work.others)
            for other in range(n):
                if other != changed:
                    restrict(table, statements[other], work.others)
            least_values(table, scenes, work.others, statements[changed], at_least, work.least)
            order_scenes(scenes, work)
            found, limit = best_limit(scenes, targets, statements[changed, FORM] >= IS, plan, work)
            if found > gain:
                gain = found
                statements[changed, LIMIT] = limit
        allow_all(table, scenes, work.inside)
        for each in range(n):
            restrict(table, statements[each], work.inside)
    return gain, n, at_least
