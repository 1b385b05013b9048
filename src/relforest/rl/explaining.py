"""Why an action is worth more than another one: the parts of its value that make the difference."""

from __future__ import annotations

from typing import Final, NamedTuple, Protocol, TypeAlias

import numpy as np

from relforest.playing.reasons import Explanation, Reason
from relforest.rl.policy import ActionValues
from relforest.smdp import Decision

MOST_REASONS: Final = 3
"""Reasons for an action that are told, and reasons against it."""
AS_SUCH: Final = -1
"""The place of what being of its type adds to an action."""

Key: TypeAlias = tuple[int, int]
"""An action type, and the place of a part among those of its actions."""


class Part(NamedTuple):
    """What one question, tree or measure adds to the value of an action.

    Only differences between actions say something, so each is counted from what it usually adds.
    """

    key: Key
    adds: float


class Told(NamedTuple):
    """A part in words; see `relforest.playing.reasons.Reason`."""

    says: str
    standing: str = ""
    witnesses: tuple[tuple[str, int], ...] = ()


class Explaining(ActionValues, Protocol):
    """A value that knows its parts; `ValueFunction` and `relforest.rl.fitted.value.QValue` do."""

    def parts(self, decision: Decision, position: int) -> list[Part]:
        """Return the parts of the value of an action, which add up to it; their keys differ."""
        ...

    def tell(self, decision: Decision, position: int, key: Key) -> Told:
        """Return a part of the value of an action in words."""
        ...


def explanation(
    value: Explaining, decision: Decision, position: int, most: int = MOST_REASONS
) -> Explanation | None:
    """Return why an action is worth more than the best other one, or less.

    Parameters
    ----------
    value : Explaining
    decision : Decision
    position : int
        Of the action.
    most : int
        Reasons for it, and against it, that are told at most.

    Returns
    -------
    Explanation or None
        None if there is no other action.

    Notes
    -----
    What both have in common cancels, such as the value of the base action. A part that only one of the two
    actions has, because they are of different types, is told about that one.
    """
    if len(decision) < 2:
        return None
    values = value.values(decision).astype(np.float64)
    values[position] = -np.inf
    return comparison(value, decision, position, int(values.argmax()), most)


def comparison(
    value: Explaining, decision: Decision, position: int, rival: int, most: int = MOST_REASONS
) -> Explanation:
    """Return why an action is worth more than another one, or less; see `explanation`."""
    own, theirs = (dict(value.parts(decision, each)) for each in (position, rival))
    mine, other = ((int(decision.types[each]), AS_SUCH) for each in (position, rival))
    if mine in own and mine not in theirs and other in theirs and other not in own:
        # What the two types are worth as such is one difference.
        theirs[mine] = theirs.pop(other)
    found = {key: own.get(key, 0.0) - theirs.get(key, 0.0) for key in {**own, **theirs}}
    ranked = sorted(
        ((adds, key) for key, adds in found.items() if adds != 0.0), key=lambda each: -abs(each[0])
    )
    told = [each for sign in (1.0, -1.0) for each in [one for one in ranked if one[0] * sign > 0.0][:most]]
    told.sort(key=lambda each: -abs(each[0]))
    reasons = tuple(_reason(value, decision, (position, rival), (own, theirs), *each) for each in told)
    lead = sum(found.values())
    return Explanation(
        rival, lead, reasons, len(ranked) - len(told), lead - sum(reason.adds for reason in reasons)
    )


def _reason(
    value: Explaining,
    decision: Decision,
    actions: tuple[int, int],
    parts: tuple[dict[Key, float], dict[Key, float]],
    adds: float,
    key: Key,
) -> Reason:
    (position, rival), (own, theirs) = actions, parts
    if key not in own:
        only = value.tell(decision, rival, key)
        return Reason(adds, only.says, only.standing, of_rival=True, witnesses=only.witnesses)
    mine, compared = value.tell(decision, position, key), ""
    if key in theirs:
        other = value.tell(decision, rival, key)
        compared = other.standing if other.says == mine.says else other.says
    return Reason(adds, mine.says, mine.standing, compared, witnesses=mine.witnesses)
