"""Simulated worlds, each a Gymnasium environment that also implements `relforest.smdp.World`.

Worlds know no learner and nothing of each other. `registry` lists their names and, once imported, registers
them with Gymnasium. Start with `corridor`, the smallest one.
"""

from __future__ import annotations

from relforest.worlds.registry import ENVIRONMENT_IDS, environment_id, register_worlds

__all__ = ["ENVIRONMENT_IDS", "environment_id", "register_worlds"]
