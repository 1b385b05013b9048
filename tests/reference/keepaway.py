"""The programs of the keepaway players, written plainly: kicks, positions, roles, the hand-coded policy.

The twin of the compiled players of ``relforest.worlds.keepaway``, with ``reference.keepaway_sight`` and
``reference.keepaway_motion``: one function per concept, everything by trigonometry and by simulation step by
step, nothing left out because it cannot matter and nothing kept that can be computed again. The programs are
those of the players that Stone et al. (2006) released for the RoboCup 2-D server.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from reference.keepaway_compiling import kernel
from reference.keepaway_motion import (
    ENDLESS,
    PLAYER_DECAY,
    after,
    ball_after,
    cycles_to_ball,
    dash_to,
    face,
    fastest_mate,
    fastest_opponent,
    intercept,
    rolled,
    turn_moment,
    turned,
)
from reference.keepaway_sight import (
    BALL_DECAY,
    BALL_SPEED,
    KICK,
    LAST_ACTION,
    LAST_TIME,
    REACH,
    TOUCH,
    Body,
    Command,
    Point,
    Sight,
    ball_place,
    ball_velocity,
    bearing,
    below,
    body,
    distance,
    expect_ball,
    is_left,
    look,
    minus,
    nearest,
    nearest_mate,
    nearest_of,
    nearest_opponent,
    norm,
    place,
    plus,
    polar,
    rotated,
    size,
    speed,
    team_of,
    whole,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

KICK_RATE: Final = 0.027
KICK_ACCELERATION: Final = 2.7
PASS_END_SPEED: Final = 1.2


@kernel
def kick_rate(sight: Sight) -> float:
    """Return how much a kick of power 1 accelerates the ball where it is now."""
    me = body(sight, sight.me)
    offset = minus(ball_place(sight), place(me))
    aside = abs(norm(bearing(offset) - me.angle))
    return KICK_RATE * (1.0 - 0.25 * aside / 180.0 - 0.25 * (size(offset) - TOUCH) / 0.7)


@kernel
def kick(sight: Sight, power: float, direction: float) -> Command:
    """Return a kick into a direction of the own frame."""
    return Command(KICK, power, norm(direction - body(sight, sight.me).angle))


@kernel
def full_power(sight: Sight, wanted: Point) -> Command:
    """Return a kick of full power after which the ball moves in the direction of ``wanted``."""
    across = rotated(ball_velocity(sight), -bearing(wanted)).y
    share = min(max(across / (100.0 * kick_rate(sight)), -1.0), 1.0)
    return kick(sight, 100.0, bearing(wanted) - math.degrees(math.asin(share)))


@kernel
def accelerate_to(sight: Sight, wanted: Point) -> Command:
    """Return the kick that gives the ball a velocity, or its direction at least."""
    change, rate = minus(wanted, ball_velocity(sight)), kick_rate(sight)
    if size(change) < KICK_ACCELERATION and size(change) / rate <= 100.0:
        return kick(sight, size(change) / rate, bearing(change))
    return full_power(sight, wanted)


@kernel
def freeze(sight: Sight) -> Command:
    """Return the kick that stops the ball, or that keeps it close."""
    motion, ball = ball_velocity(sight), ball_place(sight)
    me = place(rolled(body(sight, sight.me), 1))
    power = min(100.0, size(motion) / kick_rate(sight))
    against = bearing(motion) + 180.0
    stopped = plus(motion, polar(power * kick_rate(sight), against))
    if distance(plus(ball, stopped), me) < 0.8 * REACH:
        return kick(sight, power, against)
    offset = minus(ball, me)
    goal = plus(me, polar(min(0.7 * REACH, size(offset) - 0.1), bearing(offset)))
    return accelerate_to(sight, minus(goal, ball))


@kernel
def kick_close(sight: Sight, angle: float, ratio: float) -> Command:
    """Return the kick that brings the ball beside the body at an angle relative to it."""
    me = body(sight, sight.me)
    goal = plus(place(rolled(me, 1)), polar(TOUCH + 0.7 * ratio, me.angle + angle))
    change = minus(minus(goal, ball_place(sight)), ball_velocity(sight))
    power = size(change) / kick_rate(sight)
    if power > 100.0 and below(0.1, size(ball_velocity(sight))):
        return freeze(sight)
    return kick(sight, min(power, 100.0), bearing(change))


@kernel
def hold(sight: Sight, ratio: float) -> Command:
    """Return the command that keeps the ball away from the opponent that is nearest to it."""
    me, ball = body(sight, sight.me), ball_place(sight)
    opponent = body(sight, nearest_opponent(sight, ball))
    angle = 0.0
    if below(distance(place(opponent), ball), 5.0):
        threat = bearing(minus(place(me), place(opponent)))
        side = -1.0 if is_left(opponent.angle - threat) else 1.0
        angle = norm(threat + 45.0 * side - me.angle)
    if below(distance(ball, plus(place(me), polar(ratio, angle))), 0.3):
        turn = face(me, Point(52.5, 0.0), 1)
        if distance(place(after(me, turn)), ball_after(sight, 1)) < 0.85 * REACH:
            return turn
    return kick_close(sight, angle, ratio)


@kernel
def pass_velocity(sight: Sight, target: Point) -> Point:
    """Return the velocity with which a pass arrives at its end speed and does not hit the passer."""
    me, ball = body(sight, sight.me), ball_place(sight)
    way = minus(target, ball)
    cycles = nearest(
        math.log(1.0 + size(way) * (1.0 / BALL_DECAY - 1.0) / PASS_END_SPEED) / math.log(1.0 / BALL_DECAY)
    )
    pace = PASS_END_SPEED * BALL_DECAY ** (-cycles)
    direction = bearing(way)
    soon = place(rolled(me, 1))
    if distance(soon, plus(ball, polar(pace, direction))) < TOUCH:
        foot = abs(rotated(minus(soon, ball), -direction).x)
        pace = foot - TOUCH if pace < foot else foot + TOUCH
    return polar(pace, direction)


@kernel
def pass_to(sight: Sight, target: Point) -> Command:
    """Return the kick of a pass, or a kick that prepares it."""
    wanted, motion, rate = pass_velocity(sight, target), ball_velocity(sight), kick_rate(sight)
    if size(wanted) > BALL_SPEED:
        kicked = full_power(sight, wanted)
        push = polar(100.0 * rate, body(sight, sight.me).angle + kicked.direction)
        if size(plus(motion, push)) > 0.85 * KICK_ACCELERATION:
            return kicked
        return freeze(sight) if rate > 0.85 * KICK_RATE else kick_close(sight, 0.0, 0.16)
    power = size(minus(wanted, motion)) / rate
    ball = ball_place(sight)
    is_pressed = below(distance(place(body(sight, nearest_opponent(sight, ball))), ball), 2.0)
    if power <= 105.0 or (is_pressed and power <= 130.0):
        return accelerate_to(sight, wanted)
    return kick_close(sight, 0.0, 0.16)


@kernel
def is_in_cone(sight: Sight, player: int, tip: Point, end: Point) -> bool:
    """Return whether a player could cut off a pass from ``tip`` to ``end``."""
    where = minus(place(body(sight, player)), tip)
    way = minus(end, tip)
    across = rotated(where, -bearing(way))
    is_between = below(0.0, across.x) and below(across.x, size(way))
    return is_between and below(abs(across.y), 0.3 * across.x) and below(size(where), size(way))


@kernel
def opponents_in_cone(sight: Sight, takers: tuple[int, int], tip: Point, end: Point) -> int:
    count = 0
    for j in range(takers[0], takers[1]):
        if is_in_cone(sight, j, tip, end):
            count += 1
    return count


@kernel
def congestion(sight: Sight, point: Point) -> float:
    """Return how crowded a point is with other players than the observer."""
    total = 0.0
    for j in range(len(sight.players)):
        if j != sight.me:
            total += 1.0 / distance(place(body(sight, j)), point)
    return total


@kernel
def open_place(sight: Sight, origin: Point) -> Point:
    """Return the least crowded point of a grid to which a pass from ``origin`` is free."""
    takers = (sight.keepers, len(sight.players))
    best, least = Point(0.0, 0.0), math.inf
    for row in range(5):
        for column in range(5):
            point = Point(0.175 * (row - 2) * sight.length, 0.175 * (column - 2) * sight.width)
            if opponents_in_cone(sight, takers, origin, point) == 0 and congestion(sight, point) < least:
                best, least = point, congestion(sight, point)
    return best


@kernel
def get_open(sight: Sight, passer: int) -> Command:
    me = body(sight, sight.me)
    goal = open_place(sight, ball_after(sight, cycles_to_ball(sight, passer)))
    if distance(place(me), goal) < 1.5:
        return face(me, ball_place(sight), 1)
    return move_to(me, goal, 7.0, 0.0)


@kernel
def move_to(player: Body, target: Point, tolerance: float, back: float) -> Command:
    """Return the next command of a player that runs to a point, turning only if it is far off."""
    end = Point(player.x + player.vx / (1.0 - PLAYER_DECAY), player.y + player.vy / (1.0 - PLAYER_DECAY))
    direction = bearing(minus(target, end))
    angle = norm(direction - player.angle)
    is_behind = abs(norm(angle + 180.0)) < tolerance and distance(target, place(player)) < back
    if abs(angle) < tolerance or is_behind:
        return dash_to(player, target, 1)
    turning, n_turns = player, 0
    while n_turns < 3 and abs(norm(direction - turning.angle)) >= tolerance:
        turning = turned(turning, turn_moment(norm(direction - turning.angle), speed(turning)))
        n_turns += 1
    return face(player, target, 2) if n_turns < 3 else dash_to(player, place(player), 1)


@kernel
def mark(sight: Sight) -> Command:
    """Return the next command of a taker that covers the keeper to whom a pass is freest."""
    me, ball = body(sight, sight.me), ball_place(sight)
    takers = (sight.keepers, len(sight.players))
    tip = place(body(sight, fastest_opponent(sight)))
    freest, fewest = -1, ENDLESS
    for k in range(sight.keepers - 1, -1, -1):
        count = opponents_in_cone(sight, takers, tip, place(body(sight, k)))
        if count < fewest:
            freest, fewest = k, count
    keeper = place(body(sight, freest))
    shifted = Point(keeper.x - 1.0, keeper.y)
    target = plus(shifted, polar(4.0, bearing(minus(ball, shifted))))
    if distance(place(me), target) >= 2.0:
        return move_to(me, target, 25.0, 3.0)
    towards = bearing(minus(keeper, place(me)))
    side = 1.0 if is_left(bearing(minus(ball, place(me))) - towards) else -1.0
    return face(me, plus(place(me), polar(1.0, towards + 80.0 * side)), 1)


@kernel
def in_reach(sight: Sight) -> bool:
    return distance(place(body(sight, sight.me)), ball_place(sight)) < REACH


@kernel
def continues_pass(memory: NDArray[np.float64], now: int) -> bool:
    return bool(memory[LAST_TIME] == now - 1 and memory[LAST_ACTION] > 0)


@kernel
def keeper_command(sight: Sight, memory: NDArray[np.float64], now: int, action: int) -> Command:
    """Return a keeper's command; ``action`` is its decision if it has to make one: 0 = hold, a = pass."""
    if in_reach(sight):
        if continues_pass(memory, now):
            action = int(memory[LAST_ACTION])
        memory[LAST_ACTION], memory[LAST_TIME] = action, now
        if action == 0:
            return hold(sight, 0.7)
        return pass_to(sight, place(body(sight, nearest_mate(sight, action))))
    first = fastest_mate(sight)
    return intercept(sight, memory, now) if first == sight.me else get_open(sight, first)


