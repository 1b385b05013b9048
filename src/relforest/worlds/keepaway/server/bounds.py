"""Could the server have made this step? Bounds on what commands and noise can do in one cycle.

All noise of the RoboCup 2-D server is bounded: an object ends up in a disc around where it would go without
noise. So recorded steps of the real server or of `physics` can be checked one by one, which reveals a wrong
formula without any statistics.

Letters: s steps, n players; arrays have the columns of `layout`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from relforest.worlds.keepaway.server.layout import BODY, DASH, KICK, TURN, VX, X
from relforest.worlds.keepaway.server.physics import (
    BALL_ACCELERATION_MAX,
    BALL_DECAY,
    BALL_NOISE,
    BALL_SPEED_MAX,
    BOUNCE,
    DASH_RATE,
    INERTIA,
    PLAYER_ACCELERATION_MAX,
    PLAYER_DECAY,
    PLAYER_NOISE,
    PLAYER_SPEED_MAX,
    POWER_MAX,
    TOUCH_BALL,
    TOUCH_PLAYER,
    TURN_NOISE,
    kick_noise,
    kick_rate,
)
from relforest.worlds.keepaway.server.referee import REACH

Floats = NDArray[np.float64]

_POSITION: Final = slice(X, X + 2)
_VELOCITY: Final = slice(VX, VX + 2)
# Errors of two positions and a velocity add up to 4.3 times that of one coordinate; kicks add a little more.
_ROUNDINGS: Final = 6.0
_EXACT: Final = 1e-9
# Three bodies or more need not touch exactly after the last round of separation.
_NEAR_TOUCH: Final = 0.05


@final
@dataclass(frozen=True, slots=True, eq=False)
class Steps:
    """Recorded cycles: states, the commands chosen in them, and the states one cycle later."""

    ball: Floats  # (s, 4): x, y, vx, vy
    players: Floats  # (s, n, 5): x, y, vx, vy, body
    commands: NDArray[np.int64]  # (s, n, 3): verb, power or moment, direction
    next_ball: Floats
    next_players: Floats


class StepCount(NamedTuple):
    """How many steps of one sort there were, and how many of them no noise can explain."""

    steps: int
    violations: int


class _Rules(NamedTuple):
    """How objects of one sort move."""

    acceleration_max: float
    speed_max: float
    noise: float
    decay: float


_BALL: Final = _Rules(BALL_ACCELERATION_MAX, BALL_SPEED_MAX, BALL_NOISE, BALL_DECAY)
_PLAYER: Final = _Rules(PLAYER_ACCELERATION_MAX, PLAYER_SPEED_MAX, PLAYER_NOISE, PLAYER_DECAY)


def step_violations(
    steps: Steps, *, rounding: float = 0.0, body_rounding: float = 0.0, min_dash_power: int = -POWER_MAX
) -> dict[str, StepCount]:
    """Count the steps of each sort, and those that lie outside the bounds of the noise.

    Parameters
    ----------
    steps : Steps
        What was recorded.
    rounding, body_rounding : float
        Largest error of the recorded coordinates (metres, metres per cycle) and body angles (degrees).
    min_dash_power : int
        The least power of a dash: 0 for servers since version 17, which do not dash backwards.

    Returns
    -------
    dict
        ``"free ball"`` (nobody kicks), ``"kick"`` (the ball, kicked by one or more), ``"turn"`` and
        ``"dash"`` (players), and ``"collision"``: steps of ball or players that do not fit free motion but
        end beside another object; their velocity must be turned back at a tenth. They count in their own
        sort too.
    """
    tolerance = _ROUNDINGS * rounding + _EXACT
    push, turned = _pushed_and_turned(steps, rounding, body_rounding, min_dash_power)
    kick, slack, kicked = _kicked(steps, body_rounding)
    touching = _touching(steps)
    bodies = [
        _motion(steps.players, steps.next_players, push, 0.0, _PLAYER, tolerance),
        _motion(steps.ball, steps.next_ball, kick, slack, _BALL, tolerance),
    ]
    (free, bounced), (free_ball, bounced_ball) = bodies
    legal = (free | bounced & touching[:, :-1]) & turned
    legal_ball = free_ball | bounced_ball & touching[:, -1]
    verbs = steps.commands[:, :, 0]
    collided = np.column_stack([~free & touching[:, :-1], ~free_ball & touching[:, -1]])
    explained = np.column_stack([bounced, bounced_ball])
    return {
        "free ball": _count(legal_ball, ~kicked),
        "kick": _count(legal_ball, kicked),
        "turn": _count(legal, verbs == TURN),
        "dash": _count(legal, verbs == DASH),
        "collision": _count(explained, collided),
    }


def _count(legal: NDArray[np.bool_], among: NDArray[np.bool_]) -> StepCount:
    return StepCount(int(among.sum()), int((among & ~legal).sum()))


def _length(vectors: Floats) -> Floats:
    return np.hypot(vectors[..., 0], vectors[..., 1])


def _limited(vectors: Floats, longest: float) -> Floats:
    scale = np.minimum(1.0, longest / np.maximum(_length(vectors), _EXACT))
    return vectors * scale[..., None]


def _wrapped(angle: Floats) -> Floats:
    return (angle + 180.0) % 360.0 - 180.0


def _polar(radius: Floats, angle: Floats) -> Floats:
    radians = np.deg2rad(angle)
    return np.stack([radius * np.cos(radians), radius * np.sin(radians)], axis=-1)


def _motion(
    before: Floats, after: Floats, push: Floats, slack: Floats | float, rules: _Rules, tolerance: float
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether steps are free motion within the noise, and whether they are that followed by a collision.

    ``slack`` bounds the error of the acceleration ``push`` before limits, which can only shrink it.
    """
    velocity = before[..., _VELOCITY]
    pushed = _limited(velocity + _limited(push, rules.acceleration_max), rules.speed_max)
    velocity = np.where((push != 0.0).any(axis=-1, keepdims=True), pushed, velocity)
    bound = slack + rules.noise * (_length(velocity) + slack) + tolerance
    step = after[..., _POSITION] - before[..., _POSITION]
    decayed = _length(after[..., _VELOCITY] - rules.decay * step) <= tolerance
    back = after[..., _VELOCITY] / (rules.decay * BOUNCE)
    free = (_length(step - velocity) <= bound) & decayed
    return free, _length(back - velocity) <= bound + tolerance / (rules.decay * -BOUNCE)


