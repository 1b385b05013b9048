"""The compiled loop of covariant aggregation (Algorithm 3.1, section 3.2.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from relforest.support.jit import inlined, kernel
from relforest.volumes.bag_layout import Instances, SlotMajor, slot_major
from relforest.volumes.cuts import Buckets, best_cut, best_weighted_cut, new_buckets, radius_at
from relforest.volumes.low_rank import low_rank_distances, low_rank_nearest
from relforest.volumes.models import (
    BEST,
    CHOSEN,
    COUNT,
    CURRENT,
    EDGE,
    SCORE,
    TRIAL,
    Models,
    add_key,
    copy_model,
    low_rank,
    new_models,
)
from relforest.volumes.witnesses import n_instances, nearest_instance, witness_distances

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Problem(NamedTuple):
    """What stays the same during one aggregation."""

    space: int
    objective: int
    prior: NDArray[np.float64]  # (d, d) w ncov(P) / p of eq. 3.5
    max_condition: float
    table: NDArray[np.float64]  # (n_bags + 1,) `entropy_table`
    plan: tuple[int, int, int]  # A, N, M


class Found(NamedTuple):
    """The best model; little of it, since every array that leaves compiled code costs a microsecond."""

    score: float
    n_keys: int
    total: NDArray[np.float64]  # (d,) sum of the keys; on the circle (2,), of cosines and sines
    centre: NDArray[np.float64]  # (d,)
    scatter: NDArray[np.float64]  # (d, d) ncov of eq. 3.4
    radius: float
    n_models: int  # tried


class Dice(NamedTuple):
    """Prepared uniform numbers and how many of them are used up."""

    draws: NDArray[np.float64]
    used: NDArray[np.int64]  # (1,)


@kernel
def aggregate_keys(instances: Instances, problem: Problem, draws: NDArray[np.float64]) -> Found:
    """Run all restarts with uniform numbers as needed, at most 1 + M p for each, with p positive bags."""
    bags, positives = slot_major(instances)
    models = new_models(problem.space, bags.points.shape[0], len(bags.weights))
    buckets = new_buckets(len(bags.weights))
    dice = Dice(draws, np.zeros(1, dtype=np.int64))
    history = np.empty(len(positives))
    pools = np.empty((2, len(positives)), dtype=np.int64)
    starts = positives.copy()
    window, restarts, _ = problem.plan
    radius, n_models = -1.0, 0
    for restart in range(min(restarts, len(starts))):
        swap = restart + draw_below(len(starts) - restart, dice)
        starts[restart], starts[swap] = starts[swap], starts[restart]
        n_models += _start(bags, starts[restart], problem, models, buckets)
        if models.numbers[CURRENT, SCORE] == -np.inf:
            continue
        pools[0] = positives
        n_remaining = _without(pools[0], len(positives), starts[restart])
        steps = 0
        history[0] = models.numbers[CURRENT, SCORE]
        radius = _consider(models, radius)
        while True:
            added, tried = _step(bags, problem, (pools, n_remaining), dice, models, buckets)
            n_models += tried
            if added < 0:
                break
            n_remaining = _without(pools[0], n_remaining, added)
            steps += 1
            history[steps] = models.numbers[CURRENT, SCORE]
            radius = _consider(models, radius)
            recent = history[max(0, steps + 1 - window) : steps + 1]
            if steps >= window and not has_prospects(recent, n_remaining, models.numbers[BEST, SCORE]):
                break
    return found_best(models, radius, n_models)


@kernel
def found_best(models: Models, radius: float, n_models: int) -> Found:
    """Return what row `BEST` holds."""
    return Found(
        models.numbers[BEST, SCORE],
        int(models.numbers[BEST, COUNT]),
        models.sums[BEST].copy(),
        models.centres[BEST].copy(),
        models.scatters[BEST].copy(),
        radius,
        n_models,
    )


@kernel
def has_prospects(recent: NDArray[np.float64], n_remaining: int, best: float) -> bool:
    """Whether the trend of the recent scores, continued to the last bag, would beat the best score."""
    middle = 0.5 * (len(recent) - 1)
    mean = recent.mean()
    covariance, variance = 0.0, 0.0
    for i in range(len(recent)):
        covariance += (i - middle) * (recent[i] - mean)
        variance += (i - middle) ** 2
    slope = covariance / variance
    # Rounding gives a constant history a slope of about 1e-17, and a trend that ends exactly at the best
    # score may seem to end above it; neither must count as progress.
    return slope > 1e-9 and mean + slope * (middle + n_remaining) > best + 1e-9


@kernel
def _start(bags: SlotMajor, bag: int, problem: Problem, models: Models, buckets: Buckets) -> int:
    """Make `CURRENT` the best model with one instance of `bag` as its only key point."""
    models.numbers[CURRENT, SCORE] = -np.inf
    size = n_instances(bags, bag)
    for slot in range(size):
        floor = models.numbers[CURRENT, SCORE]
        _try(bags, problem, (-1, bags.offsets[slot] + bag), floor, models, buckets)
        if models.numbers[TRIAL, SCORE] > models.numbers[CURRENT, SCORE]:
            copy_model(models, TRIAL, CURRENT)
    return size


@kernel
def _step(
    bags: SlotMajor,
    problem: Problem,
    remaining: tuple[NDArray[np.int64], int],
    dice: Dice,
    models: Models,
    buckets: Buckets,
) -> tuple[int, int]:
    """Add the witness of the best sampled bag to `CURRENT`.

    `remaining` holds the unrepresented bags (first row, up to the count) and space for the
    candidates (second row). Returns the bag, or -1 if there was none to sample or none was
    admissible, and the number of models tried. The best one is taken even if it is worse than
    `CURRENT`.
    """
    pools, n_remaining = remaining
    candidates = pools[1]
    n_candidates = 0
    for i in range(n_remaining):
        bag = pools[0, i]
        if models.squared[CURRENT, bag] <= models.numbers[CURRENT, EDGE]:
            candidates[n_candidates] = bag
            n_candidates += 1
    models.numbers[CHOSEN, SCORE] = -np.inf
    added = -1
    n_tried = min(problem.plan[2], n_candidates)
    for i in range(n_tried):
        swap = i + draw_below(n_candidates - i, dice)
        candidates[i], candidates[swap] = candidates[swap], candidates[i]
        bag = candidates[i]
        column = witness_column(bags, bag, problem.space, models)
        _try(bags, problem, (CURRENT, column), models.numbers[CHOSEN, SCORE], models, buckets)
        if models.numbers[TRIAL, SCORE] > models.numbers[CHOSEN, SCORE]:
            copy_model(models, TRIAL, CHOSEN)
            added = bag
    if added >= 0:
        copy_model(models, CHOSEN, CURRENT)
    return added, n_tried


@inlined
def _try(
    bags: SlotMajor,
    problem: Problem,
    extension: tuple[int, int],
    floor: float,
    models: Models,
    buckets: Buckets,
) -> None:
    """Make `TRIAL` the model of row `extension[0]` and the instance in column `extension[1]`.

    Its score is minus infinity if it does not exceed the floor.
    """
    base, column = extension
    models.numbers[TRIAL, SCORE] = -np.inf
    regularisation = (problem.prior, problem.max_condition)
    if not add_key(problem.space, models, base, bags.points[:, column], regularisation):
        return
    measure(bags, problem.space, models)
    squared = models.squared[TRIAL]
    scale = models.numbers[CURRENT, EDGE] if base >= 0 else 0.0
    if not scale > 0.0:
        scale = squared.mean() + np.finfo(np.float64).tiny
    objective = (problem.objective, problem.table)
    if bags.evidence.shape[1] > 0:
        score, edge = best_weighted_cut(squared, bags.evidence, problem.objective, floor)
    else:
        score, edge = best_cut(squared, bags.weights, objective, scale, floor, buckets)
    models.numbers[TRIAL, SCORE] = score
    models.numbers[TRIAL, EDGE] = edge


@inlined
def measure(bags: SlotMajor, space: int, models: Models) -> None:
    """Fill in the witness distances of `TRIAL`."""
    squared = models.squared[TRIAL]
    centre, metric = models.centres[TRIAL], models.metrics[TRIAL]
    rank = low_rank(models, TRIAL)
    if rank < 0:
        witness_distances(space, bags, centre, metric, squared)
    else:
        low_rank_distances(bags, centre, metric, rank, squared)


@kernel
def witness_column(bags: SlotMajor, bag: int, space: int, models: Models) -> int:
    """Column in `bags.points` of the witness of `bag` for `CURRENT`."""
    centre, metric = models.centres[CURRENT], models.metrics[CURRENT]
    rank = low_rank(models, CURRENT)
    if rank < 0:
        return nearest_instance(space, bags, bag, centre, metric)
    columns = bags.offsets[: n_instances(bags, bag)] + bag
    return low_rank_nearest(bags, columns, centre, metric, rank)


@kernel
def _consider(models: Models, radius: float) -> float:
    """Remember `CURRENT` as `BEST` if it is better, or as good with as many keys; radius of the best."""
    score, best = models.numbers[CURRENT, SCORE], models.numbers[BEST, SCORE]
    as_many_keys = models.numbers[CURRENT, COUNT] >= models.numbers[BEST, COUNT]
    if score > best or (score == best and as_many_keys):
        copy_model(models, CURRENT, BEST)
        return radius_at(models.numbers[BEST, EDGE], models.squared[BEST])
    return radius


@kernel
def draw_below(n: int, dice: Dice) -> int:
    """Next integer in [0, n)."""
    draw = dice.draws[dice.used[0]]
    dice.used[0] += 1
    return int(draw * n)


@kernel
def _without(bags: NDArray[np.int64], n_bags: int, removed: int) -> int:
    """Remove one bag, keeping the others in order; how many are left."""
    kept = 0
    for i in range(n_bags):
        if bags[i] != removed:
            bags[kept] = bags[i]
            kept += 1
    return kept
