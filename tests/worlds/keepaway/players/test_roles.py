from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.worlds.keepaway.players.arrival import line_up
from relforest.worlds.keepaway.players.commands import face
from relforest.worlds.keepaway.players.interception import intercept
from relforest.worlds.keepaway.players.kicks import KEEPER_HOLDS, TAKER_HOLDS, hold, pass_to
from relforest.worlds.keepaway.players.memory import DECIDED, LAST_ACTION, continues_pass, remember_decision
from relforest.worlds.keepaway.players.positioning import get_open, mark
from relforest.worlds.keepaway.players.roles import command_keeper, command_taker, nearest_mate
from relforest.worlds.keepaway.players.views import in_reach, observe
from relforest.worlds.keepaway.server.layout import DASH, KICK, NONE, TIME, TURN
from worlds.keepaway.staged_games import Stage, command, random_stage, staged

HOLDER = [[0.0, 0.0], [8.0, 0.0], [0.0, 9.0]]
TAKERS = [[-6.0, 0.0], [-7.0, 3.0]]
BALL = [0.5, 0.0]


def test_a_keeper_with_the_ball_does_what_was_decided() -> None:
    stage = staged(HOLDER, TAKERS, BALL)
    games, setup, work = stage
    command_keeper(games, 0, 0, 0, setup, work)
    assert command(stage, 0) == list(hold(work, 0, setup, KEEPER_HOLDS))
    for action in (1, 2):
        command_keeper(games, 0, 0, action, setup, work)
        assert command(stage, 0) == list(pass_to(work, 0, setup, *HOLDER[action]))
        assert games.memory[0, 0, LAST_ACTION] == action


def test_a_pass_goes_on_until_the_ball_has_left() -> None:
    games, setup, work = staged(HOLDER, TAKERS, BALL)
    assert not continues_pass(games, 0, 0)
    command_keeper(games, 0, 0, 2, setup, work)
    assert not continues_pass(games, 0, 0)

    games.counters[0, TIME] = 1
    assert continues_pass(games, 0, 0)
    observe(games, 0, setup, work)
    command_keeper(games, 0, 0, -1, setup, work)
    assert games.commands[0, 0].tolist() == list(pass_to(work, 0, setup, *HOLDER[2]))
    assert games.memory[0, 0, DECIDED] == 2

    games.counters[0, TIME] = 3
    assert not continues_pass(games, 0, 0)


def test_holding_is_decided_anew_in_every_cycle() -> None:
    games, _, _ = staged(HOLDER, TAKERS, BALL)
    remember_decision(games, 0, 0, 0)
    games.counters[0, TIME] = 1

    assert not continues_pass(games, 0, 0)


def test_a_kicked_ball_is_expected_to_go_where_it_was_kicked() -> None:
    games, setup, work = staged(HOLDER, TAKERS, BALL, perception="quantised")
    command_keeper(games, 0, 0, 1, setup, work)
    assert games.commands[0, 0, 0] == KICK
    power = int(games.commands[0, 0, 1])

    # Straight ahead from (0.5, 0), seen 0.5 m away: the rate is 0.027 * (1 - 0.25 * 0.115 / 0.7).
    velocity = 0.94 * power * 0.027 * (1.0 - 0.25 * 0.115 / 0.7)
    games.counters[0, TIME] = 1
    games.ball[0] = [0.5 + velocity / 0.94, 0.0, 1.05 * velocity, 0.0]
    observe(games, 0, setup, work)
    distance, true = work.balls[0, 0], games.ball[0, 0]
    seen = 0.02 * round(1.05 * velocity / true / 0.02) * distance
    assert abs(seen - velocity) < 0.1 * velocity
    assert work.balls[0, 2] == pytest.approx((seen + velocity) / 2.0)


def test_without_the_ball_the_fastest_keeper_goes_for_it_and_the_others_get_open() -> None:
    stage = staged(HOLDER, TAKERS, [3.0, 1.0])
    games, setup, work = stage
    for i in range(3):
        assert not in_reach(work, i)
        command_keeper(games, 0, i, -1, setup, work)
    line_up(work, 0)
    assert command(stage, 0) == list(intercept(games, 0, 0, setup, work))
    for i in (1, 2):
        line_up(work, i)
        assert command(stage, i) == list(get_open(work, i, setup, 0, 1))


