"""Commands that players send to the server: dash, turn or kick, in whole numbers.

A command is three integers: its verb, the power (dash, kick) or the moment (turn), and the direction of a
kick relative to the body, in degrees.
"""

from __future__ import annotations

import math

from relforest.support.jit import kernel
from relforest.worlds.keepaway.players.motion import Player, moment, rolled
from relforest.worlds.keepaway.server.layout import DASH, KICK, TURN
from relforest.worlds.keepaway.server.physics import POWER_MAX
from relforest.worlds.keepaway.server.rounding import heading, whole, wrapped

Command = tuple[int, int, int]


@kernel
def dash(power: float) -> Command:
    """Accelerate along the body, backwards if the power is negative."""
    return DASH, whole(min(max(power, -POWER_MAX), POWER_MAX)), 0


@kernel
def turn(angle: float, speed: float) -> Command:
    """Turn by ``angle`` degrees, or as far towards it as one command can at this speed."""
    return TURN, whole(moment(wrapped(angle), speed)), 0


@kernel
def kick(power: float, direction: float) -> Command:
    """Kick in a direction relative to the body, in degrees."""
    return KICK, whole(min(power, POWER_MAX)), whole(wrapped(direction))


@kernel
def face(me: Player, x: float, y: float, cycles: int) -> Command:
    """Turn so as to face a point from where the player will have rolled in some cycles."""
    future_x, future_y = rolled(me, cycles)
    speed = math.sqrt(me[2] * me[2] + me[3] * me[3])
    return turn(heading(x - future_x, y - future_y) - me[4], speed)
