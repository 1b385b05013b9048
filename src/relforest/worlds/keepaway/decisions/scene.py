"""What a relational learner sees of keepaway: the players and the available actions.

The objects are the players, keepers first: where they are, where they face, and the color of their team. The
ball is not an object; the player that has it is the holder in every action.

References
----------
Palmer (2015), sections 5.3.2 and 7.5.1.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes import Attribute, Scenes, Schema
from relforest.smdp import NO_LIMIT, UNBOUND, ActionType, Decision, Decisions
from relforest.support.jit import kernel
from relforest.worlds.keepaway.server.layout import BODY, X, Y

SCHEMA: Final = Schema((Attribute("location", 2), Attribute("orientation"), Attribute("color", 3)))
"""Metres from the centre of the field, radians from the x axis, red-green-blue from 0 to 1."""

HOLD_TYPE: Final = 0
PASS_TYPE: Final = 1

ACTION_TYPES: Final = (ActionType("hold", ("holder",)), ActionType("pass", ("holder", "receiver")))

KEEPER_COLOR: Final = (1.0, 1.0, 0.0)
TAKER_COLOR: Final = (0.0, 1.0, 1.0)

NOBODY: Final = -1
"""The actor of a state in which no keeper must decide: the last of an episode."""

_COLUMNS: Final = {name: SCHEMA.columns(name) for name in SCHEMA.names}


@kernel
def describe(players: NDArray[np.float64], out: NDArray[np.float64]) -> None:
    """Write location and orientation of the players to their columns of `out`.

    Players (n, 5) are x, y, vx, vy in metres and metres per cycle, and body direction in degrees; the columns
    of the color of objects (n, 6) are left alone.
    """
    for i in range(len(players)):
        out[i, 0] = players[i, X]
        out[i, 1] = players[i, Y]
        angle = math.radians(players[i, BODY])
        # Scenes count angles from above -pi to pi.
        out[i, 2] = angle if angle > -math.pi else math.pi


def objects(keepers: int, takers: int) -> NDArray[np.float64]:
    """Return the objects of a scene, (n, 6), with everything 0 but the colors of the teams."""
    matrix = np.zeros((keepers + takers, SCHEMA.width))
    matrix[:keepers, _COLUMNS["color"]], matrix[keepers:, _COLUMNS["color"]] = KEEPER_COLOR, TAKER_COLOR
    return matrix


def location_of(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return where the objects of scenes are: a view (..., n, 2) of their matrix (..., n, 6), in metres."""
    return matrix[..., _COLUMNS["location"]]


def attributes_of(matrix: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Return a new array for each attribute of objects (..., n, 6), as observations hold them."""
    return {name: matrix[..., columns].copy() for name, columns in _COLUMNS.items()}


def blank_scenes(games: int, keepers: int, takers: int) -> Scenes:
    """Return one scene per game to put objects into with `Scenes.with_matrix`.

    The object ids are ``"keeper_0"``, ``"keeper_1"``, ... and ``"taker_0"``, ``"taker_1"``, ...
    """
    n = keepers + takers
    names = [*(f"keeper_{i}" for i in range(keepers)), *(f"taker_{i}" for i in range(takers))]
    return Scenes(
        SCHEMA,
        matrix=np.zeros((games * n, SCHEMA.width)),
        rows=np.arange(games * n),
        starts=np.arange(games) * n,
        counts=np.full(games, n),
        object_ids=np.array(names * games, dtype=object),
    )


def decision(matrix: NDArray[np.float64], actor: int, receivers: NDArray[np.int64]) -> Decision:
    """Return the objects (n, 6) and the actions of a state, see `decisions`."""
    return decisions(matrix[None], np.array([actor]), receivers[None])[0]


def decisions(
    matrices: NDArray[np.float64], actors: NDArray[np.int64], receivers: NDArray[np.int64]
) -> Decisions:
    """Return the objects (s, n, 6) and the actions of states.

    No action is available if the actor (s,) is `NOBODY` rather than the keeper that must decide. Receivers
    (s, K - 1) are its teammates in the order of the actions 1, 2, ...: the nearest to it first.
    """
    (n_states, n_players, width), n_actions = matrices.shape, receivers.shape[1] + 1
    is_asked = actors != NOBODY
    arguments = np.full((np.count_nonzero(is_asked), n_actions, 2), UNBOUND)
    arguments[:, :, 0], arguments[:, 1:, 1] = actors[is_asked, None], receivers[is_asked]
    indices = np.tile(np.arange(n_actions), len(arguments))
    return Decisions(
        matrices.reshape(-1, width),
        np.arange(n_states + 1) * n_players,
        np.zeros(n_states, dtype=np.int64),
        np.full(n_states, NO_LIMIT),
        np.concatenate([[0], np.cumsum(is_asked * n_actions)]),
        np.minimum(indices, PASS_TYPE),
        arguments.reshape(-1, 2),
        indices,
    )