@kernel
def taker_command(sight: Sight, memory: NDArray[np.float64], now: int) -> Command:
    ball, me = ball_place(sight), sight.me
    takers = team_of(sight, me)
    nearest_taker = nearest_of(sight, takers, ball)
    if in_reach(sight) and nearest_taker == me:
        return hold(sight, 0.3)
    nearer = 0
    for j in range(takers[0], takers[1]):
        further = distance(place(body(sight, j)), ball) - distance(place(body(sight, me)), ball)
        if below(further, 0.0) or (j > me and not below(0.0, further)):
            nearer += 1
    if takers[1] - takers[0] > 2 and nearer >= 2:
        return mark(sight)
    first = nearest_of(sight, (0, len(sight.players)), ball)
    is_taker = first >= sight.keepers and first != me
    if is_taker and distance(place(body(sight, first)), ball) < REACH:
        return face(body(sight, me), ball_after(sight, 1), 1)
    return intercept(sight, memory, now)


@kernel
def expect(sight: Sight, memory: NDArray[np.float64], command: Command) -> None:
    """Note the velocity that the ball should have after the observer's own kick."""
    if command.kind != KICK:
        return
    angle = body(sight, sight.me).angle + whole(command.direction)
    motion = plus(ball_velocity(sight), polar(whole(command.amount) * kick_rate(sight), angle))
    fast = max(size(motion) / BALL_SPEED, 1.0)
    expect_ball(memory, Point(motion.x / fast, motion.y / fast))


