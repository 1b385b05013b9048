from __future__ import annotations

import math

import numpy as np
import pytest

from keepaway_games import game, scatter
from relforest.worlds.keepaway.server.layout import (
    BODY,
    CAPPED,
    END,
    EPISODE,
    NEXT,
    OUT,
    PLAYING,
    STUCK_COUNT,
    TAKE_COUNT,
    TAKEN,
    TIME,
    Games,
    Setup,
)
from relforest.worlds.keepaway.server.options import KeepawayOptions
from relforest.worlds.keepaway.server.referee import judge, place

SETUP = KeepawayOptions().setup()
KEEPER, TAKER = 0, 3


def still(setup: Setup = SETUP) -> Games:
    games = game(setup)
    scatter(games)
    return games


def judged(games: Games, *near: int, setup: Setup = SETUP) -> tuple[int, int]:
    """How the game stands, and the take count, after a cycle with these players and no others at the ball."""
    scattered = still(setup)
    games.players[0, :, :2] = scattered.players[0, :, :2]
    for player in near:
        games.players[0, player, :2] = games.ball[0, :2] + [0.5, 0.0]
    judge(games, 0, setup)
    return int(games.counters[0, END]), int(games.counters[0, TAKE_COUNT])


def test_takers_win_one_cycle_after_their_fourth() -> None:
    games = still()

    assert [judged(games, TAKER) for _ in range(5)] == [
        (PLAYING, 1),
        (PLAYING, 2),
        (PLAYING, 3),
        (PLAYING, 4),
        (TAKEN, 4),
    ]
    assert games.counters[0, TIME] == 5


def test_the_take_count_is_cumulative_and_only_keepers_alone_reset_it() -> None:
    games = still()
    near = [(TAKER,), (), (KEEPER, TAKER + 1), (), (TAKER, TAKER + 1), (KEEPER,), (), (TAKER,), (KEEPER,)]

    assert [judged(games, *players)[1] for players in near] == [1, 1, 2, 2, 3, 0, 0, 1, 0]
    assert games.counters[0, END] == PLAYING


def test_a_keeper_comes_too_late_after_the_fourth_cycle() -> None:
    games = still()
    for _ in range(4):
        judged(games, TAKER)

    assert judged(games, KEEPER) == (TAKEN, 4)


@pytest.mark.parametrize(("distance", "count"), [(1.0849, 1), (1.085, 0)])
def test_reach_ends_at_1_085_metres(distance: float, count: int) -> None:
    games = still()
    games.players[0, TAKER, :2] = [distance, 0.0]
    judge(games, 0, SETUP)

    assert games.counters[0, TAKE_COUNT] == count


@pytest.mark.parametrize(
    ("x", "y", "end"),
    [
        (9.999, 12.499, PLAYING),
        (10.0, 0.0, OUT),
        (-10.0, 0.0, OUT),
        (0.0, 12.5, OUT),
        (0.0, -12.5, OUT),
        (11.0, 0.0, OUT),
        (math.nan, 0.0, OUT),
    ],
)
def test_the_ball_is_out_when_its_centre_reaches_the_line(x: float, y: float, end: int) -> None:
    setup = KeepawayOptions(size=(20, 25)).setup()
    games = still(setup)
    games.ball[0, :2] = [x, y]
    judge(games, 0, setup)

    assert games.counters[0, END] == end


def test_out_comes_before_taken_and_taken_before_the_cap() -> None:
    setup = KeepawayOptions(max_cycles=1).setup()
    games = still(setup)
    games.counters[0, TAKE_COUNT] = 4
    assert judged(games, setup=setup)[0] == TAKEN

    games = still(setup)
    games.counters[0, TAKE_COUNT] = 4
    games.ball[0, :2] = [10.5, 0.0]
    assert judged(games, setup=setup)[0] == OUT


