from .arm import OptionResult
from .balance import balance_scale_scenes
from .blocks import Block, arch_blocks, random_blocks
from .drop_on import drop_on_scenes
from .engine import Engine
from .handling import Handling, Noise
from .options import done, isolate, move, put, rotate
from .simulation import BlocksSimulation

__all__ = [
    "Block",
    "BlocksSimulation",
    "Engine",
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
