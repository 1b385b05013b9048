from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from keepaway_games import RECORDED, game, scatter
from relforest.worlds.keepaway.play.events import (
    DASHES,
    FIRST_TOUCH,
    KEEPER_CYCLES,
    KEEPER_KICKS,
    N_EVENTS,
    N_SPEEDS,
    TAKER_CYCLES,
    TAKER_KICKS,
    TRANSFERS,
    TURNS,
    count_events,
    forget_events,
    new_tally,
)
from relforest.worlds.keepaway.server.layout import DASH, KICK, NONE, TIME, TURN
from relforest.worlds.keepaway.server.options import KeepawayOptions

SETUP = KeepawayOptions().setup()


def test_a_hand_made_episode() -> None:
    games, tally = game(SETUP), new_tally(SETUP)
    # Players at the ball, and what they do: keeper 1, nobody, keeper 1 again, keeper 2 and taker 4, keeper 1.
    for time, near, kinds in [
        (2, [1], [DASH, KICK, TURN, DASH, DASH]),
        (3, [], [DASH, NONE, NONE, NONE, TURN]),
        (4, [1], [NONE, KICK, NONE, NONE, NONE]),
        (5, [2, 4], [NONE, NONE, KICK, NONE, KICK]),
        (6, [1], [NONE, NONE, NONE, NONE, NONE]),
    ]:
        scatter(games)
        for player in near:
            games.players[0, player, :2] = [0.5, 0.0]
        games.commands[0, :, 0] = kinds
        games.counters[0, TIME] = time
        count_events(games, 0, SETUP, tally)
    expected = {
        KEEPER_KICKS: 3,
        TAKER_KICKS: 1,
        TRANSFERS: 2,
        KEEPER_CYCLES: 4,
        TAKER_CYCLES: 1,
        FIRST_TOUCH: 2,
        DASHES: 4,
        TURNS: 2,
    }

    assert {column: tally.events[column] for column in expected} == expected
    assert tally.speeds[0] == 5

    forget_events(tally)
    assert tally.events[:N_EVENTS].tolist() == [0, 0, 0, 0, 0, -1, 0, 0, -1]


def test_speeds_and_distances_of_keepers_are_kept_in_order() -> None:
    games, tally = game(SETUP), new_tally(SETUP)
    games.players[0, :3, :2] = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]]
    for speed in (0.305, 50.0):
        games.ball[0, 2:] = [0.0, -speed]
        count_events(games, 0, SETUP, tally)

    # A right triangle with sides of 3, 4 and 5 metres, seen twice.
    assert tally.pairs.tolist() == [6.0, 8.0, 10.0]
    assert np.flatnonzero(tally.speeds).tolist() == [30, N_SPEEDS - 1]


def test_the_recorded_games_have_the_counts_known_of_them() -> None:
    games, tally = game(SETUP), new_tally(SETUP)
    episodes: list[NDArray[np.int64]] = []
    with np.load(RECORDED, allow_pickle=False) as archive:
        data = {name: archive[name] for name in archive.files}
    commands = np.concatenate([data["cmd_type"][:, :, None], data["cmd_arg"]], axis=2)
    for row, episode in enumerate(data["episode"]):
        if episode > len(episodes):
            forget_events(tally)
            episodes.append(tally.events.copy())
        games.players[0], games.ball[0] = data["players"][row, :, :5], data["ball"][row]
        games.commands[0] = commands[row]
        games.counters[0, TIME] = data["t"][row] - data["ep_start"][episode - 1]
        count_events(games, 0, SETUP, tally)
        episodes[-1] = tally.events.copy()
    means, cycles = np.mean(episodes, axis=0), len(commands)

    # Known of the whole recording, 63 episodes: 17.1 kicks of keepers, 3.3 of takers and 7.2
    # changes of keeper per episode, the first touch in cycle 4.8; here are 32 of them.
    assert len(episodes) == 32
    assert means[[KEEPER_KICKS, TAKER_KICKS, TRANSFERS, FIRST_TOUCH]] == pytest.approx(
        [17.09, 3.06, 7.34, 4.75], abs=0.01
    )
    assert tally.pairs / cycles == pytest.approx([11.18, 13.15, 16.44], abs=0.01)
