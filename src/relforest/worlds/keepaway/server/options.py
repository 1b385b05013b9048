"""The options of a game of keepaway."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, TypedDict, final

import numpy as np

from relforest.support.errors import InputError
from relforest.support.options import between, in_range, one_of
from relforest.worlds.keepaway.server.layout import PERCEPTIONS, Setup

SMALLEST_SIDE: Final = 8.0
"""Metres. The ball begins 4 m inside a corner; on a smaller field that is past the middle."""

LARGEST_SIDE: Final = 1000.0
"""Metres. Players plan 3 seconds ahead and cover 30 m in that time; a larger field must be a mistake."""

LARGEST_TEAM: Final = 32
"""Players. What they see of each other grows with the square of their number."""

MOST_CYCLES: Final = 1_000_000
"""Cycles: more than a day of play."""


class Rules(TypedDict, total=False):
    """The parameters of `KeepawayOptions`, for functions that pass them on."""

    keepers: int
    takers: int
    size: float | tuple[float, float]
    perception: str
    stuck_ball: int
    max_cycles: int


@final
@dataclass(frozen=True, slots=True)
class KeepawayOptions:
    """The rules of a game of keepaway.

    Parameters
    ----------
    keepers : int
        Players who keep the ball, 2 to 32. Three start in corners of the field, all others at its centre.
    takers : int
        Players who try to take it, 1 to 32. They start together in the fourth corner.
    size : float or (float, float)
        Side of the square field, or its length (along x) and width, in metres, each 8 to 1000.
    perception : {"quantised", "exact", "fullstate"}
        What players know. ``"quantised"``: everything around them in every cycle, with distances and angles
        rounded as the RoboCup 2-D server does; ``"exact"``: the same without rounding; ``"fullstate"``:
        without rounding, and without the players' assumption that a ball within an opponent's reach stands
        still. Takers may then turn to and fro forever in front of a keeper that holds the ball, which
        ``stuck_ball`` alone seldom ends: choose ``max_cycles`` too.
    stuck_ball : int
        Cycles after which the referee stops a ball that has stayed within 3 m; 0 = never. The RoboCup 2-D
        server has 100 (versions 15 and later). At most 1 000 000.
    max_cycles : int
        Cycles after which an episode is cut off, at most 1 000 000; 0 = never.

    Raises
    ------
    InputError
        If an option has the wrong type or is out of range.

    References
    ----------
    Stone, Kuhlmann, Taylor, and Liu (2006), "Keepaway soccer: from machine learning testbed to benchmark".
    Palmer (2015), section 7.5.1: three keepers and two takers on 20 m by 20 m, four and three on 25 m by
    25 m, with a field of view of 360 degrees.

    Examples
    --------
    >>> KeepawayOptions(keepers=4, takers=3, size=25).n_players
    7
    """

    keepers: int = 3
    takers: int = 2
    size: float | tuple[float, float] = 20.0
    perception: str = "quantised"
    stuck_ball: int = 0
    max_cycles: int = 0

    def __post_init__(self) -> None:
        self.setup()

    @property
    def n_players(self) -> int:
        """Keepers and takers together."""
        return int(self.keepers) + int(self.takers)

    def setup(self) -> Setup:
        """Return the options as the plain numbers that kernels take."""
        length, width = _sides(self.size)
        return Setup(
            keepers=between("keepers", self.keepers, 2, LARGEST_TEAM),
            takers=between("takers", self.takers, 1, LARGEST_TEAM),
            length=length,
            width=width,
            perception=PERCEPTIONS[one_of("perception", self.perception, tuple(PERCEPTIONS))],
            stuck_ball=between("stuck_ball", self.stuck_ball, 0, MOST_CYCLES),
            max_cycles=between("max_cycles", self.max_cycles, 0, MOST_CYCLES),
        )


def checked_options(options: object) -> Setup:
    """Return options as kernels take them; None means the defaults.

    Raises
    ------
    InputError
        If they are neither `KeepawayOptions` nor None.
    """
    if options is None:
        return KeepawayOptions().setup()
    if not isinstance(options, KeepawayOptions):
        raise InputError(
            f"options must be KeepawayOptions, such as KeepawayOptions(takers=1), got {options!r}"
        )
    return options.setup()


def _sides(size: object) -> tuple[float, float]:
    if isinstance(size, np.ndarray):
        size = size.tolist()
    sides = size if isinstance(size, Sequence) and not isinstance(size, str) else (size, size)
    if len(sides) != 2:
        raise InputError(f"size must be a number, or a length and a width, in metres, got {size!r}")
    length, width = (in_range("size", side, SMALLEST_SIDE, LARGEST_SIDE) for side in sides)
    return length, width
