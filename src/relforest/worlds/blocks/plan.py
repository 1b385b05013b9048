"""What an expert would do next to build an arch.

References
----------
Palmer (2015), section 7.4.3 (the exploration policy).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final, final

from relforest.worlds.blocks.state import ON_TABLE, BlocksState, is_upright

BUFFER: Final = 1.0
"""How far the top is meant to lie on each support, world units."""


@final
@dataclass(frozen=True, slots=True)
class ArchPlan:
    """The roles of the blocks in the planned arch, and the next steps."""

    top: int  # position of the block that will lie on the others
    lying: tuple[int, ...]  # the supports that lie and should be rotated first, from left to right
    block: int  # the block to move if no support is rotated
    x: float  # where to


@lru_cache(maxsize=4)
def arch_plan(state: BlocksState) -> ArchPlan | None:
    """Return the next steps towards an arch; None with fewer than three blocks.

    Notes
    -----
    The source describes the plan in a few sentences, interpreted as follows:

    - The top is the leftmost lying block, or the leftmost block if all are upright. It is never rotated.
    - The supports are two of the others, upright ones first, else from left to right.
    - "At just the right distance apart, with a buffer zone of 1 unit on each side" means that the top is to
      overlap each support by 1: the gap between them is the present width of the top less 2. The other
      reading, a gap wider than the top, makes no arch.
    - The supports stand well if both are on the table, their gap is within 1 of that, and nothing but the top
      is in it; the top then goes to the middle of the gap. Otherwise one support moves beside the other: to
      where no block is in its way if possible, then the shorter way.
    """
    if len(state) < 3:
        return None
    x, bounds = state.poses[:, 0].tolist(), state.bounds.tolist()
    upright = is_upright(state.orientations).tolist()
    from_left = sorted(range(len(x)), key=x.__getitem__)
    top = min(from_left, key=upright.__getitem__)
    others = sorted((block for block in from_left if block != top), key=lambda block: not upright[block])
    left, right = sorted(others[:2], key=x.__getitem__)
    lying = tuple(block for block in (left, right) if not upright[block])
    gap = bounds[top][1] - bounds[top][0] - 2.0 * BUFFER
    if _stand_well(bounds, gap, (top, left, right)):
        return ArchPlan(top, lying, top, (bounds[left][1] + bounds[right][0]) / 2.0)
    return ArchPlan(top, lying, *_spacing_move(x, bounds, gap, (left, right)))


def _stand_well(bounds: list[list[float]], gap: float, blocks: tuple[int, int, int]) -> bool:
    _, left, right = blocks
    on_table = bounds[left][2] <= ON_TABLE and bounds[right][2] <= ON_TABLE
    low, high = bounds[left][1], bounds[right][0]
    return on_table and abs(high - low - gap) <= BUFFER and _is_free(bounds, low, high, blocks)


def _spacing_move(
    x: list[float], bounds: list[list[float]], gap: float, supports: tuple[int, int]
) -> tuple[int, float]:
    """Return the support to move, and where to, so that it is one gap away from the other."""
    width = [right - left for left, right, _, _ in bounds]
    moves = []
    for mover, anchor in (supports, supports[::-1]):
        for side in (-1, 1):
            target = x[anchor] + side * (gap + (width[mover] + width[anchor]) / 2.0)
            low, high = sorted((x[anchor], target + side * width[mover] / 2.0))
            is_blocked = not _is_free(bounds, low, high, (mover, anchor))
            is_propped = bounds[anchor][2] > ON_TABLE
            moves.append((is_propped, is_blocked, abs(target - x[mover]), mover, target))
    *_, mover, target = min(moves)
    return mover, target


def _is_free(bounds: list[list[float]], low: float, high: float, blocks: tuple[int, ...]) -> bool:
    """Return whether an interval of x is free of all blocks except the given ones."""
    others = (interval for block, interval in enumerate(bounds) if block not in blocks)
    return not any(left < high and right > low for left, right, _, _ in others)
