"""Blocks: a robot arm stacks, turns and moves boxes on a table; rigid bodies in two dimensions.

The simulated world of Palmer (2015), sections 5.3.1 and 7.4, on the engine Box2D.

Start with `engine` (boxes, a table, springs; `box` is one of the boxes), `blocks` (what blocks are) and
`simulation` (blocks on the table, and time). `options` are what the robot can do, in stages that `arm`
performs; `grasp` decides how to hold a block, and `handling`, made of `noise` and `overlap`, how precisely,
and what lies below it.

`state`, `scene`, `stacks`, `scores` (with `color`) and `arch` describe what can be seen and what it is worth;
`tasks`, `actions` and `samplers` what can be done; `policies` (with `plan`) choose among that, and `env` is
the Gymnasium face: ``relforest/HighTowers-v0``, ``relforest/ColorGrouping-v0`` and ``relforest/Arch-v0``.
`balance` and `drop_on` simulate the outcome of one action. `viewer`, `recorder` and `page` draw.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
