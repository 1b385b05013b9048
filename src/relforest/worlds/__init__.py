"""Simulated worlds, each a Gymnasium environment that also implements `relforest.smdp.World`.

Worlds know no learner and nothing of each other. `registry` lists their names and, once imported, registers
them with Gymnasium. Start with `corridor`, the smallest one.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
