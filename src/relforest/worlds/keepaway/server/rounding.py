"""Rounding errors must not decide what a player does.

What a player sees is quantised: distances in tenths of a metre, directions in whole degrees. So exact ties
are common (two teammates at the same distance, a ball exactly behind the player), and the order of additions
could decide on which side of a threshold a number falls. Wherever that can happen, players treat numbers that
differ by less than `TIE` as equal.
"""

from __future__ import annotations

import math
from typing import Final

from relforest.support.jit import kernel

TIE: Final = 1e-7
"""Numbers (metres, degrees, powers) closer than this are equal."""


@kernel
def whole(value: float) -> int:
    """Cut a number down to an integer, towards zero: what the RoboCup 2-D server accepts in a command."""
    return int(value + math.copysign(TIE, value))


@kernel
def wrapped(angle: float) -> float:
    """Return the same direction in degrees, above -180 and up to 180; -180 counts as 180."""
    return angle - 360.0 * math.floor((angle + 180.0 - TIE) / 360.0)


@kernel
def heading(x: float, y: float) -> float:
    """Direction of a vector in degrees, 0 for the vector without length."""
    if x == 0.0 and y == 0.0:
        return 0.0
    return math.degrees(math.atan2(y, x))
