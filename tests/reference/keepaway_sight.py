"""What a keepaway player perceives, written plainly, and the plane geometry that its programs need.

Part of the twin in ``reference.keepaway``. A player knows its `Sight`: all players and the ball as it
perceives them, in its own frame (takers see the field turned by 180 degrees). Lengths are metres, speeds
metres per cycle, angles degrees. Where players are compared, a team is gone through from the last to the
first, and of equals the first found counts.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from reference.keepaway_compiling import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

EXACT: Final = 0
QUANTISED: Final = 1

NONE: Final = 0
DASH: Final = 1
TURN: Final = 2
KICK: Final = 3

# Columns of a player's memory, which is all zero when an episode begins. Times are cycles of the episode.
EXPECTED_VX: Final = 0  # velocity that the ball should have in the next cycle, own frame
EXPECTED_VY: Final = 1
OLD_X: Final = 2  # where it meant to intercept the ball, own frame
OLD_Y: Final = 3
OLD_TIME: Final = 4  # when it meant to, counted from 1; 0 = never
LAST_ACTION: Final = 5
LAST_TIME: Final = 6
N_MEMORY: Final = 7

REACH: Final = 1.085  # a player can kick a ball whose centre is nearer than this
TOUCH: Final = 0.385  # radii of player and ball
BALL_DECAY: Final = 0.94
BALL_SPEED: Final = 3.0

TIE: Final = 1e-7
"""Numbers closer than this are equal."""


class Point(NamedTuple):
    """A point or a vector."""

    x: float
    y: float


class Body(NamedTuple):
    """A player: where it is, its velocity, and the direction it faces."""

    x: float
    y: float
    vx: float
    vy: float
    angle: float


class Command(NamedTuple):
    """What a player is about to do: power or moment, and the direction of a kick relative to the body."""

    kind: int
    amount: float
    direction: float


class Sight(NamedTuple):
    """What player ``me`` perceives in its own frame: players (n, 5), keepers first, and ball (4,)."""

    players: NDArray[np.float64]
    ball: NDArray[np.float64]
    me: int
    keepers: int
    length: float
    width: float


@kernel
def below(a: float, b: float) -> bool:
    """Return whether ``a`` is less than ``b``, by more than rounding may have made of equal numbers.

    What players perceive is quantised, so thresholds are met exactly, and players are at equal distances.
    """
    return a < b - TIE


@kernel
def norm(angle: float) -> float:
    """Return the same direction above -180 and up to 180 degrees."""
    while below(180.0, angle):
        angle -= 360.0
    while not below(-180.0, angle):
        angle += 360.0
    return angle


@kernel
def is_left(angle: float) -> bool:
    """Return whether a direction is counter-clockwise of 0: neither ahead nor straight behind."""
    return below(0.0, norm(angle)) and below(norm(angle), 180.0)


@kernel
def polar(radius: float, angle: float) -> Point:
    return Point(radius * math.cos(math.radians(angle)), radius * math.sin(math.radians(angle)))


@kernel
def plus(a: Point, b: Point) -> Point:
    return Point(a.x + b.x, a.y + b.y)


@kernel
def minus(a: Point, b: Point) -> Point:
    return Point(a.x - b.x, a.y - b.y)


@kernel
def size(a: Point) -> float:
    return math.hypot(a.x, a.y)


@kernel
def bearing(a: Point) -> float:
    """Return the direction of a vector."""
    return math.degrees(math.atan2(a.y, a.x))


@kernel
def distance(a: Point, b: Point) -> float:
    return size(minus(a, b))


@kernel
def rotated(a: Point, angle: float) -> Point:
    return polar(size(a), bearing(a) + angle)


@kernel
def line_distance(target: Point, origin: Point, angle: float) -> float:
    """Return the distance of ``target`` from the infinite line through ``origin``."""
    return abs(rotated(minus(target, origin), -angle).y)


@kernel
def nearest(value: float) -> float:
    return float(math.floor(value + 0.5))


@kernel
def whole(value: float) -> int:
    """Return the integer that a command carries: the fraction is cut off, but rounding must not decide."""
    return int(value + math.copysign(TIE, value))


@kernel
def quantised_distance(exact: float) -> float:
    if exact <= 0.0:
        return 0.0
    return 0.1 * nearest(math.exp(0.1 * nearest(math.log(exact) / 0.1)) / 0.1)


@kernel
def quantised_motion(me: Body, thing: Body) -> Body:
    """Return position and velocity of something that ``me`` sees; its angle is kept."""
    offset = Point(thing.x - me.x, thing.y - me.y)
    exact = size(offset)
    if exact <= 0.0:
        return thing
    relative = rotated(Point(thing.vx - me.vx, thing.vy - me.vy), -bearing(offset))
    seen = quantised_distance(exact)
    direction = me.angle + nearest(norm(bearing(offset) - me.angle))
    radial = seen * 0.02 * nearest(relative.x / exact / 0.02)
    turning = 0.1 * nearest(math.degrees(relative.y / exact) / 0.1)
    position = plus(Point(me.x, me.y), polar(seen, direction))
    velocity = plus(polar(radial, direction), polar(seen * math.radians(turning), direction + 90.0))
    return Body(position.x, position.y, me.vx + velocity.x, me.vy + velocity.y, thing.angle)


@kernel
def perceived_player(me: Body, other: Body, perception: int) -> Body:
    if perception != QUANTISED:
        return other
    angle = norm(me.angle + nearest(norm(other.angle - me.angle)))
    seen = quantised_motion(me, other)
    return Body(seen.x, seen.y, seen.vx, seen.vy, angle)


@kernel
def perceived_ball(me: Body, ball: Body, perception: int, memory: NDArray[np.float64]) -> Body:
    """Return the ball, its velocity averaged with what was expected if that is close."""
    if perception != QUANTISED:
        return ball
    seen = quantised_motion(me, ball)
    expected = Point(memory[EXPECTED_VX], memory[EXPECTED_VY])
    close = 0.1 * size(expected)
    if abs(seen.vx - expected.x) <= close and abs(seen.vy - expected.y) <= close:
        return Body(seen.x, seen.y, (seen.vx + expected.x) / 2, (seen.vy + expected.y) / 2, 0.0)
    return seen


@kernel
def own_frame(sign: float, body: Body) -> Body:
    turn = 0.0 if sign > 0 else 180.0
    return Body(sign * body.x, sign * body.y, sign * body.vx, sign * body.vy, norm(body.angle + turn))


@kernel
def look(
    players: NDArray[np.float64],
    ball: NDArray[np.float64],
    me: int,
    setup: tuple[int, int, float, float, int],
    memory: NDArray[np.float64],
) -> Sight:
    """Return what a player perceives of the true state, and note the velocity the ball should have next.

    ``setup`` = keepers, takers, length, width, perception (0 exact, 1 quantised, 2 full state).
    """
    keepers, _, length, width, perception = setup
    sign = 1.0 if me < keepers else -1.0
    n_players = len(players)
    sight = Sight(np.empty((n_players, 5)), np.empty(4), me, keepers, length, width)
    own = own_frame(sign, to_body(players[me]))
    for j in range(n_players):
        other = own_frame(sign, to_body(players[j]))
        seen = own if j == me else perceived_player(own, other, perception)
        for column in range(5):
            sight.players[j, column] = seen[column]
    thing = own_frame(sign, Body(ball[0], ball[1], ball[2], ball[3], 0.0))
    seen = perceived_ball(own, thing, perception, memory)
    for column in range(4):
        sight.ball[column] = seen[column]
    if perception in (EXACT, QUANTISED) and held_by_opponent(sight):
        sight.ball[2:] = 0.0
    expect_ball(memory, ball_velocity(sight))
    return sight


@kernel
def expect_ball(memory: NDArray[np.float64], motion: Point) -> None:
    """Note the velocity that the ball should have in the next cycle if it has this one now."""
    memory[EXPECTED_VX], memory[EXPECTED_VY] = BALL_DECAY * motion.x, BALL_DECAY * motion.y


@kernel
def held_by_opponent(sight: Sight) -> bool:
    """Return whether an opponent has the ball in reach and the observer has not."""
    ball = ball_place(sight)
    if distance(place(body(sight, sight.me)), ball) <= REACH:
        return False
    return distance(place(body(sight, nearest_opponent(sight, ball))), ball) <= REACH


@kernel
def to_body(row: NDArray[np.float64]) -> Body:
    return Body(row[0], row[1], row[2], row[3], row[4])


@kernel
def body(sight: Sight, player: int) -> Body:
    return to_body(sight.players[player])


@kernel
def place(player: Body) -> Point:
    return Point(player.x, player.y)


@kernel
def velocity(player: Body) -> Point:
    return Point(player.vx, player.vy)


@kernel
def speed(player: Body) -> float:
    return size(velocity(player))


@kernel
def ball_place(sight: Sight) -> Point:
    return Point(sight.ball[0], sight.ball[1])


@kernel
def ball_velocity(sight: Sight) -> Point:
    return Point(sight.ball[2], sight.ball[3])


@kernel
def team_of(sight: Sight, player: int) -> tuple[int, int]:
    """Return the first index of a player's team and the index after its last."""
    if player < sight.keepers:
        return 0, sight.keepers
    return sight.keepers, len(sight.players)


