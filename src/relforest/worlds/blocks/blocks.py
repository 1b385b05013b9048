"""Blocks, and the two sets of blocks that episodes begin with."""

from __future__ import annotations

import colorsys
import math
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from relforest.support.errors import InputError
from relforest.support.options import between, in_range
from relforest.worlds.arguments import checked_generator, entries

SMALLEST_HALF: Final = 0.5
LARGEST_HALF: Final = 5.0
"""Bounds of the half sides of random blocks: sides of 1 to 10 (Palmer (2015), section 7.4.1)."""

ARCH_HALF_EXTENTS: Final = (4.0, 2.0)
"""Half sides of the blocks of the arch task: 8 long, 4 high (Palmer (2015), section 7.4.3)."""

MOST_DRAWN: Final = 100_000
"""Blocks in one call."""

LARGEST_ID: Final = 2**62
"""Ids are kept as 64-bit integers."""


@final
@dataclass(frozen=True, slots=True)
class Block:
    """A rectangular block; its pose is kept by the simulation.

    Parameters
    ----------
    id : int
        Identifies the block; ids are unique within a simulation.
    half_extents : tuple of float
        Half the width and half the height while the block's angle is 0.
    color : tuple of float
        Red, green and blue, sRGB, each from 0 to 1.

    Raises
    ------
    InputError
        If the id is not an integer from 0 to `LARGEST_ID`, or ``half_extents`` are not two finite positive
        numbers or ``color`` three numbers from 0 to 1.
    """

    id: int
    half_extents: tuple[float, float]
    color: tuple[float, float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "id", between("id of a block", self.id, 0, LARGEST_ID))
        halves = [
            in_range("half_extents", half, 0, math.inf, open_low=True, open_high=True)
            for half in _numbers("half_extents", self.half_extents, 2)
        ]
        parts = [in_range("color", part, 0, 1) for part in _numbers("color", self.color, 3)]
        object.__setattr__(self, "half_extents", tuple(halves))
        object.__setattr__(self, "color", tuple(parts))


def _numbers(name: str, values: object, n: int) -> tuple[Any, ...]:
    numbers = entries(values)
    if len(numbers) != n:
        raise InputError(f"{name} of a block must be {n} numbers, got {values!r}")
    return numbers


def random_blocks(rng: np.random.Generator, n: int, *, first_id: int = 0) -> tuple[Block, ...]:
    """Draw blocks of all sizes and colors.

    Parameters
    ----------
    rng : numpy.random.Generator
        Consumed by five uniform numbers a block.
    n : int
        Number of blocks, 0 to 100 000.
    first_id : int
        Id of the first block; `BlocksSimulation.next_id` is always unused.

    Notes
    -----
    Half extents are uniform between `SMALLEST_HALF` and `LARGEST_HALF`. Colors are uniform in hue,
    saturation and brightness and quantised to 8 bits, as in the author's simulator, so dark and pale colors
    are frequent.
    """
    rng, start = checked_generator(rng), between("first_id", first_id, 0, LARGEST_ID - MOST_DRAWN)
    return tuple(
        Block(start + i, (_random_half(rng), _random_half(rng)), _random_color(rng))
        for i in range(between("n", n, 0, MOST_DRAWN))
    )


def arch_blocks(rng: np.random.Generator, n: int = 3, *, first_id: int = 0) -> tuple[Block, ...]:
    """Draw blocks of the arch task, as `random_blocks` does, but of size `ARCH_HALF_EXTENTS`.

    It consumes three uniform numbers a block.
    """
    rng, start = checked_generator(rng), between("first_id", first_id, 0, LARGEST_ID - MOST_DRAWN)
    count = between("n", n, 0, MOST_DRAWN)
    return tuple(Block(start + i, ARCH_HALF_EXTENTS, _random_color(rng)) for i in range(count))


def _random_half(rng: np.random.Generator) -> float:
    return rng.uniform(SMALLEST_HALF, LARGEST_HALF)


def _random_color(rng: np.random.Generator) -> tuple[float, float, float]:
    hue, saturation, brightness = rng.random(3).tolist()
    red, green, blue = colorsys.hsv_to_rgb(hue, saturation, brightness)
    return _quantised(red), _quantised(green), _quantised(blue)


def _quantised(part: float) -> float:
    return int(255 * part + 0.5) / 255
