"""How an agent picks one of the available actions.

A policy is anything with ``choose(decision, rng)``. The three here cover Palmer (2015), section 6.3:
uniformly random actions for the first batch, greedy ones for tests, and epsilon-greedy ones for later
training experience. They also choose for many episodes at once, with the same random numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, cast, final, runtime_checkable

import numpy as np

from relforest.scenes.arrays import FloatArray, IntArray
from relforest.smdp import Decision, Decisions
from relforest.support.options import in_range


class Policy(Protocol):
    """Chooses actions."""

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return the position of an action in `decision`, which offers at least one."""
        ...


@runtime_checkable
class LockstepPolicy(Policy, Protocol):
    """Also chooses in many episodes at once, knowing nothing of them but their decisions."""

    def choose_all(self, decisions: Decisions, rngs: Sequence[np.random.Generator]) -> IntArray:
        """Return what `choose` would for each decision and its own random numbers, (n_decisions,)."""
        ...


class ActionValues(Protocol):
    """Says what each available action is worth; `relforest.rl.value.ValueFunction` does."""

    def values(self, decision: Decision) -> FloatArray:
        """Return the value of each action of `decision`, (n_actions,)."""
        ...


class LockstepValues(ActionValues, Protocol):
    """Also says so for many decisions at once, as `relforest.rl.fitted.value.QValue` does."""

    def values_all(self, decisions: Decisions) -> FloatArray:
        """Return what `values` would for each decision, one after the other."""
        ...


def choose_all(policy: Policy, decisions: Decisions, rngs: Sequence[np.random.Generator]) -> IntArray:
    """Return the choice of any policy for each decision, (n_decisions,)."""
    # This is asked in every step, and `isinstance` takes long for protocols.
    if hasattr(policy, "choose_all"):
        return cast("LockstepPolicy", policy).choose_all(decisions, rngs)
    return np.array([policy.choose(*each) for each in zip(decisions, rngs, strict=True)], dtype=np.int64)


def values_all(value: ActionValues, decisions: Decisions) -> FloatArray:
    """Return the values of the actions of each decision, one after the other."""
    if hasattr(value, "values_all"):
        return cast("LockstepValues", value).values_all(decisions)
    return np.concatenate([value.values(decision) for decision in decisions])


@final
@dataclass(frozen=True, slots=True)
class RandomPolicy:
    """Choose uniformly among the available actions."""

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return a uniform position; consumes one integer from `rng`."""
        return int(rng.integers(len(decision)))

    def choose_all(self, decisions: Decisions, rngs: Sequence[np.random.Generator]) -> IntArray:
        """Return the choice for each decision, (n_decisions,)."""
        return _uniform(decisions.n_actions, rngs)


_RANDOM = RandomPolicy()


@final
@dataclass(frozen=True, slots=True)
class GreedyPolicy:
    """Choose an action of the highest value.

    Notes
    -----
    Equal values are broken at random, so that an agent that has not learned anything (Q = 0
    everywhere) acts at random rather than always taking the first action.

    References
    ----------
    Palmer (2015), eq. 2.2.
    """

    value: ActionValues  # the action values Q(s, a)

    def values(self, decision: Decision) -> FloatArray:
        """Return the values of all actions, (n_actions,)."""
        return self.value.values(decision)

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return a position of the highest value; consumes one integer from `rng` only to break a tie."""
        values = self.value.values(decision)
        best = np.flatnonzero(values == values.max())
        return int(best[0] if len(best) == 1 else best[rng.integers(len(best))])

    def choose_all(self, decisions: Decisions, rngs: Sequence[np.random.Generator]) -> IntArray:
        """Return the choice for each decision, (n_decisions,)."""
        values, starts = values_all(self.value, decisions), decisions.candidates[:-1]
        is_best = values == np.maximum.reduceat(values, starts)[decisions.owners]
        n_best = np.add.reduceat(is_best, starts, dtype=np.int64)
        ranks, ties = np.zeros(len(starts), dtype=np.int64), np.flatnonzero(n_best != 1)
        ranks[ties] = _uniform(n_best[ties], [rngs[i] for i in ties.tolist()])
        chosen: IntArray = np.flatnonzero(is_best)[np.cumsum(n_best) - n_best + ranks] - starts
        return chosen


@final
@dataclass(frozen=True, slots=True)
class EpsilonGreedyPolicy:
    """Follow a policy, but explore with a small probability.

    Raises
    ------
    InputError
        If ``epsilon`` lies outside that range.

    References
    ----------
    Palmer (2015), section 6.3, after Sutton and Barto (1998).
    """

    policy: Policy  # what to do otherwise
    epsilon: float  # probability of exploring, 0 to 1
    explorer: Policy = _RANDOM
    """How to explore. Default: uniformly."""

    def __post_init__(self) -> None:
        in_range("epsilon", self.epsilon, 0.0, 1.0)

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return a position; consumes one number from `rng` and what the choice itself needs."""
        if rng.random() < self.epsilon:
            return self.explorer.choose(decision, rng)
        return self.policy.choose(decision, rng)

    def choose_all(self, decisions: Decisions, rngs: Sequence[np.random.Generator]) -> IntArray:
        """Return the choice for each decision, (n_decisions,)."""
        explores = np.array([rng.random() < self.epsilon for rng in rngs], dtype=np.bool_)
        chosen = np.empty(len(rngs), dtype=np.int64)
        for policy, is_its in ((self.explorer, explores), (self.policy, ~explores)):
            some = np.flatnonzero(is_its)
            if len(some):
                own = decisions.take(some) if len(some) < len(rngs) else decisions
                chosen[some] = choose_all(policy, own, [rngs[i] for i in some.tolist()])
        return chosen


def exploring(value: ActionValues | None, epsilon: float, explorer: Policy = _RANDOM) -> Policy:
    """Return the policy that is greedy for values but for a probability, or explores before there are any."""
    if value is None:
        return explorer
    policy = GreedyPolicy(value)
    return EpsilonGreedyPolicy(policy, epsilon, explorer) if epsilon else policy


def _uniform(counts: IntArray, rngs: Sequence[np.random.Generator]) -> IntArray:
    """Return a uniform number below each of the counts, (n,)."""
    drawn = [rng.integers(count) for count, rng in zip(counts.tolist(), rngs, strict=True)]
    return np.array(drawn, dtype=np.int64)