def test_an_episode_is_cut_off_at_the_cap() -> None:
    setup = KeepawayOptions(max_cycles=3).setup()
    games = still(setup)

    assert [judged(games, KEEPER, setup=setup)[0] for _ in range(3)] == [PLAYING, PLAYING, CAPPED]


def test_a_stuck_ball_is_stopped_where_it_is() -> None:
    setup = KeepawayOptions(stuck_ball=4).setup()
    games = still(setup)
    speeds = []
    for cycle in range(12):
        games.ball[0] = [2.9 * (cycle % 2), 0.0, 0.5, 0.5]
        judge(games, 0, setup)
        speeds.append(games.ball[0, 2] != 0.0)

    # The anchor is (0, 0) first: 4 cycles within 3 m. Then, stopped at (2.9, 0), the anchor is there.
    assert speeds == ([True] * 3 + [False]) * 3
    assert games.anchor[0].tolist() == [2.9, 0.0]


def test_a_ball_that_moves_3_metres_is_not_stuck() -> None:
    setup = KeepawayOptions(stuck_ball=3).setup()
    games = still(setup)
    for cycle in range(12):
        games.ball[0] = [-8.0 + 1.6 * cycle, 0.0, 0.5, 0.5]
        judge(games, 0, setup)

        assert games.ball[0, 2] == 0.5
        assert games.counters[0, STUCK_COUNT] <= 1


def test_the_stuck_ball_rule_is_off_by_default() -> None:
    games = still()
    games.ball[0] = [1.0, 1.0, 0.5, 0.5]
    for _ in range(500):
        judge(games, 0, SETUP)

    assert games.ball[0].tolist() == [1.0, 1.0, 0.5, 0.5]


def corner_of(point: np.ndarray, length: float, width: float) -> tuple[int, int]:
    """Signs of the corner whose square of 3 m holds the point, (0, 0) for the middle."""
    x, y = point
    if max(abs(x), abs(y)) <= 1.0:
        return (0, 0)
    assert length / 2 - 3 <= abs(x) <= length / 2
    assert width / 2 - 3 <= abs(y) <= width / 2
    return (int(np.sign(x)), int(np.sign(y)))


@pytest.mark.parametrize(("keepers", "takers"), [(2, 1), (3, 2), (4, 3), (6, 5)])
def test_players_begin_in_their_corners(keepers: int, takers: int) -> None:
    setup = KeepawayOptions(keepers=keepers, takers=takers, size=(20, 26)).setup()
    slots = [(-1, -1), (1, -1), (1, 1), *[(0, 0)] * keepers][:keepers]
    first = set()
    games = game(setup)
    for _ in range(60):
        place(games, 0, setup)
        corners = [corner_of(player[:2], 20, 26) for player in games.players[0]]
        shift = (
            slots.index(corners[0])
            if corners[0] in slots[:3]
            else keepers - corners[:keepers].index((-1, -1))
        )
        first.add(shift)

        assert corners[:keepers] == [slots[(shift + i) % keepers] for i in range(keepers)]
        assert corners[keepers:] == [(-1, 1)] * takers
        assert games.ball[0].tolist() == [-6.0, -9.0, 0.0, 0.0]
        assert (games.players[0, :, 2:4] == 0.0).all()

    assert first == set(range(keepers))


def test_a_new_episode_keeps_body_angles_and_the_stuck_ball_rule_only() -> None:
    games = still()
    games.players[0, :, 2:] = [0.3, -0.2, 77.0]
    games.counters[0] = [50, 3, 4, TAKEN, 17, 2]
    games.anchor[0] = [1.0, 2.0]
    games.commands[0] = 3
    place(games, 0, SETUP)

    assert (games.players[0, :, BODY] == 77.0).all()
    assert games.anchor[0].tolist() == [1.0, 2.0]
    assert (games.commands == 0).all()
    counters = games.counters[0]
    assert counters[[TIME, EPISODE, TAKE_COUNT, END, STUCK_COUNT, NEXT]].tolist() == [0, 4, 0, PLAYING, 17, 0]
