from __future__ import annotations

import copy

import numpy as np
import pytest

from interpreted import compiled_only
from keepaway_games import game
from relforest.support.rng import stream
from relforest.worlds.keepaway.play.advance import ASK, HAND, HOLD, NOBODY, RANDOM, UNFINISHED, advance
from relforest.worlds.keepaway.play.games import new_games
from relforest.worlds.keepaway.players.views import in_reach, new_work
from relforest.worlds.keepaway.server.layout import END, KICK, NEXT, PLAYING, TIME, Games, Setup
from relforest.worlds.keepaway.server.options import KeepawayOptions
from relforest.worlds.keepaway.server.referee import place

SETUP = KeepawayOptions().setup()


def same(one: Games, other: Games, g: int = 0, h: int = 0) -> bool:
    return all(np.array_equal(a[g], b[h], equal_nan=True) for a, b in zip(one, other, strict=True))


def decisions(games: Games, setup: Setup, rng: np.random.Generator, count: int, g: int = 0) -> list[int]:
    """Answer at random, and return who was asked."""
    work = new_work(setup)
    actors, actor = [], advance(games, g, setup, ASK, -1, work)
    for _ in range(count):
        if actor == NOBODY:
            place(games, g, setup)
            actor = advance(games, g, setup, ASK, -1, work)
            continue
        actors.append(actor)
        actor = advance(games, g, setup, ASK, int(rng.integers(setup.keepers)), work)
    return actors


def test_the_first_question_is_asked_when_a_keeper_reaches_the_ball() -> None:
    games, work = game(SETUP), new_work(SETUP)
    actor = advance(games, 0, SETUP, ASK, -1, work)

    assert 0 <= actor < SETUP.keepers
    assert in_reach(work, actor)
    assert np.hypot(*(games.players[0, actor, :2] - games.ball[0, :2])) < 1.085
    assert games.counters[0, END] == PLAYING
    assert games.counters[0, NEXT] == actor + 1
    assert games.counters[0, TIME] > 0


def test_an_unanswered_question_is_repeated() -> None:
    games, work = game(SETUP), new_work(SETUP)
    actor = advance(games, 0, SETUP, ASK, -1, work)
    before = copy.deepcopy(games)

    assert advance(games, 0, SETUP, ASK, -1, work) == actor
    assert same(games, before)


def test_an_answer_without_a_question_is_ignored() -> None:
    games, others = game(SETUP), game(SETUP)

    assert advance(games, 0, SETUP, ASK, 2, new_work(SETUP)) == advance(
        others, 0, SETUP, ASK, -1, new_work(SETUP)
    )
    assert same(games, others)


def test_a_hold_is_decided_again_in_the_next_cycle_and_a_pass_is_finished() -> None:
    games, work = game(SETUP), new_work(SETUP)
    actor = advance(games, 0, SETUP, ASK, -1, work)
    start = games.counters[0, TIME]

    assert advance(games, 0, SETUP, ASK, 0, work) == actor
    assert games.counters[0, TIME] == start + 1

    advance(games, 0, SETUP, ASK, 1, work)
    # The ball needs some cycles to reach a teammate; nobody was asked while it was kicked.
    assert games.counters[0, TIME] >= start + 3 or games.counters[0, END] != PLAYING


@pytest.mark.parametrize("policy", [HOLD, HAND, RANDOM])
def test_policies_that_are_built_in_play_to_the_end(policy: int) -> None:
    games, work = game(SETUP, seed=3), new_work(SETUP)

    assert advance(games, 0, SETUP, policy, -1, work) == NOBODY
    assert games.counters[0, END] != PLAYING
    time = games.counters[0, TIME]
    assert advance(games, 0, SETUP, policy, -1, work) == NOBODY
    assert games.counters[0, TIME] == time


def test_holding_when_asked_is_the_policy_that_holds() -> None:
    asked, built_in, work = game(SETUP), game(SETUP), new_work(SETUP)
    actor = advance(asked, 0, SETUP, ASK, -1, work)
    while actor != NOBODY:
        actor = advance(asked, 0, SETUP, ASK, 0, work)
    advance(built_in, 0, SETUP, HOLD, -1, work)

    assert same(asked, built_in)


def test_two_keepers_at_the_ball_decide_in_the_same_cycle() -> None:
    games, work = game(SETUP), new_work(SETUP)
    games.players[0, :, :2] = [[-0.6, 0.0], [0.6, 0.0], [9.0, 9.0], [-9.0, 9.0], [-9.0, 8.0]]
    games.ball[0, :2] = 0.0

    assert advance(games, 0, SETUP, ASK, -1, work) == 0
    assert advance(games, 0, SETUP, ASK, 1, work) == 1
    assert games.counters[0, TIME] == 0
    assert games.commands[0, 0, 0] == KICK
    advance(games, 0, SETUP, ASK, 1, work)
    assert games.counters[0, TIME] > 0


def test_a_game_does_not_depend_on_its_batch() -> None:
    root = np.random.SeedSequence(9)
    seeds = [stream(root, i) for i in range(4)]
    batch, alone = new_games(SETUP, seeds), new_games(SETUP, seeds[2:3])
    for g in range(4):
        decisions(batch, SETUP, np.random.default_rng(g), 25, g)
    decisions(alone, SETUP, np.random.default_rng(2), 25)

    assert same(batch, alone, 2, 0)
    assert not same(batch, alone, 1, 0)


@compiled_only
@pytest.mark.parametrize(
    "options",
    [
        KeepawayOptions(),
        KeepawayOptions(perception="exact", size=8.0),
        KeepawayOptions(keepers=2, takers=1, size=(30.0, 9.0)),
        KeepawayOptions(keepers=4, takers=3, size=25.0),
        KeepawayOptions(keepers=7, takers=5, size=12.0, stuck_ball=20),
        KeepawayOptions(perception="fullstate", stuck_ball=100, max_cycles=400),
        KeepawayOptions(size=1000.0),
    ],
)
def test_random_decisions_lead_nowhere_strange(options: KeepawayOptions) -> None:
    setup = options.setup()
    games, rng = game(setup, seed=11), np.random.default_rng(1)
    for _ in range(20):
        actors = decisions(games, setup, rng, 10)

        assert set(actors) <= set(range(setup.keepers))
        for array in games:
            assert np.isfinite(array).all()
        assert (np.abs(games.players[0, :, 4]) <= 180.0).all()
        # Players run after the ball, so none is ever far from the field.
        assert (np.abs(games.players[0, :, 0]) < setup.length / 2 + 20.0).all()
        assert (np.abs(games.players[0, :, 1]) < setup.width / 2 + 20.0).all()
        assert (np.hypot(games.players[0, :, 2], games.players[0, :, 3]) <= 0.4 * 1.155).all()
        assert np.hypot(*games.ball[0, 2:]) <= 0.94 * 3.15


def test_a_game_can_be_played_cycle_by_cycle() -> None:
    whole, parts, work = game(SETUP), game(SETUP), new_work(SETUP)
    assert advance(parts, 0, SETUP, ASK, -1, work, None, 0) == UNFINISHED
    actor, cycles = UNFINISHED, 0
    while actor == UNFINISHED:
        actor, cycles = advance(parts, 0, SETUP, ASK, -1, work, None, 1), cycles + 1

    assert advance(whole, 0, SETUP, ASK, -1, new_work(SETUP)) == actor
    assert same(whole, parts)
    assert cycles == whole.counters[0, TIME] + 1
