"""From experience to scenes: the objects that a tree sees for an action."""

from __future__ import annotations

import numpy as np

from relforest.rl.experience import BoolArray, Experience
from relforest.scenes import Scenes, Schema
from relforest.scenes.arrays import IntArray
from relforest.smdp import UNBOUND, Decisions


def action_scenes(experience: Experience | Decisions, candidates: IntArray, schema: Schema) -> Scenes:
    """Return one scene per candidate action: the objects it sees, the action's arguments bound first.

    An action sees the shared objects of its state, followed by the private objects that it binds.

    The candidates (m,) are all of one action type, whose parameters the schema has.

    The m scenes share the rows of the experience's matrix; no object is copied.

    References
    ----------
    Palmer (2015), section 6.5.
    """
    states = np.searchsorted(experience.candidates, candidates, side="right") - 1
    first = experience.objects[states]
    shared = experience.objects[states + 1] - experience.private[states] - first
    positions = experience.arguments[candidates, : schema.n_parameters]
    arguments = np.where(positions == UNBOUND, UNBOUND, positions + first[:, None])
    is_private = positions >= shared[:, None]
    if not is_private.any():
        return Scenes(schema, experience.matrix, np.arange(len(experience.matrix)), first, shared, arguments)
    own = is_private & _is_first(positions)
    counts = shared + own.sum(axis=1)
    starts = np.cumsum(counts) - counts
    within = np.arange(counts.sum()) - np.repeat(starts, counts)
    rows = within + np.repeat(first, counts)
    rows[within >= np.repeat(shared, counts)] = arguments[own]
    return Scenes(schema, experience.matrix, rows, starts, counts, arguments)


def _is_first(positions: IntArray) -> BoolArray:
    """Mark the arguments (m, k) that no earlier parameter of the same action is bound to."""
    same = positions[:, :, None] == positions[:, None, :]
    is_repeated: BoolArray = np.tril(same, k=-1).any(axis=2)
    return ~is_repeated
