"""How a keepaway player predicts motion, moves and intercepts the ball, written plainly.

Part of the twin in ``reference.keepaway``. Plans are simulated cycle after cycle.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from reference.keepaway_compiling import kernel
from reference.keepaway_sight import (
    BALL_DECAY,
    BALL_SPEED,
    DASH,
    NONE,
    OLD_TIME,
    OLD_X,
    OLD_Y,
    REACH,
    TOUCH,
    TURN,
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
    line_distance,
    minus,
    nearest_opponent,
    norm,
    opponents_of,
    place,
    plus,
    polar,
    rotated,
    size,
    speed,
    team_of,
    velocity,
    whole,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

PLAYER_SPEED: Final = 1.05
PLAYER_DECAY: Final = 0.4
DASH_RATE: Final = 0.006
NEVER: Final = -1000.0
ENDLESS: Final = 100_000
"""No plan takes as many cycles: a guard against loops that should not exist."""


@kernel
def ball_after(sight: Sight, cycles: int) -> Point:
    """Return where the ball will be if nobody touches it."""
    point, step = ball_place(sight), ball_velocity(sight)
    for _ in range(cycles):
        point = plus(point, step)
        step = Point(BALL_DECAY * step.x, BALL_DECAY * step.y)
    return point


@kernel
def dashed(player: Body, power: float) -> Body:
    """Return a player one cycle later."""
    push = polar(DASH_RATE * power, player.angle)
    vx, vy = player.vx + push.x, player.vy + push.y
    fast = math.hypot(vx, vy) / PLAYER_SPEED
    if fast > 1.0:
        vx, vy = vx / fast, vy / fast
    return Body(player.x + vx, player.y + vy, PLAYER_DECAY * vx, PLAYER_DECAY * vy, player.angle)


@kernel
def turned(player: Body, moment: float) -> Body:
    """Return a player one cycle later."""
    angle = norm(player.angle + moment / (1.0 + 5.0 * speed(player)))
    return dashed(Body(player.x, player.y, player.vx, player.vy, angle), 0.0)


@kernel
def after(player: Body, command: Command) -> Body:
    """Return a player one cycle after a turn or a dash."""
    return turned(player, command.amount) if command.kind == TURN else dashed(player, command.amount)


@kernel
def rolled(player: Body, cycles: int) -> Body:
    """Return a player that does nothing for some cycles."""
    for _ in range(cycles):
        player = dashed(player, 0.0)
    return player


@kernel
def turn_moment(angle: float, pace: float) -> float:
    """Return the moment that turns a player of this speed by ``angle``, as far as one turn can."""
    return min(max(angle * (1.0 + 5.0 * pace), -180.0), 180.0)


@kernel
def dash_power(player: Body, target: Point, cycles: int) -> float:
    """Return the power of the first of some dashes that end beside the target."""
    forward = rotated(minus(target, place(player)), -player.angle).x
    wanted = min(forward * (1.0 - PLAYER_DECAY) / (1.0 - PLAYER_DECAY ** max(cycles, 1)), PLAYER_SPEED)
    present = rotated(velocity(player), -player.angle).x
    return min(max((wanted - present) / DASH_RATE, -100.0), 100.0)


@kernel
def dash_to(player: Body, target: Point, cycles: int) -> Command:
    return Command(DASH, dash_power(player, target, cycles), 0.0)


@kernel
def face(player: Body, target: Point, cycles: int) -> Command:
    """Return the turn towards a point as seen from where the player will be after some cycles."""
    direction = bearing(minus(target, place(rolled(player, cycles))))
    return Command(TURN, turn_moment(norm(direction - player.angle), speed(player)), 0.0)


@kernel
def turn_ahead(player: Body) -> Command:
    """Return the turn towards the player's own +x."""
    return Command(TURN, turn_moment(norm(-player.angle), speed(player)), 0.0)


@kernel
def move(player: Body, target: Point, cycles: int) -> Command:
    """Return the next command of a player that wants to be at a point in some cycles."""
    back = 2.5
    start = place(rolled(player, min(cycles, 4)))
    direction, far = bearing(minus(target, start)), distance(start, target)
    whence = distance(place(player), target)
    beside = REACH * (3.0 if below(20.0, whence) else 2.0 if below(10.0, whence) else 0.9)
    turning, n_turns, first = player, 0, 0.0
    while n_turns < 5 and (
        below(beside, line_distance(target, start, turning.angle))
        or (below(back, far) and below(90.0, abs(norm(direction - turning.angle))))
    ):
        moment = turn_moment(norm(direction - turning.angle), speed(turning))
        if n_turns == 0:
            first = moment
        turning = turned(turning, moment)
        n_turns += 1
    if n_turns > 1 and cycles < 4 and below(far, back):
        moment = turn_moment(norm(direction + 180.0 - player.angle), speed(player))
        if line_distance(target, start, turned(player, moment).angle) < 0.9 * REACH:
            return Command(TURN, moment, 0.0)
    return Command(TURN, first, 0.0) if n_turns > 0 else dash_to(player, target, cycles)


