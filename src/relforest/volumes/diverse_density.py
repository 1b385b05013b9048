"""The volume learner of 2012 (section 5.2.1): diverse density, refinement, Kolmogorov-Smirnov threshold.

Points of a few positive bags are ranked as centres by diverse density, with the covariance of all points in
positive bags as shape. Around the best of them, a volume is refined as in expectation maximisation: its key
points are the witnesses of all positive bags, which give a new centre and shape (eq. 3.5 and 3.6, as in
covariant aggregation), until no witness changes. Its radius parts the witnesses of positive and negative bags
by the largest Kolmogorov-Smirnov distance, whatever the objective, which only scores the result.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from relforest.support.jit import kernel
from relforest.volumes.aggregation import (
    Dice,
    Found,
    Problem,
    draw_below,
    found_best,
    measure,
    witness_column,
)
from relforest.volumes.bag_layout import Instances, SlotMajor, slot_major
from relforest.volumes.cuts import radius_at
from relforest.volumes.models import (
    BEST,
    CURRENT,
    EDGE,
    SCORE,
    TRIAL,
    Models,
    add_key,
    add_to_scatter,
    copy_model,
    new_models,
    set_metric,
)
from relforest.volumes.objectives import SQUARED_ERROR, WEIGHTED, score_counts, score_sums
from relforest.volumes.witnesses import CIRCLE, n_instances

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Refinement may go round in circles, since the prior and the condition limit take part in it.
_MOST_ROUNDS: Final = 50


@kernel
def diverse_density_keys(
    instances: Instances, problem: Problem, sharpness: float, draws: NDArray[np.float64]
) -> Found:
    """Learn a volume; the parameters are those of `aggregate_keys`.

    N positive bags are drawn, and the M best of their points refined. ``sharpness`` times the squared
    distance from a single key point is that in units of the covariance of all points in positive bags.
    """
    bags, positives = slot_major(instances)
    models = new_models(problem.space, bags.points.shape[0], len(bags.weights))
    sides = _sides(bags, problem.objective)
    _, n_drawn, n_refined = problem.plan
    columns = _drawn_columns(bags, positives, n_drawn, draws)
    diversity = np.empty(len(columns))
    regularisation = (problem.prior, problem.max_condition)
    for i in range(len(columns)):
        add_key(problem.space, models, -1, bags.points[:, columns[i]], regularisation)
        measure(bags, problem.space, models)
        diversity[i] = log_diverse_density(sharpness * models.squared[TRIAL], sides)
    ranking = np.argsort(-diversity, kind="mergesort")[:n_refined]
    furthest = -np.inf
    for i in ranking:
        if not _refine(bags, positives, problem, columns[i], models):
            continue
        apart, edge = most_apart(models.squared[CURRENT], sides)
        if apart > furthest:
            furthest = apart
            models.numbers[CURRENT, EDGE] = edge
            models.numbers[CURRENT, SCORE] = _score(bags, problem, models.squared[CURRENT], edge)
            copy_model(models, CURRENT, BEST)
    radius = radius_at(models.numbers[BEST, EDGE], models.squared[BEST])
    return found_best(models, radius, len(columns) + len(ranking))


@kernel
def log_diverse_density(squared: NDArray[np.float64], sides: NDArray[np.float64]) -> float:
    """Log of the diverse density of a centre (Maron and Lozano-Pérez, 1997).

    The probability of a point is its Gaussian density relative to the peak.

    Squared distances (n_bags,) are those of the bags' witnesses; sides (2, n_bags) are what every bag weighs
    as a negative and as a positive one.
    """
    total = 0.0
    for bag in range(len(squared)):
        half = 0.5 * squared[bag]
        total -= sides[1, bag] * half
        if sides[0, bag] > 0.0:
            if half == 0.0:
                return -np.inf
            total += sides[0, bag] * math.log(-math.expm1(-half))
    return total


@kernel
def most_apart(squared: NDArray[np.float64], sides: NDArray[np.float64]) -> tuple[float, float]:
    """Largest signed Kolmogorov-Smirnov distance, and the squared distance of the last bag inside that cut.

    It is the share of positive bags inside less the share of negative ones, here times the weights of both
    classes, which leaves whole numbers whole; 0 with everything inside. The smallest of equal cuts is taken,
    and bags at the same distance are not separated. Parameters as for `log_diverse_density`.
    """
    order = np.argsort(squared, kind="mergesort")
    negatives, positives = sides[0].sum(), sides[1].sum()
    inside_negative, inside_positive = 0.0, 0.0
    best, edge = -np.inf, -np.inf
    for i in range(len(order)):
        inside_negative += sides[0, order[i]]
        inside_positive += sides[1, order[i]]
        if i + 1 < len(order) and squared[order[i + 1]] == squared[order[i]]:
            continue
        apart = inside_positive * max(negatives, 1.0) - inside_negative * positives
        if apart > best:
            best, edge = apart, squared[order[i]]
    return best, edge


@kernel
def _sides(bags: SlotMajor, objective: int) -> NDArray[np.float64]:
    """What every bag weighs as a negative and as a positive one, (2, n_bags)."""
    if objective == WEIGHTED:
        return bags.evidence.copy()
    sides = np.zeros((2, len(bags.weights)))
    for bag in range(len(bags.weights)):
        side = 1 if bags.weights[bag] > 1 else 0
        sides[side, bag] = bags.evidence[0, bag] if objective == SQUARED_ERROR else 1.0
    return sides


@kernel
def _drawn_columns(
    bags: SlotMajor, positives: NDArray[np.int64], n_drawn: int, draws: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Columns in `bags.points` of all instances of so many positive bags."""
    dice = Dice(draws, np.zeros(1, dtype=np.int64))
    pool = positives.copy()
    n_drawn = min(n_drawn, len(pool))
    n_columns = 0
    for i in range(n_drawn):
        swap = i + draw_below(len(pool) - i, dice)
        pool[i], pool[swap] = pool[swap], pool[i]
        n_columns += n_instances(bags, pool[i])
    columns = np.empty(n_columns, dtype=np.int64)
    at = 0
    for i in range(n_drawn):
        for slot in range(n_instances(bags, pool[i])):
            columns[at] = bags.offsets[slot] + pool[i]
            at += 1
    return columns


