"""How the robot handles blocks."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import final

from relforest.support.errors import InputError
from relforest.support.options import one_of
from relforest.worlds.blocks.noise import Noise
from relforest.worlds.blocks.overlap import OVERLAPS, Overlap


@final
@dataclass(frozen=True, slots=True)
class Handling:
    """How precisely the robot grasps and carries, and which blocks it considers to be below another.

    Parameters
    ----------
    noise : Noise
        The errors of the robot; ``Noise.none()`` removes them.
    overlap : {"original", "interval"}
        How blocks below are found, see `relforest.worlds.blocks.overlap.overlapping`.

    Raises
    ------
    InputError
        If ``noise`` is not a Noise, or ``overlap`` is not one of these words.
    """

    noise: Noise = field(default_factory=Noise)
    overlap: Overlap = "original"

    def __post_init__(self) -> None:
        if not isinstance(self.noise, Noise):
            raise InputError(f"noise must be a Noise, such as Noise.none(), got {self.noise!r}")
        one_of("overlap", self.overlap, OVERLAPS)