@kernel
def hand_coded(sight: Sight) -> int:
    """Return the action of the hand-coded policy: hold unless a taker is near, else the freest pass."""
    holder = nearest_of(sight, (0, sight.keepers), ball_place(sight))
    origin = place(body(sight, holder))
    takers = (sight.keepers, len(sight.players))
    taker = place(body(sight, nearest_of(sight, takers, origin)))
    if below(5.0, distance(origin, taker)):
        return 0
    as_holder = Sight(sight.players, sight.ball, holder, sight.keepers, sight.length, sight.width)
    best, score = 0, 90.0
    for action in range(1, sight.keepers):
        mate = place(body(sight, nearest_mate(as_holder, action)))
        least_distance, least_angle = math.inf, 180.0
        for j in range(takers[0], takers[1]):
            other = place(body(sight, j))
            angle = abs(norm(bearing(minus(mate, origin)) - bearing(minus(other, origin))))
            least_distance = min(least_distance, distance(mate, other))
            least_angle = min(least_angle, angle)
        if below(score, 4.0 * least_distance + least_angle):
            best, score = action, 4.0 * least_distance + least_angle
    return best


@kernel
def integers(command: Command) -> tuple[int, int, int]:
    """Return a command as the server takes it."""
    return command.kind, whole(command.amount), whole(command.direction)


