"""The ground actions of a task as one flat list: what the members of the ``Discrete`` space mean.

Objects have slots: one per block, in the order in which the blocks were dropped, then one per target that a
sampler may offer, then those reserved for targets that are asked for while somebody decides. Slots do not
change during an episode, although blocks may fall off the table and targets come and go; so an action keeps
its number, and is unavailable while one of its objects is missing.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import permutations
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.smdp import UNBOUND, ActionType, Decision
from relforest.support.errors import InputError

TARGET: Final = "target"
"""The parameter that is bound to a virtual object: a place instead of a block."""


_REMEMBERED: Final = 64


@final
@dataclass(frozen=True, slots=True, eq=False)
class Offer:
    """The ground actions that are available while certain objects are present."""

    types: NDArray[np.int64]  # (m,) position among the action types
    arguments: NDArray[np.int64]  # (m, k) bound objects among those present; `UNBOUND` beyond the arity
    indices: NDArray[np.int64]  # (m,) numbers of the actions, ascending
    mask: NDArray[np.int8]  # (n,) 1 for these of all n actions

    def __post_init__(self) -> None:
        for array in (self.types, self.arguments, self.indices, self.mask):
            array.flags.writeable = False


@final
@dataclass(frozen=True, slots=True, eq=False)
class FlatActions:
    """All ground actions, whether or not they are available.

    A block that is moved to a target is not among the ``slots``: the target says which block that is.
    """

    types: NDArray[np.int64]  # (n,) position among the action types
    slots: NDArray[np.int64]  # (n, k) object slots bound to the parameters; `UNBOUND` beyond the arity
    targets: NDArray[np.int64]  # (n,) number of the target, `UNBOUND` for actions without one
    _offers: dict[bytes, Offer] = field(init=False, repr=False, default_factory=dict)

    def __len__(self) -> int:
        """Return the number of ground actions."""
        return len(self.types)

    def offer(self, present: NDArray[np.bool_], movers: NDArray[np.int64]) -> Offer:
        """Return the actions for which all objects are present; offers are cached because most recur.

        Of the slots, `present` (n_slots,) have an object; `movers` (n_targets,) are those of the blocks that
        targets are for.
        """
        key = present.tobytes() + movers.tobytes()
        offer = self._offers.get(key)
        if offer is None:
            if len(self._offers) >= _REMEMBERED:
                self._offers.clear()
            offer = self._offers[key] = self._offer(present, movers)
        return offer

    def nothing(self) -> Offer:
        """Return the offer of a terminal state, which is empty."""
        none = np.empty(0, dtype=np.int64)
        return Offer(none, self.slots[none], none, np.zeros(len(self), dtype=np.int8))

    def _offer(self, present: NDArray[np.bool_], movers: NDArray[np.int64]) -> Offer:
        rows = np.where(present, np.cumsum(present) - 1, UNBOUND)
        slots = self.slots.copy()
        aimed = self.targets != UNBOUND
        if aimed.any():
            slots[aimed, 0] = movers[self.targets[aimed]]
        is_used = slots != UNBOUND
        is_available = (present[slots] | ~is_used).all(axis=1)
        indices = np.flatnonzero(is_available)
        arguments = np.where(is_used, rows[slots], UNBOUND)
        return Offer(self.types[indices], arguments[indices], indices, is_available.astype(np.int8))


def flat_actions(
    action_types: tuple[ActionType, ...], n_blocks: int, n_targets: int, n_reserved: int = 0
) -> FlatActions:
    """Return the ground actions of all types, type after type, for these numbers of slots.

    A type with a parameter called ``target`` has one action per target, any other one for every way to bind
    different blocks to its parameters: for the last action types of all with two blocks a and b, (0, 1),
    (0, 2), ..., (1, 0), (1, 2), ... Actions with reserved targets come last, so that those before keep their
    positions when a reserved target appears.
    """
    arity = max(action_type.arity for action_type in action_types)
    types: list[int] = []
    slots: list[tuple[int, ...]] = []
    targets: list[int] = []
    is_aimed = [TARGET in action_type.parameters for action_type in action_types]
    kinds = [(*kind, range(n_targets)) for kind in enumerate(is_aimed)]
    reserved = range(n_targets, n_targets + n_reserved)
    kinds += [(number, True, reserved) for number, aimed in enumerate(is_aimed) if aimed]
    for number, aimed, own in kinds:
        action_type = action_types[number]
        bindings = (
            [(UNBOUND, n_blocks + target) for target in own]
            if aimed
            else list(permutations(range(n_blocks), action_type.arity))
        )
        types += [number] * len(bindings)
        slots += [binding + (UNBOUND,) * (arity - action_type.arity) for binding in bindings]
        targets += list(own) if aimed else [UNBOUND] * len(bindings)
    return FlatActions(
        np.array(types, dtype=np.int64),
        np.array(slots, dtype=np.int64).reshape(-1, arity),
        np.array(targets, dtype=np.int64),
    )


def position_of(decision: Decision, action_type: int, *objects: int) -> int:
    """Return the position of an available action in a decision.

    An action is its position among the action types, and the rows of the objects bound to its parameters.

    Raises
    ------
    InputError
        If the action is not available.
    """
    is_it = decision.types == action_type
    for column, row in enumerate(objects):
        is_it &= decision.arguments[:, column] == row
    found = np.flatnonzero(is_it)
    if not len(found):
        raise InputError(f"action type {action_type} with objects {objects} is not available in this state")
    return int(found[0])
