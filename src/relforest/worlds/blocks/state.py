"""One moment of the blocks world as arrays, which scores, scenes and plans are made from."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
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
    """The blocks that are on the scene, in the order of their ids.

    Parameters
    ----------
    ids : (n,) int64
        Never reused.
    half_extents : (n, 2) float64
        Half of the width and of the height in the block's own frame, world units.
    colors : (n, 3) float64
        Red, green and blue from 0 to 1.
    poses : (n, 3) float64
        Centre x, centre y (0 = table top) and angle in radians.
    touching : (n, n) bool
        Which blocks are in contact; symmetric.

    Raises
    ------
    InputError
        If the shapes disagree.
    """

    ids: NDArray[np.int64]
    half_extents: NDArray[np.float64]
    colors: NDArray[np.float64]
    poses: NDArray[np.float64]
    touching: NDArray[np.bool_]

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
        """Bounding boxes of the turned blocks, (n, 4): min x, max x, min y, max y."""
        reach = reaches(self.half_extents, self.poses[:, 2])
        x, y = self.poses[:, 0], self.poses[:, 1]
        return np.stack([x - reach[:, 0], x + reach[:, 0], y - reach[:, 1], y + reach[:, 1]], axis=1)

    @property
    def orientations(self) -> NDArray[np.float64]:
        """Twice the angle of the longer side, (n,) in (-pi, pi]: 0 = lying, pi = upright."""
        return orientations(self.half_extents, self.poses[:, 2])


def state_of(
    blocks: Sequence[Block], poses: NDArray[np.float64], contacts: Iterable[tuple[int, int]]
) -> BlocksState:
    """Return the state of blocks.

    Parameters
    ----------
    blocks : sequence of n Block
    poses : (n, 3) float64
        x, y and angle of each.
    contacts : iterable of pairs of int
        The ids of blocks that touch.
    """
    ids = np.array([block.id for block in blocks], dtype=np.int64)
    touching = np.zeros((len(ids), len(ids)), dtype=np.bool_)
    row = {block.id: i for i, block in enumerate(blocks)}
    for one, other in contacts:
        touching[row[one], row[other]] = touching[row[other], row[one]] = True
    return BlocksState(
        ids,
        np.array([block.half_extents for block in blocks], dtype=np.float64).reshape(-1, 2),
        np.array([block.color for block in blocks], dtype=np.float64).reshape(-1, 3),
        poses,
        touching,
    )


def reaches(half_extents: NDArray[np.float64], angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how far turned boxes reach from their centres, (n, 2) along x and y.

    Parameters
    ----------
    half_extents : (n, 2) float64
    angles : (n,) float64
        Radians.
    """
    cos, sin = np.abs(np.cos(angles)), np.abs(np.sin(angles))
    ex, ey = half_extents[:, 0], half_extents[:, 1]
    return np.stack([cos * ex + sin * ey, sin * ex + cos * ey], axis=1)


def orientations(half_extents: NDArray[np.float64], angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return twice the angle of the longer side of boxes, (n,) in (-pi, pi].

    A block looks the same after half a turn, so angles are doubled: 0 is lying, pi upright. A square counts
    as longer along its own x axis.

    Parameters
    ----------
    half_extents : (n, 2) float64
    angles : (n,) float64
        Radians.

    References
    ----------
    Palmer (2015), section 7.4.1 ("angles near 0 are horizontal and near pi are vertical").
    """
    along_y = half_extents[:, 1] > half_extents[:, 0]
    return wrap(2.0 * angles + np.pi * along_y)


def is_upright(orientation: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell which blocks stand: their longer side is within 45 degrees of the vertical.

    Parameters
    ----------
    orientation : (n,) float64
        As `orientations` returns them.
    """
    return np.abs(orientation) > np.pi / 2.0