class Cycle(NamedTuple):
    """What all players perceive and command in one cycle."""

    views: NDArray[np.float64]  # (n, n, 5) player j as i perceives it, in the frame of i
    balls: NDArray[np.float64]  # (n, 4) the ball as i perceives it, in the frame of i
    commands: NDArray[np.int64]  # (n, 3) kind, power or moment, direction
    hand_coded: NDArray[np.int64]  # (n,) decisions of the hand-coded policy, -1 = no decision is due


@kernel
def play_cycle(
    players: NDArray[np.float64],
    ball: NDArray[np.float64],
    setup: tuple[int, int, float, float, int],
    memory: NDArray[np.float64],
    now: int,
    actions: NDArray[np.int64],
) -> Cycle:
    """Return one cycle of a game in a true state; ``actions`` (n,) are decisions of keepers, where due.

    ``setup`` is as for `look`; ``memory`` (n, N_MEMORY) changes in place.
    """
    n_players = len(players)
    views, balls = np.empty((n_players, n_players, 5)), np.empty((n_players, 4))
    commands = np.empty((n_players, 3), dtype=np.int64)
    hand = np.full(n_players, -1)
    for i in range(n_players):
        sight = look(players, ball, i, setup, memory[i])
        if i >= setup[0]:
            command = taker_command(sight, memory[i], now)
        else:
            if in_reach(sight) and not continues_pass(memory[i], now):
                hand[i] = hand_coded(sight)
            command = keeper_command(sight, memory[i], now, actions[i])
        expect(sight, memory[i], command)
        views[i], balls[i] = sight.players, sight.ball
        commands[i, 0], commands[i, 1], commands[i, 2] = integers(command)
    return Cycle(views, balls, commands, hand)
