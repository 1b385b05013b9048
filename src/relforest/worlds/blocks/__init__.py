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

from relforest.worlds.blocks.balance import balance_scale_scenes
from relforest.worlds.blocks.blocks import Block, arch_blocks, random_blocks
from relforest.worlds.blocks.drop_on import drop_on_scenes
from relforest.worlds.blocks.engine import Engine
from relforest.worlds.blocks.handling import Handling
from relforest.worlds.blocks.noise import Noise
from relforest.worlds.blocks.options import OptionResult, done, isolate, move, put, rotate
from relforest.worlds.blocks.simulation import BlocksSimulation, Frame

__all__ = [
    "Block",
    "BlocksSimulation",
    "Engine",
    "Frame",
    "Handling",
    "Noise",
    "OptionResult",
    "arch_blocks",
    "balance_scale_scenes",
    "done",
    "drop_on_scenes",
    "isolate",
    "move",
    "put",
    "random_blocks",
    "rotate",
]
