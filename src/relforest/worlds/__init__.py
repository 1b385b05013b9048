"""Simulated worlds, each a Gymnasium environment that also implements `relforest.smdp.World`.

Worlds do not depend on learners or on each other. What their environments have in common is in `environment`,
`arguments` and `viewing`; `registry` lists their names, and `registration` registers them with Gymnasium.
Start with `corridor`, the smallest one.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
