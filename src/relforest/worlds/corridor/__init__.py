"""A 1-D corridor with rewards at both ends: the smallest world, for tests and pictures of what was learned.

One agent with one attribute walks left or right and is paid for standing close to either end (Palmer (2015),
section 7.3). It is made by ``gymnasium.make("relforest/Corridor-v0")``. Read `state`, `dynamics`, `actions`,
`reward`, `scene` and `policies` in this order; `env` only wires them, and `viewer` draws.
"""

from __future__ import annotations

from relforest.worlds.corridor.actions import ACTION_TYPES, LEFT, RIGHT
from relforest.worlds.corridor.policies import OptimalPolicy, RandomPolicy
from relforest.worlds.corridor.scene import SCHEMA
from relforest.worlds.corridor.state import CorridorState

__all__ = ["ACTION_TYPES", "LEFT", "RIGHT", "SCHEMA", "CorridorState", "OptimalPolicy", "RandomPolicy"]