def _pushed_and_turned(
    steps: Steps, rounding: float, body_rounding: float, min_dash_power: int
) -> tuple[Floats, NDArray[np.bool_]]:
    """The accelerations of players, and whether their bodies turned as far as they may."""
    verbs, amounts = steps.commands[:, :, 0], steps.commands[:, :, 1].astype(np.float64)
    bodies = steps.players[..., BODY]
    power = np.where(verbs == DASH, np.clip(amounts, min_dash_power, POWER_MAX), 0.0)
    moment = np.where(verbs == TURN, amounts, 0.0)
    speed = _length(steps.players[..., _VELOCITY])
    error = math.sqrt(2.0) * rounding
    # A speed known up to a rounding error leaves the inertia unknown as well.
    most = np.abs(moment) / (1.0 + INERTIA * np.maximum(speed - error, 0.0))
    least = np.abs(moment) / (1.0 + INERTIA * (speed + error))
    expected = np.sign(moment) * (most + least) / 2.0
    bound = TURN_NOISE * most + (most - least) / 2.0 * (1.0 + TURN_NOISE) + 2.0 * body_rounding + _EXACT
    turned = np.abs(_wrapped(steps.next_players[..., BODY] - bodies - expected)) <= bound
    return _polar(DASH_RATE * power, bodies), turned


def _kicked(steps: Steps, body_rounding: float) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """The sum of all kicks (s, 2), the bound of its error (s,), and whether anybody kicked (s,)."""
    push, slack = np.zeros((len(steps.ball), 2)), np.zeros(len(steps.ball))
    kicked = np.zeros(len(steps.ball), dtype=np.bool_)
    offset = steps.ball[:, None, _POSITION] - steps.players[..., _POSITION]
    distance = _length(offset)
    bearing = np.rad2deg(np.arctan2(offset[..., 1], offset[..., 0])) - steps.players[..., BODY]
    for row, player in np.argwhere((steps.commands[..., 0] == KICK) & (distance <= REACH)):
        power, direction = steps.commands[row, player, 1:].astype(np.float64)
        angle = float(abs(_wrapped(bearing[row, player])))
        strength = power * kick_rate(distance[row, player], angle)
        push[row] += _polar(strength, steps.players[row, player, BODY] + direction)
        slack[row] += kick_noise(power, distance[row, player], angle, float(_length(steps.ball[row, 2:])))
        slack[row] += abs(strength) * math.radians(body_rounding)
        kicked[row] = True
    return push, slack, kicked


def _touching(steps: Steps) -> NDArray[np.bool_]:
    """Whether an object is as close to another as a collision leaves them (s, n + 1), the ball last."""
    places = np.concatenate([steps.next_players[..., :2], steps.next_ball[:, None, :2]], axis=1)
    distance = _length(places[:, :, None] - places[:, None, :])
    n_players = steps.players.shape[1]
    touch = np.full((n_players + 1, n_players + 1), TOUCH_PLAYER)
    touch[-1, :] = touch[:, -1] = TOUCH_BALL
    np.fill_diagonal(touch, -1.0)
    return np.asarray((distance <= touch + _NEAR_TOUCH).any(axis=2))