@kernel
def opponents_of(sight: Sight, player: int) -> tuple[int, int]:
    if player < sight.keepers:
        return sight.keepers, len(sight.players)
    return 0, sight.keepers


@kernel
def nearest_of(sight: Sight, team: tuple[int, int], point: Point) -> int:
    """Return the member of a team that is nearest to a point."""
    best = team[1] - 1
    for j in range(team[1] - 1, team[0] - 1, -1):
        if below(distance(place(body(sight, j)), point), distance(place(body(sight, best)), point)):
            best = j
    return best


@kernel
def nearest_opponent(sight: Sight, point: Point) -> int:
    return nearest_of(sight, opponents_of(sight, sight.me), point)


@kernel
def nearest_mate(sight: Sight, rank: int) -> int:
    """Return the ``rank``-th nearest teammate of the observer, counted from 1."""
    team = team_of(sight, sight.me)
    origin = place(body(sight, sight.me))
    taken = np.zeros(len(sight.players), dtype=np.bool_)
    taken[sight.me] = True
    best = sight.me
    for _ in range(rank):
        best = -1
        for j in range(team[1] - 1, team[0] - 1, -1):
            if not taken[j] and (
                best < 0
                or below(distance(place(body(sight, j)), origin), distance(place(body(sight, best)), origin))
            ):
                best = j
        taken[best] = True
    return best
