"""What a learner sees of the corridor: one object, the agent, with one attribute, its location."""

from __future__ import annotations

from typing import Final

import numpy as np

from relforest.scenes import Attribute, Scenes, Schema
from relforest.smdp import Decision
from relforest.worlds.corridor.actions import ACTION_TYPES
from relforest.worlds.corridor.state import CorridorState

SCHEMA: Final = Schema((Attribute("location", 1),))
"""The location in corridor lengths, 0 (left edge) to 1 (right edge)."""

_FIRST: Final = np.zeros(1, dtype=np.int64)
_ONE: Final = np.ones(1, dtype=np.int64)
_NO_ARGUMENTS: Final = np.empty((1, 0), dtype=np.int64)
_SCENE_ID: Final = np.zeros(1, dtype=np.int64)
_OBJECT_ID: Final = np.array(["agent"], dtype=object)

_TYPES: Final = np.arange(len(ACTION_TYPES), dtype=np.int64)
_ARGUMENTS: Final = np.empty((len(ACTION_TYPES), 0), dtype=np.int64)
for _constant in (_FIRST, _ONE, _NO_ARGUMENTS, _SCENE_ID, _OBJECT_ID, _TYPES, _ARGUMENTS):
    _constant.flags.writeable = False


def scene(state: CorridorState) -> Scenes:
    """Return the scene of a state: `Scenes` of length 1 with the object ``"agent"`` and no arguments."""
    matrix = np.array([[state.x]])
    return Scenes(SCHEMA, matrix, _FIRST, _FIRST, _ONE, _NO_ARGUMENTS, _SCENE_ID, _OBJECT_ID)


def decision(state: CorridorState) -> Decision:
    """Return the objects and actions of a state; both actions are always available."""
    return Decision(np.array([[state.x]]), _TYPES, _ARGUMENTS, _TYPES)
