"""How an agent picks one of the available actions.

A policy is anything with ``choose(decision, rng)``. The three here cover Palmer (2015), section 6.3:
uniformly random actions for the first batch, greedy ones for tests, and epsilon-greedy ones for later
training experience.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, final

import numpy as np

from relforest.scenes.arrays import FloatArray
from relforest.smdp import Decision
from relforest.support.options import in_range


class Policy(Protocol):
    """Chooses actions."""

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return the position of an action in `decision`, which offers at least one."""
        ...


class ActionValues(Protocol):
    """Says what each available action is worth; `relforest.rl.value.ValueFunction` does."""

    def values(self, decision: Decision) -> FloatArray:
        """Return the value of each action of `decision`, (n_actions,)."""
        ...


@final
@dataclass(frozen=True, slots=True)
class RandomPolicy:
    """Choose uniformly among the available actions."""

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return a uniform position; consumes one integer from `rng`."""
        return int(rng.integers(len(decision)))


@final
@dataclass(frozen=True, slots=True)
class GreedyPolicy:
    """Choose an action of the highest value.

    Parameters
    ----------
    value : ActionValues
        The action values Q(s, a).

    Notes
    -----
    Equal values are broken at random, so that an agent that has not learned anything (Q = 0
    everywhere) acts at random rather than always taking the first action.

    References
    ----------
    Palmer (2015), eq. 2.2.
    """

    value: ActionValues

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return a position of the highest value; consumes one integer from `rng` only to break a tie."""
        values = self.value.values(decision)
        best = np.flatnonzero(values == values.max())
        return int(best[0] if len(best) == 1 else best[rng.integers(len(best))])


@final
@dataclass(frozen=True, slots=True)
class EpsilonGreedyPolicy:
    """Follow another policy, but choose uniformly with a small probability.

    Parameters
    ----------
    policy : Policy
        What to do otherwise.
    epsilon : float
        Probability of a uniform choice, 0 to 1.

    Raises
    ------
    InputError
        If ``epsilon`` lies outside that range.

    References
    ----------
    Palmer (2015), section 6.3, after Sutton and Barto (1998).
    """

    policy: Policy
    epsilon: float

    def __post_init__(self) -> None:
        in_range("epsilon", self.epsilon, 0.0, 1.0)

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return a position; consumes one number from `rng` and what the choice itself needs."""
        if rng.random() < self.epsilon:
            return int(rng.integers(len(decision)))
        return self.policy.choose(decision, rng)
