"""How trees of conditions are grown: the options, checked once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from relforest.forests.conditions import MOST_FREE, MOST_STATEMENTS
from relforest.support.errors import InputError
from relforest.support.options import at_least, between, in_range


@final
@dataclass(frozen=True, slots=True)
class GrowthSettings:
    """What is tried at every node of a tree of conditions.

    Parameters
    ----------
    max_leaves : int
        Leaves of a tree; the leaf whose question gains most is divided first.
    max_statements : int
        Most statements of a condition, up to 8.
    max_free : int or None
        Most free variables, up to 2; None for 2 without arguments, 1 with arguments.
    max_count : int
        Conditions may ask for at least so many objects.
    every : bool
        Whether conditions on two free objects may ask for every first one whether there is a second one.
    first_share : float
        Share of the half-lines tried for the first statement of a condition, at random.
    share : float
        Share of the half-lines tried for each further statement.
    n_discs : int
        Intervals and ellipses tried for each statement.
    min_scenes : int
        Least number of scenes on either side of a question.
    penalty : float
        Lambda of the Newton step, added to the curvature of the loss.
    pair_gain : float
        Factor on the gain of conditions on two free objects, of which there are many more, where they compete
        with others.
    max_choices : int
        Most choices of objects per scene that are searched, on average; more are sampled.

    Raises
    ------
    InputError
        If a value is outside its range.
    """

    max_leaves: int = 2
    max_statements: int = 3
    max_free: int | None = None
    max_count: int = 1
    first_share: float = 1.0
    share: float = 1.0
    n_discs: int = 8
    min_scenes: int = 3
    penalty: float = 1.0
    pair_gain: float = 0.7
    max_choices: int = 1000
    every: bool = False

    def __post_init__(self) -> None:
        at_least("max_leaves", self.max_leaves, 2)
        between("max_statements", self.max_statements, 1, MOST_STATEMENTS)
        if self.max_free is not None:
            between("max_free", self.max_free, 0, MOST_FREE)
        between("max_count", self.max_count, 1, 100)
        in_range("first_share", self.first_share, 0.0, 1.0, open_low=True)
        in_range("share", self.share, 0.0, 1.0, open_low=True)
        at_least("n_discs", self.n_discs, 0)
        at_least("min_scenes", self.min_scenes, 1)
        in_range("penalty", self.penalty, 0.0, 1e9, open_low=True)
        in_range("pair_gain", self.pair_gain, 0.0, 1.0, open_low=True)
        at_least("max_choices", self.max_choices, 1)
        if not isinstance(self.every, bool):
            raise InputError(f"every must be True or False, got {self.every!r}")