def test_the_two_nearest_takers_go_for_the_ball_and_the_others_mark() -> None:
    stage = staged(HOLDER, [*TAKERS, [-8.0, -3.0]], BALL)
    games, setup, work = stage
    for i in range(3, 6):
        command_taker(games, 0, i, setup, work)
    for i in (3, 4):
        assert command(stage, i) == list(intercept(games, 0, i, setup, work))
    line_up(work, 5)
    assert command(stage, 5) == list(mark(work, 5, setup))


def test_of_takers_at_the_same_distance_the_highest_numbers_go_for_the_ball() -> None:
    stage = staged(HOLDER, [[0.5, 6.0], [6.5, 0.0], [-5.5, 0.0]], BALL)
    for i in range(3, 6):
        command_taker(stage.games, 0, i, stage.setup, stage.work)
    line_up(stage.work, 3)

    assert command(stage, 3) == list(mark(stage.work, 3, stage.setup))
    assert command(stage, 4) == list(intercept(stage.games, 0, 4, stage.setup, stage.work))


def test_a_taker_with_the_ball_holds_it_and_the_other_watches() -> None:
    stage = staged([[9.0, 0.0], [8.0, 5.0]], [[0.3, 0.6, 0.0, 0.0, 180.0], [-5.0, 0.0]], [0.0, 0.0])
    games, setup, work = stage
    for i in (2, 3):
        command_taker(games, 0, i, setup, work)

    assert command(stage, 2) == list(hold(work, 2, setup, TAKER_HOLDS))
    # In its own frame the other is at (5, 0) with its body at 180 degrees: it faces the ball.
    assert command(stage, 3) == list(face((5.0, 0.0, 0.0, 0.0, 180.0), 0.0, 0.0, 1)) == [TURN, 0, 0]


def test_a_taker_farther_from_the_ball_than_a_keeper_that_has_it_goes_on() -> None:
    stage = staged([[0.4, 0.0], [8.0, 5.0]], [[0.0, 0.7], [-5.0, 0.0]], [0.0, 0.0])
    command_taker(stage.games, 0, 3, stage.setup, stage.work)

    assert command(stage, 3) == list(intercept(stage.games, 0, 3, stage.setup, stage.work))


def test_mates_are_ranked_by_distance_and_equals_from_the_highest_number() -> None:
    stage = staged([[0.0, 0.0], [0.0, 5.0], [5.0, 0.0], [3.0, 0.0], [0.0, -5.0]], [[9.0, 9.0]], [1.0, 0.0])

    assert [nearest_mate(stage.work, 0, 5, rank) for rank in (1, 2, 3, 4)] == [3, 4, 2, 1]
    assert nearest_mate(stage.work, 0, 5, 5) == -1


def commands_of_all(stage: Stage) -> NDArray[np.int64]:
    games, setup, work = stage
    for i in range(setup.keepers + setup.takers):
        if i < setup.keepers:
            command_keeper(games, 0, i, i % setup.keepers, setup, work)
        else:
            command_taker(games, 0, i, setup, work)
    chosen: NDArray[np.int64] = games.commands[0]
    return chosen


@pytest.mark.parametrize("perception", ["exact", "quantised", "fullstate"])
@pytest.mark.parametrize(("keepers", "takers"), [(2, 1), (3, 2), (6, 5)])
def test_every_player_sends_a_legal_command(keepers: int, takers: int, perception: str) -> None:
    for seed in range(3):
        kind, amount, direction = commands_of_all(
            random_stage(seed, keepers=keepers, takers=takers, perception=perception)
        ).T

        assert not (kind == NONE).any()
        assert (np.abs(amount[kind != TURN]) <= 100).all()
        assert (amount[kind == KICK] >= 0).all()
        assert (np.abs(amount[kind == TURN]) <= 180).all()
        assert (np.abs(direction) <= 180).all()
        assert (direction[kind == DASH] == 0).all()
