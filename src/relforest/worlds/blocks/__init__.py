"""Blocks: a robot arm stacks, turns and moves boxes on a table; rigid bodies in two dimensions.

The simulated world of Palmer (2015), sections 5.3.1 and 7.4, on the engine Box2D.

Start with `engine` (a table, boxes and springs; `box` is a single box), `blocks` (the properties of blocks)
and `simulation` (blocks on the table, and time). `options` are the skills of the robot, made of stages in
`arm`; `grasp` places the springs that hold a block; `handling`, consisting of `noise` and `overlap`, sets how
precise the robot is and which blocks it considers to be below another.

`state`, `scene`, `stacks`, `scores` (with `color`) and `arch` describe and score states; `tasks`, `actions`
and `samplers` define what can be done; `policies` (with `plan`) decide; and `env` is the Gymnasium
environment of ``relforest/HighTowers-v0``, ``relforest/ColorGrouping-v0`` and ``relforest/Arch-v0``.
`balance` and `drop_on` are outcomes of one action. `frames` are what there is to see.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
