"""How players predict the motion of players and ball: without noise.

Planning looks at one player and one target in the body frame of the player: x along its body direction, y to
the side of growing angles. A *pursuit* is (tx, ty, vx, vy): the target relative to the player, and the
velocity of the player, both in that frame. A dash changes only vx, and a complete turn is a rotation by the
direction of the target, so no angle is needed until the speed of the player cuts a turn short.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from relforest.support.jit import kernel
from relforest.worlds.keepaway.server.physics import (
    BALL_DECAY,
    DASH_RATE,
    INERTIA,
    MOMENT_MAX,
    PLAYER_DECAY,
    PLAYER_SPEED_MAX,
    POWER_MAX,
)
from relforest.worlds.keepaway.server.referee import REACH
from relforest.worlds.keepaway.server.rounding import TIE

Player = tuple[float, float, float, float, float]
"""x, y, vx, vy and body direction in degrees."""
Ball = tuple[float, float, float, float]
"""x, y, vx, vy."""
Pursuit = tuple[float, float, float, float]
Approach = tuple[float, float, float, float, float, float]
"""The ball relative to the player, its velocity, and that of the player, all in the body frame."""

HORIZON: Final = 100
"""Cycles covered by the tables below; by then, a ball is practically at rest."""

BACK: Final = 2.5
"""Metres up to which a player moves backwards to a ball."""

PUSH: Final = DASH_RATE * POWER_MAX
NARROW: Final = 0.9 * REACH
"""How far beside the line of motion a near target may lie, in metres."""


def table(values: ArrayLike) -> NDArray[np.float64]:
    """Return numbers that kernels look up and nobody changes."""
    numbers = np.array(values, dtype=np.float64)
    numbers.flags.writeable = False
    return numbers


_CYCLES: Final = np.arange(HORIZON + 1)

BALL_PATH: Final = table((1.0 - BALL_DECAY**_CYCLES) / (1.0 - BALL_DECAY))
"""How far a ball rolls in k cycles, in units of its velocity."""

BALL_SLOWING: Final = table(BALL_DECAY**_CYCLES)
"""The speed of a ball after k cycles, in units of its velocity."""

ROLL: Final = table((1.0 - PLAYER_DECAY**_CYCLES) / (1.0 - PLAYER_DECAY))
"""How far a player rolls in k cycles without a dash, in units of its velocity."""

LAUNCH: Final = table(1.0 / np.concatenate([ROLL[1:2], ROLL[1:]]))
"""The speed with which a player rolls one metre in k cycles; for 0 cycles as for 1."""


@kernel
def rolled(player: Player, cycles: int) -> tuple[float, float]:
    """Return where a player will be after some cycles without a dash."""
    roll = roll_factor(player[2], player[3], cycles)
    return player[0] + player[2] * roll, player[1] + player[3] * roll


@kernel
def roll_factor(vx: float, vy: float, cycles: int) -> float:
    """Return how far a player rolls without a dash, in units of its velocity."""
    squared = vx * vx + vy * vy
    if squared > PLAYER_SPEED_MAX * PLAYER_SPEED_MAX:
        return float(ROLL[cycles] * PLAYER_SPEED_MAX / math.sqrt(squared))
    return float(ROLL[cycles])


@kernel
def moment(angle: float, speed: float) -> float:
    """Return the moment that turns a player of this speed by an angle between -180 and 180 degrees."""
    return min(max(angle * (1.0 + INERTIA * speed), -MOMENT_MAX), MOMENT_MAX)


@kernel
def turn_limit(speed: float) -> float:
    """Return the largest angle, in degrees, by which a player of this speed turns in one cycle."""
    return MOMENT_MAX / (1.0 + INERTIA * speed)


@kernel
def dash_power(forward: float, velocity: float, cycles: int) -> float:
    """Return the power of the dash after which a player rolls to a point in some cycles; 0 counts as 1.

    The point lies ``forward`` metres in front of the player, which moves there with ``velocity``.
    """
    speed: float = min(forward * LAUNCH[cycles], PLAYER_SPEED_MAX)
    return min(max((speed - velocity) / DASH_RATE, -POWER_MAX), POWER_MAX)


@kernel
def turn_towards(x: float, y: float, speed: float) -> tuple[float, float, bool]:
    """Turn towards a point of the body frame in one cycle, as far as the speed allows.

    Return cosine and sine of the turn, and whether the player faces the point then.
    """
    distance = math.sqrt(x * x + y * y)
    if distance == 0.0:
        return 1.0, 0.0, True
    limit = turn_limit(speed)
    # An angle below 90 degrees never exceeds a limit above; most turns need no trigonometry.
    complete = limit >= 180.0 or (x >= 0.0 and limit >= 90.0)
    angle = 0.0
    if not complete:
        angle = math.degrees(math.atan2(y, x))
        if angle <= -180.0 + TIE:
            angle = 180.0
        complete = abs(angle) <= limit
    if complete:
        return x / distance, y / distance, True
    radians = math.radians(math.copysign(limit, angle))
    return math.cos(radians), math.sin(radians), False


@kernel
def steer(pursuit: Pursuit, cycles: int, back: float) -> tuple[bool, float, float]:
    """Decide how to reach a target in some cycles: whether to turn, and to which point of the body frame.

    A player turns if the line along its body would pass the target too far to the side, or if the target lies
    behind it further than ``back`` metres. Lines and distances are those from where the player will have
    rolled by then, in at most four cycles. If one turn is not enough, the target is near and time is short,
    it may turn its back to the target instead.
    """
    tx, ty, vx, vy = pursuit
    roll = roll_factor(vx, vy, min(cycles, 4))
    x, y = tx - vx * roll, ty - vy * roll
    squared = x * x + y * y
    away = tx * tx + ty * ty
    width = NARROW
    if away > (10.0 + TIE) * (10.0 + TIE):
        width = 3.0 * REACH if away > (20.0 + TIE) * (20.0 + TIE) else 2.0 * REACH
    if abs(y) <= width and (x >= 0.0 or squared <= (back + TIE) * (back + TIE)):
        return False, 0.0, 0.0
    if cycles < 4 and squared < (back - TIE) * (back - TIE):
        speed = math.sqrt(vx * vx + vy * vy)
        cosine, sine, complete = turn_towards(x, y, speed)
        if not complete and abs(y * cosine - x * sine) > width:
            cosine, sine, complete = turn_towards(-x, -y, speed)
            if abs(y * cosine - x * sine) < NARROW:
                return True, -x, -y
    return True, x, y


@kernel
def after_turn(pursuit: Pursuit, x: float, y: float) -> tuple[Pursuit, float, float]:
    """Turn towards a point of the body frame and roll for one cycle.

    Return the pursuit in the new body frame, and cosine and sine of the turn.
    """
    tx, ty, vx, vy = pursuit
    speed = math.sqrt(vx * vx + vy * vy)
    cosine, sine, _ = turn_towards(x, y, speed)
    if speed > PLAYER_SPEED_MAX:
        vx *= PLAYER_SPEED_MAX / speed
        vy *= PLAYER_SPEED_MAX / speed
    tx -= vx
    ty -= vy
    vx *= PLAYER_DECAY
    vy *= PLAYER_DECAY
    rotated = (
        tx * cosine + ty * sine,
        ty * cosine - tx * sine,
        vx * cosine + vy * sine,
        vy * cosine - vx * sine,
    )
    return rotated, cosine, sine


@kernel
def after_dash(pursuit: Pursuit, power: float) -> Pursuit:
    """Dash for one cycle."""
    tx, ty, vx, vy = pursuit
    vx += DASH_RATE * power
    squared = vx * vx + vy * vy
    if squared > PLAYER_SPEED_MAX * PLAYER_SPEED_MAX:
        scale = PLAYER_SPEED_MAX / math.sqrt(squared)
        vx *= scale
        vy *= scale
    return tx - vx, ty - vy, vx * PLAYER_DECAY, vy * PLAYER_DECAY


@kernel
def approach_of(me: Player, ball: Ball, c: float, s: float) -> Approach:
    """Turn player and ball into the body frame with the x axis (c, s)."""
    x, y = ball[0] - me[0], ball[1] - me[1]
    return (
        x * c + y * s,
        y * c - x * s,
        ball[2] * c + ball[3] * s,
        ball[3] * c - ball[2] * s,
        me[2] * c + me[3] * s,
        me[3] * c - me[2] * s,
    )


@kernel
def pursuit_of(approach: Approach, path: float) -> Pursuit:
    """Return the pursuit of where the ball is after rolling ``path`` times its velocity."""
    x, y, bvx, bvy, vx, vy = approach
    return x + path * bvx, y + path * bvy, vx, vy
