"""Finds arches and rates them.

References
----------
Palmer (2015), section 7.4.3 and figure 7.15.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import final

import numpy as np
from numpy.typing import NDArray

from relforest.worlds.blocks.state import ON_TABLE, BlocksState


@final
@dataclass(frozen=True, slots=True)
class Arch:
    """An arch: a block supported by two others, and the open rectangle under it."""

    top: int  # positions of the top block and of its supports in the state
    left: int
    right: int
    low_x: float  # the open rectangle, world units
    high_x: float
    low_y: float
    high_y: float

    @property
    def score(self) -> float:
        """Area of the open rectangle, square world units; above 0."""
        return (self.high_x - self.low_x) * (self.high_y - self.low_y)


@lru_cache(maxsize=4)
def find_arch(state: BlocksState) -> Arch | None:
    """Return the best arch of a state, or None.

    A block is the top of an arch if it is entirely above the table rather than resting on it, no other block
    is under its centre, and it touches two blocks, the supports, with midpoints lower than its own.

    Notes
    -----
    Readings of what the source leaves open:

    - A block is under the centre of another if the vertical through that centre meets it, and its midpoint
      is lower.
    - The supports are on either side of the centre. The definition does not say so, but nothing lies open
      between two supports on one side.
    - Supports need not stand on the table themselves.
    - The open rectangle reaches from the right edge of the left support to the left edge of the right one,
      and from the table to the lowest point of the top block above that gap, so that a tilted top costs
      height. Where further blocks reach into the gap, it begins at the highest of them instead.
    - Of several arches, the one with the largest area counts. An arch must have an area above 0.
    """
    bounds = state.bounds
    arches = [arch for top in range(len(state)) for arch in _arches_under(state, bounds, top)]
    return max(arches, key=lambda arch: arch.score, default=None)


def arch_score(state: BlocksState) -> float:
    """Return the area under the best arch, 0 if there is none."""
    arch = find_arch(state)
    return 0.0 if arch is None else arch.score


def _arches_under(state: BlocksState, bounds: NDArray[np.float64], top: int) -> list[Arch]:
    """Return what is an arch with that top: usually one, or none."""
    x, y = state.poses[top, 0], state.poses[top, 1]
    is_lower = state.poses[:, 1] < y
    is_under = is_lower & (bounds[:, 0] <= x) & (x <= bounds[:, 1])
    if bounds[top, 2] <= ON_TABLE or is_under.any():
        return []
    supports = np.flatnonzero(is_lower & state.touching[top])
    left = [int(block) for block in supports if state.poses[block, 0] < x]
    right = [int(block) for block in supports if state.poses[block, 0] > x]
    pairs = [_arch(state, bounds, (top, one, other)) for one in left for other in right]
    return [arch for arch in pairs if arch.high_y > arch.low_y]


def _arch(state: BlocksState, bounds: NDArray[np.float64], blocks: tuple[int, int, int]) -> Arch:
    top, left, right = blocks
    low_x, high_x = float(bounds[left, 1]), float(bounds[right, 0])
    high_y = _lowest_above(state.half_extents[top], state.poses[top], low_x, high_x)
    reaches_in = (bounds[:, 0] < high_x) & (bounds[:, 1] > low_x) & (bounds[:, 2] < high_y)
    reaches_in[[top, left, right]] = False
    low_y = float(bounds[reaches_in, 3].max(initial=0.0))
    return Arch(top, left, right, low_x, high_x, low_y, high_y)


def _lowest_above(
    half_extents: NDArray[np.float64], pose: NDArray[np.float64], low_x: float, high_x: float
) -> float:
    """Return the lowest y of a turned box between two verticals; they meet it, as its centre lies between."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    corners = half_extents * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    corners = pose[:2] + corners @ np.array([[cos, sin], [-sin, cos]])
    inside = (corners[:, 0] >= low_x) & (corners[:, 0] <= high_x)
    heights = list(corners[inside, 1])
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        for x in (low_x, high_x):
            if min(start[0], end[0]) < x < max(start[0], end[0]):
                share = (x - start[0]) / (end[0] - start[0])
                heights.append(start[1] + share * (end[1] - start[1]))
    return float(min(heights))
