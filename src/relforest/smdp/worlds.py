"""What a world offers to learners."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from relforest.smdp.decisions import ActionType, Decision, Decisions

if TYPE_CHECKING:
    from relforest.scenes import Schema


@runtime_checkable
class World(Protocol):
    """What a learner needs from a world; the ``unwrapped`` environment of every world implements it."""

    @property
    def schema(self) -> Schema:
        """Attributes of the objects, without parameters: those belong to the action types."""
        ...

    @property
    def action_types(self) -> tuple[ActionType, ...]:
        """The action types, in the order that `Decision.types` counts."""
        ...

    @property
    def discount(self) -> float:
        """Discount factor gamma per unit of ``info["duration"]``, in (0, 1]."""
        ...

    def decision(self) -> Decision:
        """Return the objects and the available ground actions of the present state."""
        ...


@runtime_checkable
class RefiningWorld(World, Protocol):
    """A world with actions that aim at places, which proposes further places near those it offers.

    A search for the best place is a conversation with such a world. A policy may ask while it chooses: the
    decision to be recorded is what ``decision()`` returns after the choice.

    References
    ----------
    Palmer (2015), section 6.5 (beam search across sampled actions).
    """

    def refine(self, positions: NDArray[np.int64]) -> Decision:
        """Return the present decision with more actions, like those at some positions.

        From now on ``decision()`` returns the same, and the new actions can be taken. Shared objects and
        actions stay as they are; new private objects and new actions follow the others. Nothing is added for
        actions that aim nowhere, for places that are offered already, or when the world cannot offer more.
        The next step or reset forgets what was added.
        """
        ...


class Outcomes(NamedTuple):
    """What a step of e episodes brought, all (e,)."""

    rewards: NDArray[np.float64]  # undiscounted
    discounted: NDArray[np.float64]  # discounted to the beginning of the action
    durations: NDArray[np.float64]
    terminal: NDArray[np.bool_]
    truncated: NDArray[np.bool_]


class Lockstep(Protocol):
    """Episodes that are played together; none depends on the others. They are named by their numbers.

    Several of these may be used at a time, each in a thread.
    """

    @property
    def before(self) -> NDArray[np.float64]:
        """Reward and time before the first decision of each episode, (2, e)."""
        ...

    def decisions(self, episodes: NDArray[np.int64]) -> Decisions:
        """Return the present decisions of some episodes (e,)."""
        ...

    def step(self, episodes: NDArray[np.int64], actions: NDArray[np.int64]) -> Outcomes:
        """Take an action of the flat ``Discrete`` space (e,) in each of these episodes, which go on."""
        ...


@runtime_checkable
class LockstepWorld(World, Protocol):
    """A world that can play many episodes together."""

    @property
    def lockstep(self) -> Callable[[Sequence[int]], Lockstep] | None:
        """What begins an episode for each of several seeds; None if that is impossible at present.

        Episode i is what follows ``reset(seed=seeds[i])``, to the last bit; this environment does not change.
        """
        ...