@kernel
def cycles_to_point(sight: Sight, player: int, target: Point) -> int:
    """Return the observer's estimate of how many cycles a player needs to have a point in reach."""
    now = body(sight, player)
    start = place(now)
    if distance(start, target) < REACH:
        return 0
    aim, count = bearing(minus(target, start)), 0
    command = move(now, target, 1)
    while count < ENDLESS and (
        command.kind == TURN or (below(20.0, abs(norm(now.angle - aim))) and command.amount < 0.0)
    ):
        now = after(now, command)
        count += 1
        if distance(place(now), target) < REACH:
            return count
        command = move(now, target, 1)
    if player == sight.me:
        while count < ENDLESS and distance(place(now), target) >= REACH:
            now = after(now, move(now, target, 1))
            count += 1
        return count
    pace = rotated(velocity(now), -now.angle).x
    return count + straight_cycles(pace, distance(place(now), target))


@kernel
def straight_cycles(pace: float, far: float) -> int:
    """Return how many cycles of running straight ahead bring a point ``far`` ahead in reach."""
    count = 0
    while True:
        before = pace
        pace = min(pace + 0.6, PLAYER_SPEED)
        far -= pace
        pace *= PLAYER_DECAY
        count += 1
        if far <= REACH:
            return count
        if abs(pace - before) < 1e-4 and pace >= 0.3:
            return count + math.ceil((far - REACH) / (pace / PLAYER_DECAY))


@kernel
def quickest(sight: Sight, team: tuple[int, int], target: Point, limit: float) -> tuple[int, int]:
    """Return who of a team needs the fewest cycles to a point, and how many.

    Only those count who would be there in less than ``limit`` cycles at full speed; (-1, ENDLESS) if nobody
    would.
    """
    best, fewest = -1, ENDLESS
    for j in range(team[1] - 1, team[0] - 1, -1):
        if distance(place(body(sight, j)), target) / PLAYER_SPEED < limit:
            cycles = cycles_to_point(sight, j, target)
            if cycles < fewest:
                best, fewest = j, cycles
    return best, fewest


@kernel
def fastest_mate(sight: Sight) -> int:
    """Return the member of the observer's team, itself included, that will be at the ball first."""
    team = team_of(sight, sight.me)
    for t in range(32):
        target = ball_after(sight, t)
        best, cycles = quickest(sight, team, target, t + 1.0)
        if cycles <= t:
            return best
        if quickest(sight, opponents_of(sight, sight.me), target, t + 1.0)[1] <= t:
            return quickest(sight, team, target, math.inf)[0]
    return quickest(sight, team, ball_after(sight, 100), math.inf)[0]


@kernel
def fastest_opponent(sight: Sight) -> int:
    """Return the opponent of the observer that will be at the ball first."""
    team = opponents_of(sight, sight.me)
    for t in range(32):
        best, cycles = quickest(sight, team, ball_after(sight, t), t + 1.0)
        if cycles <= t:
            return best
    return quickest(sight, team, ball_after(sight, 100), math.inf)[0]


@kernel
def cycles_to_ball(sight: Sight, player: int) -> int:
    ball = ball_place(sight)
    if distance(place(body(sight, player)), ball) < REACH:
        return 0
    cycles = cycles_to_point(sight, player, ball)
    if below(size(ball_velocity(sight)), 0.01):
        return cycles
    for t in range(1, 30):
        cycles = cycles_to_point(sight, player, ball_after(sight, t))
        if cycles < t:
            return cycles
    return 30


@kernel
def intercept(sight: Sight, memory: NDArray[np.float64], now: int) -> Command:
    """Return the next command towards the ball's path; where on it is remembered, so that plans persist."""
    me = body(sight, sight.me)
    if memory[OLD_TIME] == 0 or now + 1 - memory[OLD_TIME] > 2:
        memory[OLD_X], memory[OLD_Y] = NEVER, NEVER
    cycles = interception_time(sight, Point(memory[OLD_X], memory[OLD_Y]))
    target = ball_after(sight, cycles)
    memory[OLD_X], memory[OLD_Y] = target.x, target.y
    memory[OLD_TIME] = now + 1
    close = intercept_close(sight)
    if cycles < 3 and close.kind != NONE:
        return close
    if distance(place(rolled(me, min(cycles, 4))), target) < 0.5:
        return face(me, Point(me.x + 1.0, me.y), 1)
    return move(me, target, cycles)


