"""Episodes as arrays: the pose of every block over time, and the effect of every option."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.worlds.blocks.command import Command

NOBODY: Final = -1


@final
@dataclass(frozen=True, slots=True)
class OptionRecord:
    """An option that was carried out.

    Parameters
    ----------
    name : str
        put, rotate, isolate, move or done.
    blocks : tuple of int
        Ids of the blocks among its arguments.
    target : float or None
        Where to move, x in world units.
    begin, end : float
        Seconds since the episode began.
    reward : float
    score : float
        The score of the state afterwards.
    """

    name: str
    blocks: tuple[int, ...]
    target: float | None
    begin: float
    end: float
    reward: float
    score: float

    @property
    def duration(self) -> float:
        """Seconds from the choice to the end."""
        return self.end - self.begin

    def __str__(self) -> str:
        """Return the option as it is written, such as ``put(3, 1)`` or ``move(2, x = -16.7)``."""
        return str(Command(self.name, (*self.blocks, *(() if self.target is None else (self.target,)))))


@final
@dataclass(frozen=True, slots=True)
class Mark:
    """What a score is based on: a stack, or the opening of an arch.

    Parameters
    ----------
    left, right, low, high : float
        A rectangle in world units; a flat one is a line.
    score : float
        Its contribution.
    """

    left: float
    right: float
    low: float
    high: float
    score: float


@final
@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """An episode of a blocks task.

    Letters: t moments, n blocks, d options.

    Parameters
    ----------
    task : str
        Name of the task, such as ``high-towers``.
    ids : (n,) int64
        All blocks of the episode.
    half_extents : (n, 2) float64
        Half sides along the blocks' own axes.
    colors : (n, 3) float64
        Red, green and blue, from 0 to 1.
    times : (t,) float64
        Seconds since the episode began, ascending; at least one.
    poses : (t, n, 3) float64
        x, y and angle in radians; NaN after a block has fallen off the table.
    held : (t,) int64
        Id of the block that the robot holds, -1 = none.
    options : tuple of OptionRecord
        In order.
    first_score : float
        The score of the state before the first option.
    marks : tuple of tuple of Mark
        The marks before each option and after the last, d + 1 tuples.

    Raises
    ------
    InputError
        If shapes or numbers do not agree, times decrease, or an option names an unknown block.
    """

    task: str
    ids: NDArray[np.int64]
    half_extents: NDArray[np.float64]
    colors: NDArray[np.float64]
    times: NDArray[np.float64]
    poses: NDArray[np.float64]
    held: NDArray[np.int64]
    options: tuple[OptionRecord, ...]
    first_score: float
    marks: tuple[tuple[Mark, ...], ...]

    def __post_init__(self) -> None:
        n, moments = len(self.ids), len(self.times)
        shapes = {"half_extents": (n, 2), "colors": (n, 3), "poses": (moments, n, 3), "held": (moments,)}
        for name, shape in shapes.items():
            if getattr(self, name).shape != shape:
                raise InputError(f"{name} must have the shape {shape}, got {getattr(self, name).shape}")
        if not moments or not np.isfinite(self.times).all() or (np.diff(self.times) < 0).any():
            raise InputError("times must be finite and ascending, with at least one entry")
        if len(self.marks) != len(self.options) + 1:
            raise InputError(
                f"marks must have an entry before each of {len(self.options)} options and after the last, "
                f"got {len(self.marks)}"
            )
        known = set(self.ids.tolist())
        for option in self.options:
            if not known.issuperset(option.blocks):
                raise InputError(f"{option} names a block that is not one of {sorted(known)}")

    @property
    def duration(self) -> float:
        """Seconds of the episode."""
        return float(self.times[-1])

    @property
    def total_reward(self) -> float:
        """Sum of all rewards, undiscounted."""
        return float(sum(option.reward for option in self.options))

    @property
    def last_score(self) -> float:
        """The score of the final state."""
        return self.options[-1].score if self.options else self.first_score
