"""The action-value function that ``smrf-q`` learns, whatever it consists of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias, final

import numpy as np

from relforest.rl.fitted.additive import Sum
from relforest.rl.fitted.horizon import Horizon
from relforest.rl.fitted.questions import Measures, measured_rows
from relforest.rl.fitted.view import View
from relforest.scenes import Schema
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.smdp import NO_LIMIT, ActionType, Decision, Decisions

Learned: TypeAlias = Sum | Horizon


@final
@dataclass(frozen=True, slots=True, eq=False)
class QValue:
    """Q(s, a) of any number of objects.

    Parameters
    ----------
    view : View
        How objects are seen.
    action_types : tuple of ActionType
        The action types of the world.
    learned : Sum or Horizon
    """

    view: View
    action_types: tuple[ActionType, ...]
    learned: Learned

    @property
    def schema(self) -> Schema:
        """The attributes of the world, without parameters."""
        return self.view.world

    def values(self, decision: Decision) -> FloatArray:
        """Return Q of each available action, (n_actions,).

        The decision must come from a world with this schema and these action types; this is not checked.
        """
        return self.values_all(Decisions.of([decision]))

    def values_all(self, decisions: Decisions) -> FloatArray:
        """Return Q of the actions of each decision, one after the other."""
        out = np.empty(len(decisions.types))
        matrix, owners = self.view.seen(decisions.matrix), decisions.owners
        first, rows = decisions.objects[:-1], np.arange(len(matrix))
        # Private objects are bound by the actions that see them, so they need not be searched.
        n_shared = np.diff(decisions.objects) - decisions.private
        for number, (packed, action_type) in enumerate(
            zip(self.learned.packed, self.action_types, strict=True)
        ):
            chosen = np.flatnonzero(decisions.types == number)
            if not len(chosen):
                continue
            positions = np.ascontiguousarray(decisions.arguments[chosen, : action_type.arity])
            own = owners[chosen]
            counts, starts = n_shared[own], first[own]
            seen = measured_rows(packed, matrix, (rows, starts, counts, positions + starts[:, None]))
            n_private = np.count_nonzero(positions >= counts[:, None], axis=1)
            seen = seen._replace(n_objects=counts + n_private)
            out[chosen] = self._worth(number, seen, decisions.remaining[own])
        if self.learned.base is not None:
            bases = np.flatnonzero(decisions.types == self.learned.base)
            states, places = np.unique(owners[bases], return_index=True)
            of_base = np.zeros(len(decisions))
            of_base[states] = out[bases[places]]
            others = decisions.types != self.learned.base
            out[others] += of_base[owners[others]]
        return out

    def _worth(self, number: int, seen: Measures, remaining: IntArray) -> FloatArray:
        """Return what actions (n,) of one type are worth, where so many (n,) can still be taken."""
        out = np.empty(len(remaining))
        for left in np.unique(remaining).tolist():
            own = remaining == left
            part = Measures(*(column[own] for column in seen))
            out[own] = self.learned.worth(number, part, None if left == NO_LIMIT else left)
        return out
