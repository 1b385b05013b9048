"""Why a policy chose an action: what speaks for it and against it, compared with the next best one."""

from __future__ import annotations

from typing import NamedTuple, Protocol, runtime_checkable

from relforest.smdp import Decision


class Reason(NamedTuple):
    """Something that speaks for an action, or against it."""

    adds: float
    """By how much it raises the value of the action over that of its rival; below 0, it speaks against it."""
    says: str
    """What was asked, as a sentence without a full stop."""
    standing: str = ""
    """How that is: true, or how far from it."""
    compared: str = ""
    """How it is for the rival."""
    of_rival: bool = False
    """Whether it was asked about the rival only."""
    witnesses: tuple[tuple[str, int], ...] = ()
    """The objects that satisfy it best: names of variables, and positions in the decision."""


class Explanation(NamedTuple):
    """The reasons for an action; what they add and what the others add is its lead over the rival."""

    rival: int
    """Position of the best of the other actions."""
    lead: float
    """The value of the action less that of the rival."""
    reasons: tuple[Reason, ...]
    """The strongest first."""
    n_others: int
    rest: float
    """What the other reasons add together."""


@runtime_checkable
class Reasoning(Protocol):
    """A policy that says why."""

    def explain(self, decision: Decision, position: int) -> Explanation | None:
        """Return why the action at a position is chosen; None if there is no other one."""
        ...
