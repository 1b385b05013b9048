"""One cycle of the world, as the RoboCup 2-D server computes it: commands, motion, collisions.

All commands of a cycle take effect at the state in which they were chosen; then everything moves, and what
overlaps is pushed apart. The numbers are those of server versions 13 to 16 with players of the default type.
Lengths are metres, speeds metres per cycle, angles degrees.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.support.jit import inlined, kernel
from relforest.worlds.keepaway.server.layout import BODY, DASH, KICK, TURN, VX, VY, Games, Setup, X, Y
from relforest.worlds.keepaway.server.randomness import uniform
from relforest.worlds.keepaway.server.referee import REACH

PLAYER_RADIUS: Final = 0.3
BALL_RADIUS: Final = 0.085
TOUCH_BALL: Final = PLAYER_RADIUS + BALL_RADIUS
TOUCH_PLAYER: Final = 2.0 * PLAYER_RADIUS
KICKABLE_MARGIN: Final = 0.7

PLAYER_DECAY: Final = 0.4
PLAYER_NOISE: Final = 0.1
PLAYER_SPEED_MAX: Final = 1.05
PLAYER_ACCELERATION_MAX: Final = 1.0
BALL_DECAY: Final = 0.94
BALL_NOISE: Final = 0.05
BALL_SPEED_MAX: Final = 3.0
BALL_ACCELERATION_MAX: Final = 2.7

DASH_RATE: Final = 0.006
KICK_RATE: Final = 0.027
KICK_NOISE: Final = 0.1
TURN_NOISE: Final = 0.1
INERTIA: Final = 5.0
POWER_MAX: Final = 100
MOMENT_MAX: Final = 180
BOUNCE: Final = -0.1
"""What remains of the velocity of an object after a collision."""

_ROUNDS: Final = 10
_RADIANS: Final = math.pi / 180.0


@kernel
def execute(games: Games, g: int, setup: Setup) -> None:
    """Carry out the commands of game ``g`` and move everything on by one cycle.

    Random numbers are drawn in this order: for each player those of its command and of its motion, then those
    of the ball's motion, then those of collisions.
    """
    players, ball = games.players, games.ball
    n_players = setup.keepers + setup.takers
    kick_x, kick_y = 0.0, 0.0
    # The ball has not moved yet, and a kick needs the kicker's own state only, so players may go one by one.
    for i in range(n_players):
        verb, amount = games.commands[g, i, 0], games.commands[g, i, 1]
        dash_x, dash_y, turned = 0.0, 0.0, 0.0
        if verb == DASH:
            push = DASH_RATE * min(max(amount, -POWER_MAX), POWER_MAX)
            dash_x = push * math.cos(players[g, i, BODY] * _RADIANS)
            dash_y = push * math.sin(players[g, i, BODY] * _RADIANS)
        elif verb == TURN:
            turned = _turn(games, g, i)
        elif verb == KICK:
            x, y = _kick(games, g, i)
            kick_x += x
            kick_y += y
        # Bodies turn at the speed at which the cycle began.
        players[g, i, BODY] = normalised(players[g, i, BODY] + turned)
        _accelerate(players[g, i], dash_x, dash_y, PLAYER_ACCELERATION_MAX, PLAYER_SPEED_MAX)
        _move(games.streams, g, players[g, i], PLAYER_NOISE, PLAYER_DECAY)
    _accelerate(ball[g], kick_x, kick_y, BALL_ACCELERATION_MAX, BALL_SPEED_MAX)
    _move(games.streams, g, ball[g], BALL_NOISE, BALL_DECAY)
    if _overlapping(players[g], ball[g], n_players):
        separate(games, g, n_players)


@inlined
def normalised(angle: float) -> float:
    """The same angle between -180 and 180 degrees, if it lies within one turn of them."""
    return angle - 360.0 if angle > 180.0 else (angle + 360.0 if angle < -180.0 else angle)


@kernel
def kick_rate(distance: float, angle: float) -> float:
    """How much a kick moves the ball, in metres per cycle per unit of power.

    ``distance`` is that of the centres of player and ball, and ``angle`` that of the ball from the player's
    body direction, 0 to 180 degrees.
    """
    gap = distance - TOUCH_BALL
    return KICK_RATE * (1.0 - 0.25 * angle / 180.0 - 0.25 * gap / KICKABLE_MARGIN)


@kernel
def kick_noise(power: float, distance: float, angle: float, ball_speed: float) -> float:
    """The largest error of a kick, in metres per cycle; the arguments are those of `kick_rate`."""
    gap = distance - TOUCH_BALL
    place = 0.25 * (angle / 180.0 + gap / KICKABLE_MARGIN)
    speed = 0.5 * ball_speed / (BALL_SPEED_MAX * BALL_DECAY)
    return KICK_NOISE * abs(power) / POWER_MAX * (0.5 + place + 0.5 + speed)


@kernel
def _turn(games: Games, g: int, i: int) -> float:
    me = games.players[g, i]
    moment = min(max(games.commands[g, i, 1], -MOMENT_MAX), MOMENT_MAX)
    speed = math.hypot(me[VX], me[VY])
    noise = uniform(games.streams, g, -TURN_NOISE, TURN_NOISE)
    return float((1.0 + noise) * moment / (1.0 + INERTIA * speed))


@kernel
def _kick(games: Games, g: int, i: int) -> tuple[float, float]:
    """What player ``i`` adds to the velocity of the ball: nothing if the ball is out of reach."""
    me, ball = games.players[g, i], games.ball[g]
    x, y = ball[X] - me[X], ball[Y] - me[Y]
    distance = math.hypot(x, y)
    if not distance <= REACH:
        return 0.0, 0.0
    power = min(max(games.commands[g, i, 1], -POWER_MAX), POWER_MAX)
    direction = min(max(games.commands[g, i, 2], -MOMENT_MAX), MOMENT_MAX)
    angle = abs(normalised(math.atan2(y, x) / _RADIANS - me[BODY]))
    strength = power * kick_rate(distance, angle)
    heading = (me[BODY] + direction) * _RADIANS
    largest = kick_noise(power, distance, angle, math.hypot(ball[VX], ball[VY]))
    error = uniform(games.streams, g, 0.0, largest)
    course = uniform(games.streams, g, -math.pi, math.pi)
    kick_x = strength * math.cos(heading) + error * math.cos(course)
    kick_y = strength * math.sin(heading) + error * math.sin(course)
    return kick_x, kick_y


@inlined
def _accelerate(thing: NDArray[np.float64], x: float, y: float, most: float, speed_max: float) -> None:
    """Add an acceleration, limiting both it and the speed. Without one, the speed is not limited."""
    if x != 0.0 or y != 0.0:
        size = math.hypot(x, y)
        scale = most / size if size > most else 1.0
        thing[VX] += x * scale
        thing[VY] += y * scale
        speed = math.hypot(thing[VX], thing[VY])
        if speed > speed_max:
            thing[VX] *= speed_max / speed
            thing[VY] *= speed_max / speed


@inlined
def _move(streams: NDArray[np.int64], g: int, thing: NDArray[np.float64], noise: float, decay: float) -> None:
    """Disturb the velocity in proportion to the speed, move, and slow down; what stands still stays there."""
    speed = math.hypot(thing[VX], thing[VY])
    if speed > 0.0:
        error = uniform(streams, g, 0.0, noise * speed)
        course = uniform(streams, g, -math.pi, math.pi)
        thing[VX] += error * math.cos(course)
        thing[VY] += error * math.sin(course)
        thing[X] += thing[VX]
        thing[Y] += thing[VY]
        thing[VX] *= decay
        thing[VY] *= decay


@kernel
def _overlapping(players: NDArray[np.float64], ball: NDArray[np.float64], n_players: int) -> bool:
    for i in range(n_players):
        x, y = players[i, X] - ball[X], players[i, Y] - ball[Y]
        if x * x + y * y < TOUCH_BALL * TOUCH_BALL:
            return True
        for j in range(i):
            x, y = players[i, X] - players[j, X], players[i, Y] - players[j, Y]
            if x * x + y * y < TOUCH_PLAYER * TOUCH_PLAYER:
                return True
    return False


@kernel
def separate(games: Games, g: int, n_players: int) -> None:
    """Push apart overlapping objects in game ``g``, and reverse the velocity of colliding ones at a tenth.

    Every overlapping pair requests places symmetric about its middle at touching distance, in a random
    direction if both are at the same point; every object moves to the mean of the places requested for it.
    This is repeated while anything overlaps, at most ten times.
    """
    players, ball = games.players[g], games.ball[g]
    wishes = np.zeros((n_players + 1, 3))
    collided = np.zeros(n_players + 1, dtype=np.bool_)
    for _ in range(_ROUNDS):
        if not _collect_wishes(games, g, n_players, wishes):
            break
        for i in range(n_players + 1):
            if wishes[i, 2] > 0.0:
                collided[i] = True
                thing = players[i] if i < n_players else ball
                thing[X] = wishes[i, 0] / wishes[i, 2]
                thing[Y] = wishes[i, 1] / wishes[i, 2]
    for i in range(n_players + 1):
        if collided[i]:
            thing = players[i] if i < n_players else ball
            thing[VX] *= BOUNCE
            thing[VY] *= BOUNCE


@kernel
def _collect_wishes(games: Games, g: int, n_players: int, wishes: NDArray[np.float64]) -> bool:
    """Sum the places asked for and count them, per object, the ball last; whether there are any."""
    players, ball = games.players[g], games.ball[g]
    wishes[:] = 0.0
    found = False
    for i in range(n_players + 1):
        one = players[i] if i < n_players else ball
        touch = TOUCH_PLAYER if i < n_players else TOUCH_BALL
        for j in range(min(i, n_players)):
            x, y = one[X] - players[j, X], one[Y] - players[j, Y]
            distance = math.hypot(x, y)
            if distance < touch:
                found = True
                if distance == 0.0:
                    course = uniform(games.streams, g, -math.pi, math.pi)
                    x, y, distance = math.cos(course), math.sin(course), 1.0
                middle_x, middle_y = (one[X] + players[j, X]) / 2.0, (one[Y] + players[j, Y]) / 2.0
                half = touch / (2.0 * distance)
                wishes[i, 0] += middle_x + half * x
                wishes[i, 1] += middle_y + half * y
                wishes[i, 2] += 1.0
                wishes[j, 0] += middle_x - half * x
                wishes[j, 1] += middle_y - half * y
                wishes[j, 2] += 1.0
    return found