@kernel
def interception_time(sight: Sight, old: Point) -> int:
    """Return in how many cycles to meet the ball: as soon as possible, or where it was meant to be before."""
    me = body(sight, sight.me)
    first, best, kept, slack, closest = -1, -1, -1, 10.0, 1.0
    for t in range(31):
        if first >= 0 and t > first + 20:
            break
        target = ball_after(sight, t)
        if distance(place(rolled(me, min(t, 4))), target) / PLAYER_SPEED > t + REACH:
            continue
        runner = me
        for i in range(t):
            runner = after(runner, move(runner, target, t - i))
        gap = distance(place(runner), target)
        if gap >= REACH:
            continue
        if first < 0:
            first = best = t
        step = size(ball_velocity(sight)) * BALL_DECAY**t
        if distance(target, old) < closest and gap < 0.7 * REACH and below(0.6, step):
            kept, slack, closest = t, gap, distance(target, old)
        elif gap < slack and slack > 0.5 * REACH and (t <= best + 3 or (kept >= 0 and t <= kept + 3)):
            best, slack = t, gap
            if kept >= 0 and kept == best - 1:
                kept = best
    if kept >= 0 and best <= kept + 2:
        return kept
    return first if first >= 0 else 100


@kernel
def intercept_close(sight: Sight) -> Command:
    """Return a command that has the ball in reach within two cycles; NONE if there is none."""
    me, nothing = body(sight, sight.me), Command(NONE, 0.0, 0.0)
    if distance(place(me), ball_place(sight)) > 3.0 * PLAYER_SPEED + 1.94 * BALL_SPEED + REACH:
        return nothing
    soon, later = ball_after(sight, 1), ball_after(sight, 2)
    dash = dash_at_ball(sight)
    opponent = body(sight, nearest_opponent(sight, place(me)))
    if below(distance(place(opponent), place(me)), 3.0) and dash.kind != NONE:
        return dash
    turn, choice = turn_ahead(me), nothing
    once = after(me, turn)
    if distance(place(once), soon) < 0.8 * REACH:
        choice = turn
        if abs(once.angle) < 25.0:
            return turn
    twice = after(once, turn_ahead(once))
    if distance(place(twice), later) < 0.8 * REACH:
        choice = turn
        if abs(twice.angle) < 25.0:
            return turn
    if abs(me.angle) > 25.0:
        bump = collide(sight)
        if bump.kind != NONE:
            return bump
        stop = dash_to(me, place(me), 1)
        if distance(place(after(me, stop)), later) < 0.8 * REACH:
            return stop
    return choice if choice.kind != NONE else dash


@kernel
def dash_at_ball(sight: Sight) -> Command:
    """Return one dash that has the ball in reach, in front if possible; NONE if there is none."""
    me, ball = body(sight, sight.me), ball_after(sight, 1)
    start = place(rolled(me, 1))
    offset = rotated(minus(ball, start), -me.angle)
    half = (TOUCH + 0.7 / 6.0) ** 2 - offset.y**2
    if half >= 0.0:
        ahead = plus(start, polar(offset.x + math.sqrt(half), me.angle))
        behind = plus(start, polar(offset.x - math.sqrt(half), me.angle))
        upper, lower = (behind, ahead) if below(ahead.x, behind.x) else (ahead, behind)
        for goal in (upper, lower):
            dash = dash_to(me, goal, 1)
            if distance(place(dashed(me, float(whole(dash.amount)))), ball) < 0.95 * REACH:
                return dash
    dash = dash_to(me, ball, 1)
    if distance(place(after(me, dash)), ball) < 0.95 * REACH:
        return dash
    return Command(NONE, 0.0, 0.0)


@kernel
def collide(sight: Sight) -> Command:
    """Return a command that runs into the ball; NONE if there is none."""
    me, ball = body(sight, sight.me), ball_place(sight)
    if distance(place(me), ball) > size(ball_velocity(sight)) + PLAYER_SPEED:
        return Command(NONE, 0.0, 0.0)
    soon = ball_after(sight, 1)
    turn, dash = turn_ahead(me), dash_to(me, soon, 1)
    if distance(place(after(me, turn)), soon) < TOUCH:
        return turn
    if distance(place(after(me, dash)), soon) < TOUCH:
        return dash
    return Command(NONE, 0.0, 0.0)