@kernel
def _refine(
    bags: SlotMajor, positives: NDArray[np.int64], problem: Problem, column: int, models: Models
) -> bool:
    """Make `CURRENT` the volume of its own witnesses, starting around a point; False if it has no centre."""
    regularisation = (problem.prior, problem.max_condition)
    keys = np.full(len(positives), -1)
    add_key(problem.space, models, -1, bags.points[:, column], regularisation)
    measure(bags, problem.space, models)
    copy_model(models, TRIAL, CURRENT)
    for _ in range(_MOST_ROUNDS):
        has_changed, is_defined = False, False
        for i in range(len(positives)):
            nearest = witness_column(bags, positives[i], problem.space, models)
            has_changed |= nearest != keys[i]
            keys[i] = nearest
            base = -1 if i == 0 else TRIAL
            is_defined = add_to_scatter(problem.space, models, base, bags.points[:, nearest])
        if not has_changed:
            break
        if not is_defined:
            return False
        if problem.space != CIRCLE:
            set_metric(models, regularisation)
        measure(bags, problem.space, models)
        copy_model(models, TRIAL, CURRENT)
    return True


@kernel
def _score(bags: SlotMajor, problem: Problem, squared: NDArray[np.float64], edge: float) -> float:
    """Objective of the volume with the bags up to an edge inside."""
    if problem.objective >= WEIGHTED:
        inside = (squared <= edge).astype(np.float64)
        within = ((bags.evidence[0] * inside).sum(), (bags.evidence[1] * inside).sum())
        return score_sums(problem.objective, within, (bags.evidence[0].sum(), bags.evidence[1].sum()))
    total, within_count = 0, 0
    for bag in range(len(squared)):
        total += bags.weights[bag]
        within_count += bags.weights[bag] if squared[bag] <= edge else 0
    negatives = 2**32 - 1
    totals = (total >> 32, total & negatives)
    return score_counts(
        problem.objective, within_count >> 32, within_count & negatives, totals, problem.table
    )
