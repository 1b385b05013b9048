"""Simulated worlds, each a Gymnasium environment that also implements `relforest.smdp.World`.

Worlds are independent of learners and of each other. `registry` lists their names, and `registration`
registers them with Gymnasium. Start with `corridor`, the smallest one.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
