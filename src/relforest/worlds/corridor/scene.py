"""What a learner sees of the corridor: one object, the agent, with one attribute, its location."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes import Attribute, Scenes, Schema
from relforest.smdp import Decision
from relforest.worlds.corridor.dynamics import ACTION_TYPES
from relforest.worlds.corridor.state import CorridorState

SCHEMA: Final = Schema((Attribute("location", 1),))
"""The location in corridor lengths, 0 (left edge) to 1 (right edge)."""

# Nothing here depends on the state, so it is made and checked once.
_TEMPLATE: Final = Scenes(
    SCHEMA,
    matrix=np.zeros((1, 1)),
    rows=np.zeros(1, dtype=np.int64),
    starts=np.zeros(1, dtype=np.int64),
    counts=np.ones(1, dtype=np.int64),
    object_ids=np.array(["agent"], dtype=object),
)
_CHOICES: Final = Decision(
    objects=np.zeros((1, 1)),
    types=np.arange(len(ACTION_TYPES)),
    arguments=np.empty((len(ACTION_TYPES), 0), dtype=np.int64),
    indices=np.arange(len(ACTION_TYPES)),
)


def scene(state: CorridorState) -> Scenes:
    """Return the scene of a state: `Scenes` of length 1 with the object ``"agent"`` and no arguments."""
    return _TEMPLATE.with_matrix(np.array([[state.x]]))


def decision(state: CorridorState) -> Decision:
    """Return the objects and actions of a state; both actions are always available."""
    return Decision(_matrix(state.x), _CHOICES.types, _CHOICES.arguments, _CHOICES.indices)


def _matrix(x: float) -> NDArray[np.float64]:
    matrix = np.array([[x]])
    matrix.flags.writeable = False
    return matrix
