"""Which blocks stand above or below each other, and where there is room between them.

Plain loops: the blocks are few and the calls frequent.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, Literal

from relforest.support.options import one_of

Overlap = Literal["original", "interval"]
"""The tests for horizontal overlap."""

OVERLAPS: Final[tuple[Overlap, ...]] = ("original", "interval")


def overlapping(bounds: Sequence[Sequence[float]], i: int, *, overlap: Overlap = "original") -> list[int]:
    """Return the positions of the blocks that overlap a block horizontally.

    Parameters
    ----------
    bounds : n sequences of 4 floats
        Smallest and largest x, smallest and largest y of each block.
    i : int
        Position of the block; it is not among the result.
    overlap : {"original", "interval"}
        ``"original"`` is the test of the author's simulator, and is not symmetric: another block overlaps if
        its smallest, middle or largest x lies within block i. It misses a wider block that reaches beyond i
        on both sides without having its middle there. ``"interval"`` misses none.

    Raises
    ------
    InputError
        If ``overlap`` is another word.
    """
    missing_none = one_of("overlap", overlap, OVERLAPS) == "interval"
    low, high = bounds[i][0], bounds[i][1]
    found = []
    for position, (left, right, _, _) in enumerate(bounds):
        if missing_none:
            near = left <= high and right >= low
        else:
            near = low <= left <= high or low <= (left + right) / 2 <= high or low <= right <= high
        if near and position != i:
            found.append(position)
    return found


def widest_gap(intervals: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Return where the widest gap between intervals begins and ends; an empty one if there is none.

    There must be an interval. The space beyond all of them is not a gap. The leftmost of equally wide gaps is
    returned.
    """
    ordered = sorted(intervals)
    covered = ordered[0][1]
    widest = (covered, covered)
    for begin, end in ordered[1:]:
        if begin - covered > widest[1] - widest[0]:
            widest = (covered, begin)
        covered = max(covered, end)
    return widest
