"""One cycle of keepaway with everybody where a test wants them, seen by all players."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from keepaway_games import game
from relforest.worlds.keepaway.players.views import Work, new_work, observe
from relforest.worlds.keepaway.server.layout import Games, Setup
from relforest.worlds.keepaway.server.options import KeepawayOptions


class Stage(NamedTuple):
    """A game and what its players see."""

    games: Games
    setup: Setup
    work: Work


def staged(
    keepers: Sequence[Sequence[float]],
    takers: Sequence[Sequence[float]],
    ball: Sequence[float],
    *,
    perception: str = "exact",
    size: float | tuple[float, float] = 40.0,
) -> Stage:
    """Place players (x, y, vx, vy, body) and the ball (x, y, vx, vy), and let all look.

    Zeros at the end may be left out.
    """
    setup = KeepawayOptions(
        keepers=len(keepers), takers=len(takers), size=size, perception=perception
    ).setup()
    games = game(setup)
    games.players[0] = 0.0
    for i, player in enumerate([*keepers, *takers]):
        games.players[0, i, : len(player)] = player
    games.ball[0] = 0.0
    games.ball[0, : len(ball)] = ball
    work = new_work(setup)
    observe(games, 0, setup, work)
    return Stage(games, setup, work)


def random_stage(seed: int, *, keepers: int = 2, takers: int = 2, perception: str = "exact") -> Stage:
    """Place everybody at random on a field of 20 m x 20 m."""
    rng = np.random.default_rng(seed)
    players = np.column_stack(
        [
            rng.uniform(-9.0, 9.0, (keepers + takers, 2)),
            rng.uniform(-0.25, 0.25, (keepers + takers, 2)),
            rng.uniform(-180.0, 180.0, keepers + takers),
        ]
    )
    ball = [*rng.uniform(-6.0, 6.0, 2), *rng.uniform(-1.2, 1.2, 2)]
    return staged(
        players[:keepers].tolist(), players[keepers:].tolist(), ball, perception=perception, size=20.0
    )


def exchanged(stage: Stage, *, perception: str = "exact") -> Stage:
    """Turn the scene by 180 degrees, and let every keeper play a taker and the other way round."""
    players = -stage.games.players[0]
    players[:, 4] = (stage.games.players[0, :, 4] + 360.0) % 360.0 - 180.0
    k = stage.setup.keepers
    return staged(
        players[k:].tolist(),
        players[:k].tolist(),
        (-stage.games.ball[0]).tolist(),
        perception=perception,
        size=20.0,
    )


def command(stage: Stage, i: int) -> list[int]:
    """Return what player i has been told to do."""
    chosen: NDArray[np.int64] = stage.games.commands[0, i]
    return [int(number) for number in chosen]
