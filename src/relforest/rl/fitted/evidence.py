"""All experience as scenes of candidate actions, and what followed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from relforest.rl.experience import BoolArray, Experience, concatenate
from relforest.rl.fitted.returns import returns
from relforest.rl.fitted.view import View
from relforest.rl.kernels import segment_argmax
from relforest.scenes import Scenes, Schema
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.support.errors import InputError

# A regression may exceed a bound a little without diverging.
_TOLERANCE: Final = 2.0


@final
@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """Transitions in the order in which they happened; letters as in `relforest.rl.experience.Experience`.

    Parameters
    ----------
    scenes : tuple of Scenes
        The candidates of each action type, as the learner sees them.
    candidates : tuple of (m,) int64
        Their numbers.
    types, owner : (c,) int64
        Action type and state of each candidate.
    starts : (s + 1,) int64
        Where the candidates of each state begin.
    remaining : (s,) int64
        How many actions can still be taken, see `Experience`.
    taken, states, next_states : (n,) int64
        The candidate taken, and the states before and after.
    rewards, discounts : (n,) float64
        Discounted reward inside the action; discount of what follows, 0 where nothing does.
    follows : (n,) bool
        Whether the next transition begins where this one ends.
    n_jobs : int
        Threads that measure its scenes.
    """

    scenes: tuple[Scenes, ...]
    candidates: tuple[IntArray, ...]
    types: IntArray
    owner: IntArray
    starts: IntArray
    remaining: IntArray
    taken: IntArray
    states: IntArray
    next_states: IntArray
    rewards: FloatArray
    discounts: FloatArray
    follows: BoolArray
    n_jobs: int = 1

    @classmethod
    def of(
        cls,
        batches: Sequence[Experience],
        view: View,
        schemas: Sequence[Schema],
        discount: float,
        n_jobs: int = 1,
    ) -> Evidence:
        """Return the evidence of batches of experience."""
        pool = concatenate(batches)
        seen = view.seen(pool.matrix)
        candidates = tuple(np.flatnonzero(pool.types == number) for number in range(len(schemas)))
        scenes = tuple(
            view.scenes(pool, own, schema, seen) for own, schema in zip(candidates, schemas, strict=True)
        )
        offers = np.diff(pool.candidates)
        # A time limit cuts the experience, but not what would follow.
        discounts = np.where(pool.terminal | (offers[pool.next_states] == 0), 0.0, discount**pool.durations)
        ended = pool.terminal | pool.truncated
        follows = np.append(~ended[:-1] & (pool.next_states[:-1] == pool.states[1:]), np.False_)
        owner = np.repeat(np.arange(pool.n_states), offers)
        return cls(
            scenes, candidates, pool.types, owner, pool.candidates, pool.remaining,
            pool.actions, pool.states, pool.next_states, pool.rewards, discounts, follows, n_jobs,
        )  # fmt: skip

    @property
    def scale(self) -> float:
        """The size of a reward, 1 if there is none."""
        size = float(np.abs(self.rewards).mean()) if len(self.rewards) else 0.0
        return size if size > 0.0 else 1.0

    @property
    def largest_value(self) -> float:
        """No value can exceed this: the largest reward per discount lost, infinite without a discount."""
        lost = 1.0 - self.discounts
        paid = np.abs(self.rewards) > 0.0
        if not paid.any():
            return 0.0
        with np.errstate(divide="ignore"):
            return float((np.abs(self.rewards[paid]) / lost[paid]).max())

    def base_type(self) -> int | None:
        """Return the first action type that every state with actions offers exactly once; None if none is."""
        offers = np.diff(self.starts) > 0
        for number, own in enumerate(self.candidates):
            counts = np.bincount(self.owner[own], minlength=len(offers))
            if offers.any() and (counts[offers] == 1).all():
                return number
        return None

    def base_of(self, base: int) -> IntArray:
        """Return the candidate of the base type of each state (s,), 0 where there is none."""
        out = np.zeros(len(self.starts) - 1, dtype=np.int64)
        out[self.owner[self.candidates[base]]] = self.candidates[base]
        return out

    def examples(self, number: int, *, is_base: bool) -> tuple[IntArray, IntArray]:
        """Return the transitions that tell about an action type, and their rows of its scenes, both (m,).

        All transitions tell about the base action of their states, the others only about the action taken.
        """
        if is_base:
            transitions, candidates = np.arange(len(self.taken)), self.base_of(number)[self.states]
        else:
            transitions = np.flatnonzero(self.types[self.taken] == number)
            candidates = self.taken[transitions]
        return transitions, np.searchsorted(self.candidates[number], candidates)

    def with_base(self, values: FloatArray, base: int | None) -> FloatArray:
        """Return values (c,) of all candidates, those of the base type added to the others of its state."""
        if base is None:
            return values
        of_state = values[self.base_of(base)]
        return np.where(self.types == base, values, values + of_state[self.owner])

    def best(self, values: FloatArray) -> FloatArray:
        """Return the largest value of the candidates of each state (s,), 0 where there are none."""
        out = np.zeros(len(self.starts) - 1)
        offers = np.flatnonzero(np.diff(self.starts))
        if len(offers):
            out[offers] = np.maximum.reduceat(values, self.starts[offers])
        return out

    def mean(self, values: FloatArray) -> FloatArray:
        """Return the mean value of the candidates of each state (s,), 0 where there are none."""
        offers = np.diff(self.starts)
        return np.bincount(self.owner, weights=values, minlength=len(offers)) / np.maximum(offers, 1)

    def earned(self) -> FloatArray:
        """Return what followed each action under the policy of the experience, (n,)."""
        out, nothing = np.empty(len(self.taken)), np.zeros(len(self.taken))
        returns(self.rewards, self.discounts, nothing, self.follows, 1.0, out)
        return out

    def targets(self, values: FloatArray, trace: float, judged: FloatArray | None = None) -> FloatArray:
        """Return the lambda-returns (n,) of the policy that is greedy for values (c,) of all candidates.

        Other values, `judged` (c,), may say what its actions are worth: then chance does not favor those
        whose value is too high (van Hasselt, Double Q-learning, 2010).
        """
        best = self.best(values)
        is_greedy = values[self.taken] >= best[self.states]
        goes_on = self.follows & np.append(is_greedy[1:], np.False_)
        if judged is not None:
            greedy = np.empty(len(best), dtype=np.int64)
            segment_argmax(values, self.starts, greedy)
            best = np.where(greedy >= 0, judged[greedy], 0.0)
        out = np.empty(len(self.taken))
        returns(self.rewards, self.discounts, best[self.next_states], goes_on, trace, out)
        return out


def check_values(values: FloatArray, evidence: Evidence) -> None:
    """Raise `InputError` if values (n,) are beyond what the rewards allow, so that learning diverges."""
    largest = _TOLERANCE * evidence.largest_value
    # The negated test also catches NaN.
    if len(values) and not np.abs(values).max() <= max(largest, 1e-9):
        raise InputError(
            f"learning diverges: values reach {np.abs(values).max():.3g}, but with these rewards and this "
            f"discount none can exceed {evidence.largest_value:.3g}; use a smaller discount or a larger ridge"
        )
