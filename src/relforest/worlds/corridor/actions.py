"""The two actions of the corridor; neither has a parameter."""

from __future__ import annotations

from typing import Final

from relforest.smdp import ActionType

LEFT: Final = 0
RIGHT: Final = 1

ACTION_TYPES: Final = (ActionType("left"), ActionType("right"))

DIRECTIONS: Final = (-1.0, 1.0)
"""Sign of the mean displacement of each action type."""
