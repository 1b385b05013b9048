"""The search for the best of infinitely many places that an action may aim at.

A world proposes places; what an agent knows ranks them; the world proposes more near the best ones
(`relforest.smdp.RefiningWorld`). The search ends before the choice, so that experience holds all that was
considered, and the maximum over the actions of a state covers it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, Protocol, TypeAlias, final

import numpy as np

from relforest.rl.policy import ActionValues, Policy
from relforest.scenes.arrays import IntArray
from relforest.smdp import Decision, RefiningWorld, check_refined
from relforest.support.options import between

MOST_ROUNDS: Final = 100

Refine: TypeAlias = Callable[[IntArray], Decision]


class Search(Protocol):
    """Looks for good actions beside those that a world offers first."""

    def refined(self, decision: Decision, value: ActionValues, refine: Refine) -> Decision:
        """Return the decision after all questions to `refine`, see `RefiningWorld.refine`."""
        ...

    def to_dict(self) -> dict[str, Any]:
        """Return what the search depends on, as plain JSON values."""
        ...


@final
@dataclass(frozen=True, slots=True)
class BeamSearch:
    """Ask for more near the most valuable actions, a fixed number of times.

    Each round asks near the `width` best of the actions that aim at a place, as far as it has not done so
    before. Of equal values the first counts. The search ends early when the best have all been refined, or
    nothing new is proposed.

    Parameters
    ----------
    width : int
        Actions that are refined in a round, at least 1. The source leaves it open, as the rounds.
    rounds : int
        0 to 100.

    Raises
    ------
    InputError
        If an option is out of its range.

    References
    ----------
    Palmer (2015), sections 6.5 and 7.4.3.
    """

    width: int = 5
    rounds: int = 2

    def __post_init__(self) -> None:
        between("width", self.width, 1, 10_000)
        between("rounds", self.rounds, 0, MOST_ROUNDS)

    def refined(self, decision: Decision, value: ActionValues, refine: Refine) -> Decision:
        """Return the decision with what the beam has found."""
        known = np.empty(0, dtype=np.int64)
        for _ in range(self.rounds):
            aims = np.flatnonzero((decision.arguments >= decision.n_shared).any(axis=1))
            if not len(aims):
                break
            worth = value.values(decision)[aims]
            best = aims[np.argsort(-worth, kind="stable")[: self.width]]
            before, best = len(decision), np.setdiff1d(best, known)
            if len(best):
                decision, known = refine(best), np.append(known, best)
            if len(decision) == before:
                break
        return decision

    def to_dict(self) -> dict[str, Any]:
        """Return the options as plain JSON values."""
        return {"width": self.width, "rounds": self.rounds}


@final
@dataclass(frozen=True, slots=True, eq=False)
class SearchingPolicy:
    """Search in a world before every choice."""

    policy: Policy  # chooses among everything that was found
    value: ActionValues  # what actions are worth
    world: RefiningWorld  # where the policy acts
    search: Search

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return a position in what the world's decision is afterwards.

        Raises
        ------
        InputError
            If the world breaks the rules of `RefiningWorld.refine`.
        """
        now = decision

        def refine(positions: IntArray) -> Decision:
            nonlocal now
            before, now = now, self.world.refine(positions)
            check_refined(before, now)
            return now

        return self.policy.choose(self.search.refined(decision, self.value, refine), rng)
