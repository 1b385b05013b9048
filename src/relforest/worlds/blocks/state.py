"""One moment of the blocks world as arrays, the input of scores, scenes and plans."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes.angles import wrap
from relforest.support.errors import InputError
from relforest.worlds.blocks.blocks import Block

ON_TABLE: Final = 0.05
"""A block is on the table if its lowest point is at most this high; the engine keeps bodies 0.015 apart."""


@final
@dataclass(frozen=True, slots=True, eq=False)
class BlocksState:
    """The remaining blocks, in the order of their ids.

    Raises
    ------
    InputError
        If the shapes disagree.
    """

    ids: NDArray[np.int64]  # (n,) never reused
    half_extents: NDArray[np.float64]
    """(n, 2): half of the width and of the height in the block's own frame, world units."""
    colors: NDArray[np.float64]  # (n, 3) red, green and blue from 0 to 1
    poses: NDArray[np.float64]  # (n, 3) centre x, centre y (0 = table top) and angle in radians
    touching: NDArray[np.bool_]  # (n, n) which blocks are in contact; symmetric

    def __post_init__(self) -> None:
        n = len(self.ids)
        for name, shape in (
            ("half_extents", (n, 2)),
            ("colors", (n, 3)),
            ("poses", (n, 3)),
            ("touching", (n, n)),
        ):
            if getattr(self, name).shape != shape:
                raise InputError(
                    f"{name} must have the shape {shape} for {n} blocks, got {getattr(self, name).shape}"
                )

    def __len__(self) -> int:
        """Return the number of blocks."""
        return len(self.ids)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Bounding boxes of the turned blocks, (n, 4), read-only: min x, max x, min y, max y."""
        return _bounds(self)

    @property
    def orientations(self) -> NDArray[np.float64]:
        """Twice the angle of the longer side, (n,) in (-pi, pi]: 0 = lying, pi = upright."""
        return orientations(self.half_extents, self.poses[:, 2])


@final
@dataclass(frozen=True, slots=True, eq=False)
class Cast:
    """The remaining blocks, as in `BlocksState`: what stays the same until one of them is lost."""

    ids: NDArray[np.int64]
    half_extents: NDArray[np.float64]
    colors: NDArray[np.float64]

    def __post_init__(self) -> None:
        for array in (self.ids, self.half_extents, self.colors):
            array.flags.writeable = False

    @classmethod
    def of(cls, blocks: Sequence[Block]) -> Cast:
        """Return what `blocks` are."""
        return cls(
            np.array([block.id for block in blocks], dtype=np.int64),
            np.array([block.half_extents for block in blocks], dtype=np.float64).reshape(-1, 2),
            np.array([block.color for block in blocks], dtype=np.float64).reshape(-1, 3),
        )

    def state(self, poses: NDArray[np.float64], contacts: Iterable[tuple[int, int]]) -> BlocksState:
        """Return the state with these poses and these pairs of ids in contact, see `BlocksState`."""
        touching = np.zeros((len(self.ids), len(self.ids)), dtype=np.bool_)
        row = {block: i for i, block in enumerate(self.ids.tolist())}
        for one, other in contacts:
            touching[row[one], row[other]] = touching[row[other], row[one]] = True
        return BlocksState(self.ids, self.half_extents, self.colors, poses, touching)


# Scores, samplers and plans ask for those of the same state one after the other.
@lru_cache(maxsize=4)
def _bounds(state: BlocksState) -> NDArray[np.float64]:
    bounds = boxes(state.poses[:, :2], reaches(state.half_extents, state.poses[:, 2]))
    bounds.flags.writeable = False
    return bounds


def boxes(centres: NDArray[np.float64], reach: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the `BlocksState.bounds` of boxes with these centres and reaches, (n, 2) along x and y."""
    bounds = np.empty((len(centres), 4))
    bounds[:, 0::2] = centres - reach
    bounds[:, 1::2] = centres + reach
    return bounds


def reaches(half_extents: NDArray[np.float64], angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how far boxes turned by ``angles`` (radians) reach from their centres, (n, 2) along x and y."""
    cos, sin = np.abs(np.cos(angles)), np.abs(np.sin(angles))
    reach: NDArray[np.float64] = cos[:, None] * half_extents + sin[:, None] * half_extents[:, ::-1]
    return reach


def orientations(half_extents: NDArray[np.float64], angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return twice the angle (radians) of the longer side of boxes, (n,) in (-pi, pi].

    A block looks the same after half a turn, so angles are doubled: 0 is lying, pi upright (Palmer (2015),
    section 7.4.1). A square counts as longer along its own x axis.
    """
    along_y = half_extents[:, 1] > half_extents[:, 0]
    return wrap(2.0 * angles + np.pi * along_y)


def is_upright(orientation: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which `orientations` are upright: the longer side is within 45 degrees of the vertical."""
    return np.abs(orientation) > np.pi / 2.0
