"""Rule sets: "any of these conditions holds", found by description length."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, NamedTuple, final

import numpy as np

from relforest.support.jit import inlined, kernel
from relforest.support.options import at_least, in_range

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.forests.growth import GrownTree
    from relforest.forests.tables import Found

# Of the best rule set's weight, a set must have at least this share to take part in predictions.
_LEAST_WEIGHT: Final = 1e-3


@final
@dataclass(frozen=True, slots=True)
class RuleSetSettings:
    """How rule sets are chosen.

    Parameters
    ----------
    max_rules : int
        Most rules of a set.
    cost_per_number : float
        What each fitted number of a rule costs, in nats of log likelihood.
    cost_per_rule : float
        What each rule costs besides.
    cost_per_pair : float
        What a rule about two free objects costs besides, since there are many more of them.
    smoothing : float
        Added to the scenes of either class on either side of a set.
    n_steps : int
        Steps of each chain of the search.
    n_chains : int
        Chains for each of the two classes.

    Raises
    ------
    InputError
        If a value is outside its range.
    """

    max_rules: int = 5
    cost_per_number: float = 1.5
    cost_per_rule: float = 1.0
    cost_per_pair: float = 2.0
    smoothing: float = 0.1
    n_steps: int = 60_000
    n_chains: int = 4

    def __post_init__(self) -> None:
        at_least("max_rules", self.max_rules, 1)
        in_range("cost_per_number", self.cost_per_number, 0.0, 1e9)
        in_range("cost_per_rule", self.cost_per_rule, 0.0, 1e9)
        in_range("cost_per_pair", self.cost_per_pair, 0.0, 1e9)
        in_range("smoothing", self.smoothing, 0.0, 1e9, open_low=True)
        at_least("n_steps", self.n_steps, 100)
        at_least("n_chains", self.n_chains, 1)


class RuleSet(NamedTuple):
    """A set of rules with its weight among all sets."""

    rules: tuple[int, ...]  # their numbers in the pool, ascending
    describes: int  # the class whose scenes satisfy a rule
    cost: float  # description length, in nats
    weight: float  # those of all sets add up to 1


class Pool(NamedTuple):
    """The rules to choose from.

    `truth` (n_rules, n_scenes) tells for which scenes each rule is true, `costs` (n_rules,) what it costs.
    """

    truth: NDArray[np.bool_]
    costs: NDArray[np.float64]


def rule_pool(
    trees: tuple[GrownTree, ...], n_scenes: int, settings: RuleSetSettings
) -> tuple[list[Found], Pool]:
    """Return the rules that tell scenes apart, and what the search needs of them.

    These are the conditions of the trees, and what remains of them without their last statements. Of rules
    that are true for the same scenes, the cheapest is kept.
    """
    rules = (
        replace(question, numbers=question.numbers[:n])
        for grown in trees
        for question in grown.questions
        for n in range(1, len(question.numbers) + 1)
    )
    everything = np.arange(n_scenes)
    best: dict[bytes, tuple[float, Found, NDArray[np.bool_]]] = {}
    for rule in rules:
        truth = rule.holds(everything)
        cost = settings.cost_per_number * rule.condition.n_parameters + settings.cost_per_rule
        cost += settings.cost_per_pair if rule.table.n_free > 1 else 0.0
        key = truth.tobytes()
        if truth.any() and not truth.all() and (key not in best or cost < best[key][0]):
            best[key] = (cost, rule, truth)
    chosen = list(best.values())
    truths = np.array([truth for _, _, truth in chosen], dtype=np.bool_).reshape(-1, n_scenes)
    return [rule for _, rule, _ in chosen], Pool(truths, np.array([cost for cost, _, _ in chosen]))


def choose_rule_sets(
    pool: Pool,
    positive: NDArray[np.bool_],
    weights: NDArray[np.float64],
    settings: RuleSetSettings,
    rng: np.random.Generator,
) -> list[RuleSet]:
    """Sample rule sets by simulated annealing, for both classes; the one with the least cost comes first.

    The cost of a set is the negative log likelihood of the labels given whether any of its rules holds, plus
    the costs of its rules. Each set is weighted by the exponential of minus half its cost. An empty pool
    leaves the empty set.
    """
    found: dict[tuple[int, tuple[int, ...]], list[float]] = {}
    for describes in (1, 0):
        sums = (
            np.where(positive == bool(describes), weights, 0.0),
            np.where(positive == bool(describes), 0.0, weights),
        )
        for _ in range(settings.n_chains if len(pool.costs) else 0):
            sets = np.full((100, settings.max_rules), -1, dtype=np.int64)
            costs = np.empty(100)
            n = _anneal(pool, sums, (settings.n_steps, settings.smoothing), rng, sets, costs)
            for chosen, cost in zip(sets[:n].tolist(), costs[:n].tolist(), strict=True):
                key = (describes, tuple(sorted(rule for rule in chosen if rule >= 0)))
                found.setdefault(key, []).append(cost)
    if not found:
        return [RuleSet((), 1, 0.0, 1.0)]
    least = min(costs[0] for costs in found.values())
    share = {key: len(costs) * math.exp(0.5 * (least - costs[0])) for key, costs in found.items()}
    kept = {key: value for key, value in share.items() if value >= _LEAST_WEIGHT * max(share.values())}
    total = sum(kept.values())
    sets_found = [
        RuleSet(rules, describes, found[describes, rules][0], value / total)
        for (describes, rules), value in kept.items()
    ]
    return sorted(sets_found, key=lambda each: (each.cost, each.describes, each.rules))


@inlined
def _entropy(a: float, b: float, smoothing: float) -> float:
    """Negative log likelihood of so many scenes of two classes, given their smoothed shares."""
    p, q = a + smoothing, b + smoothing
    return (p + q) * math.log(p + q) - p * math.log(p) - q * math.log(q)


@kernel
def _cost(
    counts: NDArray[np.int64],
    sums: tuple[NDArray[np.float64], NDArray[np.float64]],
    smoothing: float,
) -> float:
    inside_own, inside_other, own, other = 0.0, 0.0, 0.0, 0.0
    for i in range(len(counts)):
        own += sums[0][i]
        other += sums[1][i]
        if counts[i] > 0:
            inside_own += sums[0][i]
            inside_other += sums[1][i]
    # A set describes the class that is more frequent where it holds.
    if inside_own * other < inside_other * own:
        return np.inf
    outside = _entropy(own - inside_own, other - inside_other, smoothing)
    return _entropy(inside_own, inside_other, smoothing) + outside


@kernel
def _anneal(
    pool: Pool,
    sums: tuple[NDArray[np.float64], NDArray[np.float64]],
    plan: tuple[int, float],
    rng: np.random.Generator,
    sets: NDArray[np.int64],
    costs: NDArray[np.float64],
) -> int:
    """Write sets (m, max_rules), padded with -1, visited in the second half of the steps; return how many.

    A step adds, drops or exchanges a rule; it is taken if that lowers the cost, or else with a probability
    that falls with the temperature, from 10 to 1 over the first half.
    """
    n_rules, n_scenes = pool.truth.shape
    n_steps, smoothing = plan
    burn, every = n_steps // 2, max(1, n_steps // (2 * len(costs)))
    chosen = np.full(sets.shape[1], -1)
    counts, trial = np.zeros(n_scenes, dtype=np.int64), np.zeros(n_scenes, dtype=np.int64)
    n, n_kept = 0, 0
    current = _cost(counts, sums, smoothing)
    for step in range(n_steps):
        move = rng.random()
        added = -1 if n > 0 and 1.0 / 3.0 <= move < 2.0 / 3.0 else int(rng.random() * n_rules)
        place = -1 if n == 0 or (move < 1.0 / 3.0 and n < len(chosen)) else int(rng.random() * n)
        repeated = False
        for i in range(n):
            repeated |= chosen[i] == added
        if not (repeated and added >= 0):
            trial[:] = counts
            if place >= 0:
                trial -= pool.truth[chosen[place]]
            if added >= 0:
                trial += pool.truth[added]
            cost = _cost(trial, sums, smoothing)
            for i in range(n):
                cost += pool.costs[chosen[i]] if i != place else 0.0
            cost += pool.costs[added] if added >= 0 else 0.0
            temperature = 1.0 + 9.0 * max(0.0, 1.0 - step / burn)
            if cost <= current or rng.random() < math.exp((current - cost) / temperature):
                current = cost
                counts[:] = trial
                if place >= 0 and added >= 0:
                    chosen[place] = added
                elif added >= 0:
                    chosen[n] = added
                    n += 1
                else:
                    n -= 1
                    chosen[place] = chosen[n]
                    chosen[n] = -1
        if step >= burn and step % every == 0 and n_kept < len(costs):
            sets[n_kept] = chosen
            costs[n_kept] = current
            n_kept += 1
    return n_kept
