"""The action-value function that ``smrf-q`` learns, whatever it consists of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias, final

import numpy as np

from relforest.rl.fitted.additive import Sum
from relforest.rl.fitted.horizon import Horizon
from relforest.rl.fitted.questions import measured_rows
from relforest.rl.fitted.view import View
from relforest.scenes import Schema
from relforest.scenes.arrays import FloatArray
from relforest.smdp import ActionType, Decision

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
        out = np.empty(len(decision))
        objects = self.view.seen(decision.objects)
        # Private objects are bound by the actions that see them, so they need not be searched.
        shared = np.arange(decision.n_shared)
        for number, (packed, action_type) in enumerate(
            zip(self.learned.packed, self.action_types, strict=True)
        ):
            chosen = np.flatnonzero(decision.types == number)
            if not len(chosen):
                continue
            arguments = np.ascontiguousarray(decision.arguments[chosen, : action_type.arity])
            starts, counts = np.zeros(len(chosen), dtype=np.int64), np.full(len(chosen), len(shared))
            seen = measured_rows(packed, objects, (shared, starts, counts, arguments))
            n_private = np.count_nonzero(arguments >= decision.n_shared, axis=1)
            out[chosen] = self.learned.worth(
                number, seen._replace(n_objects=counts + n_private), decision.remaining
            )
        if self.learned.base is not None:
            is_base = decision.types == self.learned.base
            if is_base.any():
                out[~is_base] += out[is_base][0]
        return out
