"""How precisely the robot grasps and carries blocks, and which it considers to be below another."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import final

import numpy as np

from relforest.support.errors import InputError
from relforest.support.options import in_range, one_of
from relforest.worlds.blocks.overlap import OVERLAPS, Overlap


@final
@dataclass(frozen=True, slots=True)
class Noise:
    """Standard deviations of the Gaussian errors inside the options, drawn for x and y independently.

    Parameters
    ----------
    grasp : float
        Of the point where a block is grasped, around its centre.
    carry : float
        Of each goal that a block is carried to: one error for lifting, one for moving sideways, one for
        lowering.
    rotate : float
        Of the point where a block is grasped to rotate it, as a share of the half side it lies on.

    Raises
    ------
    InputError
        If a value is not a finite number of at least 0.

    Notes
    -----
    The defaults are those of the author's simulator. Palmer (2015), section 7.4.1 gives the error of
    ``rotate`` as a share of the distance between the point and the centre, which is 0.7 of the half side.
    """

    grasp: float = 0.5
    carry: float = 1.0
    rotate: float = 0.025

    def __post_init__(self) -> None:
        for name in (entry.name for entry in fields(self)):
            value = in_range(name, getattr(self, name), 0, math.inf, open_high=True)
            object.__setattr__(self, name, value)

    @classmethod
    def none(cls) -> Noise:
        """Return the noise of a robot without errors; the same random numbers are drawn."""
        return cls(0.0, 0.0, 0.0)


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


def spread(rng: np.random.Generator, deviation: float) -> tuple[float, float]:
    """Draw an error for x and one for y with this standard deviation."""
    return deviation * rng.standard_normal(), deviation * rng.standard_normal()
