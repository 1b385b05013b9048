"""Checks of decisions: against the world that they come from, and against the decision before."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from relforest.smdp.decisions import UNBOUND, ActionType, Decision
from relforest.support.errors import InputError

if TYPE_CHECKING:
    from relforest.scenes import Schema


def check_decision(decision: Decision, schema: Schema, action_types: Sequence[ActionType]) -> None:
    """Check the values of a decision against the world it comes from.

    Parameters
    ----------
    decision : Decision
        The decision of one state.
    schema : Schema
    action_types : sequence of ActionType
        Those of the world.

    Raises
    ------
    InputError
        If the objects do not fit the schema, a value is infinite, an action has an unknown type, an argument
        is missing, superfluous or not an object of the state, an index is negative or appears twice, or
        actions remain although none is offered.
    """
    n_objects, width = decision.objects.shape
    if width != schema.width:
        raise InputError(f"objects has {width} columns, but the schema of the world has {schema.width}")
    if np.isinf(decision.objects).any():
        raise InputError("objects contains an infinite value; use NaN for undefined values")
    largest = max((action_type.arity for action_type in action_types), default=0)
    if decision.arguments.shape[1] != largest:
        raise InputError(
            f"arguments has {decision.arguments.shape[1]} columns, "
            f"but the largest arity of the action types is {largest}"
        )
    if len(np.unique(decision.indices)) < len(decision) or (decision.indices < 0).any():
        raise InputError(f"indices must be distinct and not negative, got {decision.indices.tolist()}")
    if decision.remaining and not len(decision):
        raise InputError(f"remaining must be 0 in a state without actions, got {decision.remaining}")
    for position, (type_, arguments) in enumerate(zip(decision.types, decision.arguments, strict=True)):
        if not 0 <= type_ < len(action_types):
            raise InputError(
                f"action {position} has type {type_}, but there are {len(action_types)} action types"
            )
        arity = action_types[type_].arity
        bound, unused = arguments[:arity], arguments[arity:]
        if (bound < 0).any() or (bound >= n_objects).any() or (unused != UNBOUND).any():
            raise InputError(
                f"action {position} ({action_types[type_].name}) has arguments {arguments.tolist()}; "
                f"the first {arity} must be positions of the {n_objects} objects, the others {UNBOUND}"
            )


def check_refined(before: Decision, after: Decision) -> None:
    """Check what `RefiningWorld.refine` returned against the decision before; `check_decision` holds besides.

    Raises
    ------
    InputError
        If an object or an action changed, a number is used twice, a new object is shared, infinite or
        entirely undefined, or a new action binds no new object.
    """
    n, m = before.n_objects, len(before)
    for name, length in (("objects", n), ("types", m), ("arguments", m), ("indices", m)):
        if not np.array_equal(
            getattr(before, name), getattr(after, name)[:length], equal_nan=name == "objects"
        ):
            raise InputError(f"refine() must keep {name} of earlier actions as they were: only append")
    if (after.n_shared, after.remaining) != (before.n_shared, before.remaining):
        raise InputError("refine() must keep the shared objects and the number of remaining actions")
    added, places = after.objects[n:], after.arguments[m:]
    if np.isinf(added).any() or np.isnan(added).all(axis=1).any():
        raise InputError("refine() must add finite places, but added one that is infinite or undefined")
    if not ((places >= n) & (places < after.n_objects)).any(axis=1).all():
        raise InputError("each action that refine() adds must bind one of the private objects that it adds")
    if len(np.unique(after.indices)) < len(after):
        raise InputError("refine() must give each action that it adds a number of its own")
