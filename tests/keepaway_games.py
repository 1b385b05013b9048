"""Games of keepaway with everybody where a test wants them, and recorded steps of the real server."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from relforest.worlds.keepaway.play.games import new_games
from relforest.worlds.keepaway.server.bounds import Steps
from relforest.worlds.keepaway.server.layout import Games, Setup
from relforest.worlds.keepaway.server.physics import execute

RECORDED = Path(__file__).parent / "data" / "keepaway-trajectories.npz"
"""32 episodes of random play by three keepers against two takers, recorded from the RoboCup 2-D server,
version 19; ``readme`` inside describes the arrays."""


def game(setup: Setup, *, seed: int = 0) -> Games:
    """One game, at the beginning of an episode."""
    return new_games(setup, [np.random.SeedSequence(seed)])


def scatter(games: Games) -> None:
    """Put the players of a game of up to ten far from the ball and from each other, standing still."""
    games.ball[0] = 0.0
    for i in range(games.players.shape[1]):
        games.players[0, i] = [3.0 * i - 9.0, 8.0, 0.0, 0.0, 0.0]


def played(games: Games, setup: Setup, cycles: int, commands: Sequence[np.ndarray]) -> Steps:
    """Play on without a referee, with the commands of each cycle given."""
    balls, players = [games.ball[0].copy()], [games.players[0].copy()]
    for cycle in range(cycles):
        games.commands[0] = commands[cycle]
        execute(games, 0, setup)
        balls.append(games.ball[0].copy())
        players.append(games.players[0].copy())
    return Steps(
        np.array(balls[:-1]),
        np.array(players[:-1]),
        np.array(commands[:cycles]),
        np.array(balls[1:]),
        np.array(players[1:]),
    )


def recorded_steps() -> Steps:
    """All steps of the recording that do not end an episode, whose last state was not recorded."""
    with np.load(RECORDED, allow_pickle=False) as data:
        following = np.flatnonzero(np.diff(data["t"]) == 1)
        first = following[~np.isin(data["t"][following + 1], data["ep_end"])]
        players, ball = data["players"][:, :, :5].astype(np.float64), data["ball"].astype(np.float64)
        commands = np.concatenate([data["cmd_type"][:, :, None], data["cmd_arg"]], axis=2).astype(np.int64)
        return Steps(ball[first], players[first], commands[first], ball[first + 1], players[first + 1])
