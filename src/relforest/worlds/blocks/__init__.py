"""Blocks: a robot arm stacks, turns and moves boxes on a table; rigid bodies in two dimensions.

The simulated world of Palmer (2015), sections 5.3.1 and 7.4, on the engine Box2D.

Start with `engine` (boxes, a table, springs; `box` is one of them), `blocks` (what blocks are) and
`simulation` (blocks on the table, and time). `options` are what the robot can do, in stages that `arm` does;
`grasp` tells it how to hold a block; `handling`, made of `noise` and `overlap`, how precisely, and what lies
below it.

`state`, `scene`, `stacks`, `scores` (with `color`) and `arch` are what there is to see and what it is worth;
`tasks`, `actions` and `samplers` what can be done, `policies` (with `plan`) what to do about it, and `env`
the Gymnasium face: ``relforest/HighTowers-v0``, ``relforest/ColorGrouping-v0`` and ``relforest/Arch-v0``.
`balance` and `drop_on` are outcomes of one action. `viewer`, `recorder` and `page` draw.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
