"""Creates batches of games."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from relforest.worlds.keepaway.players.memory import N_MEMORY
from relforest.worlds.keepaway.server.layout import N_COUNTERS, Games, Setup
from relforest.worlds.keepaway.server.randomness import stream_states
from relforest.worlds.keepaway.server.referee import place


def new_games(setup: Setup, seeds: Sequence[np.random.SeedSequence]) -> Games:
    """Begin one game per seed, with all players placed for the first episode.

    A game depends only on its own seed, not on the rest of the batch. All players face +x; players and ball
    stand still.
    """
    n_games, n_players = len(seeds), setup.keepers + setup.takers
    games = Games(
        players=np.zeros((n_games, n_players, 5)),
        ball=np.zeros((n_games, 4)),
        commands=np.zeros((n_games, n_players, 3), dtype=np.int64),
        memory=np.zeros((n_games, n_players, N_MEMORY)),
        counters=np.zeros((n_games, N_COUNTERS), dtype=np.int64),
        anchor=np.zeros((n_games, 2)),
        streams=stream_states(seeds),
    )
    for g in range(n_games):
        place(games, g, setup)
    return games
