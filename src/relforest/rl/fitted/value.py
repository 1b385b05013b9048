"""The action-value function that ``smrf-q`` learns, whatever it consists of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias, final

import numpy as np

from relforest.forests.packing import pack_conditions
from relforest.rl.explaining import AS_SUCH, Key, Part, Told
from relforest.rl.fitted.horizon import Horizon
from relforest.rl.fitted.questions import Measures, measured, measured_rows
from relforest.rl.fitted.standing import in_words, witnesses
from relforest.rl.fitted.sum import Sum
from relforest.rl.fitted.view import View
from relforest.scenes import Scenes, Schema
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.smdp import NO_LIMIT, ActionType, Decision, Decisions
from relforest.support.errors import InputError
from relforest.support.options import at_least

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

    def with_questions(self, n: int) -> QValue:
        """Return the value of the `n` questions that matter most for choosing; nothing is learned again.

        Raises
        ------
        InputError
            If `n` is negative, or the value is no sum of questions.
        """
        if not isinstance(self.learned, Sum):
            raise InputError(
                "questions can only be left out of a sum of questions, and this policy is a forest"
            )
        return replace(self, learned=self.learned.most_important(at_least("questions", n, 0)))

    def parts(self, decision: Decision, position: int) -> list[Part]:
        """Return what adds up to the value of an action, see `relforest.rl.explaining`."""
        number, base = int(decision.types[position]), self.learned.base
        seen = measured(self.learned.packed[number], self._scene(decision, position))
        shares = self.learned.shares(number, seen, decision.remaining)[0].tolist()
        found = [Part((number, place), share) for place, share in enumerate(shares, start=AS_SUCH)]
        if base is not None and number != base:
            bases = np.flatnonzero(decision.types == base)
            found += self.parts(decision, int(bases[0])) if len(bases) else []
        return found

    def tell(self, decision: Decision, position: int, key: Key) -> Told:
        """Return a part of the value of an action in words."""
        number, place = key
        if number != decision.types[position]:
            position = int(np.flatnonzero(decision.types == number)[0])
        if place == AS_SUCH:
            return Told(f"{self.action_types[number].name} as such")
        scene, (condition, n_alike) = self._scene(decision, position), self.learned.told(number, place)
        if condition is None:
            return Told("the number of objects", str(int(scene.counts[0])))
        seen = measured(pack_conditions(scene.schema, [condition]), scene)
        says, stands = in_words(condition, scene.schema, float(seen.margins[0, 0]), float(seen.counts[0, 0]))
        says += f" ({n_alike} questions)" if n_alike > 1 else ""
        letters = [""] if condition.n_free == 1 else [*"CD"]
        return Told(says, stands, tuple(zip(letters, witnesses(condition, scene), strict=False)))

    def _scene(self, decision: Decision, position: int) -> Scenes:
        """Return what is seen of an action; its rows are positions in the decision."""
        schema = self.learned.schemas[int(decision.types[position])]
        seen = self.view.seen(decision.objects)
        return self.view.scenes(Decisions.of([decision]), np.array([position]), schema, seen)

    def _worth(self, number: int, seen: Measures, remaining: IntArray) -> FloatArray:
        """Return what actions (n,) of one type are worth, where so many (n,) can still be taken."""
        return _by_remaining(self.learned.worth, number, seen, remaining)

    def shares(self, number: int, seen: Measures, remaining: IntArray) -> FloatArray:
        """Return the parts of what actions (n,) of one type are worth, (n, 1 + k), see `Sum.shares`."""
        return _by_remaining(self.learned.shares, number, seen, remaining)


def _by_remaining(
    function: Callable[[int, Measures, int | None], FloatArray],
    number: int,
    seen: Measures,
    remaining: IntArray,
) -> FloatArray:
    """Return what a function says of actions (n,), called once for each number of remaining actions (n,)."""
    # Without any actions, it still says how many columns there are.
    groups = np.unique(remaining).tolist() or [NO_LIMIT]
    places = [np.flatnonzero(remaining == left) for left in groups]
    found = [
        function(
            number,
            Measures(seen.margins[own], seen.counts[own], seen.n_objects[own]),
            None if left == NO_LIMIT else left,
        )
        for left, own in zip(groups, places, strict=True)
    ]
    out: FloatArray = np.concatenate(found)[np.argsort(np.concatenate(places))]
    return out
