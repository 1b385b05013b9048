from __future__ import annotations

import math

import pytest

from relforest.worlds.keepaway.players.arrival import line_up
from relforest.worlds.keepaway.players.motion import Player
from relforest.worlds.keepaway.players.positioning import (
    count_in_cone,
    get_open,
    mark,
    measure_crowding,
    move_to,
)
from relforest.worlds.keepaway.server.layout import DASH, TURN
from worlds.keepaway.staged_games import Stage, random_stage, staged

ME: Player = (0.0, 0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("taker", "count"),
    [
        ([5.0, 1.4], 1),  # less than 0.3 * 5 aside
        ([5.0, -1.6], 0),
        ([-1.0, 0.0], 0),  # behind the passer
        ([10.5, 0.0], 0),  # behind the receiver
        ([9.9, 2.0], 0),  # farther from the passer than the receiver: 10.1 m
        ([9.5, 2.0], 1),
    ],
)
def test_who_can_cut_off_a_pass(taker: list[float], count: int) -> None:
    stage = staged([[0.0, 15.0], [15.0, 15.0]], [taker, [-15.0, -15.0]], [1.0, 0.0])

    assert count_in_cone(stage.work, 0, (2, 4), (0.0, 0.0), (10.0, 0.0)) == count
    assert count_in_cone(stage.work, 0, (2, 4), (10.0, 0.0), (10.0, 0.0)) == 0


def test_crowding_is_the_sum_of_inverse_distances_to_others() -> None:
    stage = staged([[1.0, 0.0], [3.0, 0.0]], [[0.0, 4.0]], [9.0, 9.0], size=20.0)
    measure_crowding(stage.work, 0)

    # The place in the middle is the centre of the field; the first is (-7, -7).
    assert stage.work.grid[:, 0].tolist() == pytest.approx([-7.0, -7.0])
    assert stage.work.grid[:, 1].tolist() == pytest.approx([-7.0, -3.5])
    assert stage.work.crowding[12] == pytest.approx(1.0 / 3.0 + 1.0 / 4.0)
    assert stage.work.crowding[0] == pytest.approx(1.0 / math.hypot(10.0, 7.0) + 1.0 / math.hypot(7.0, 11.0))


def test_the_places_of_a_field_that_is_not_square_are_fractions_of_both_sides() -> None:
    stage = staged([[1.0, 0.0], [3.0, 0.0]], [[0.0, 4.0]], [9.0, 9.0], size=(40.0, 20.0))

    assert stage.work.grid[:, 1].tolist() == pytest.approx([-14.0, -3.5])


def open_place(stage: Stage, i: int, start: tuple[float, float]) -> tuple[float, float]:
    """The least crowded place to which a pass is free."""
    n, keepers = len(stage.games.players[0]), stage.setup.keepers
    best, least = (0.0, 0.0), math.inf
    for x in (-7.0, -3.5, 0.0, 3.5, 7.0):
        for y in (-7.0, -3.5, 0.0, 3.5, 7.0):
            others = [stage.games.players[0, j, :2] for j in range(n) if j != i]
            crowding = sum(1.0 / math.dist(other, (x, y)) for other in others)
            if crowding < least and not count_in_cone(stage.work, i, (keepers, n), start, (x, y)):
                best, least = (x, y), crowding
    return best


def test_a_keeper_goes_to_the_least_crowded_place_to_which_a_pass_is_free() -> None:
    for seed in range(10):
        stage = random_stage(seed, keepers=3)
        stage.games.ball[0] = stage.work.balls[:, 2:] = 0.0
        stage.work.balls[:, :2] = stage.games.players[0, 0, :2]  # keeper 0 has the ball
        x, y = open_place(stage, 1, tuple(stage.games.players[0, 0, :2].tolist()))
        me = tuple(stage.games.players[0, 1].tolist())
        line_up(stage.work, 1)
        command = get_open(stage.work, 1, stage.setup, 0, 1)

        if math.dist((x, y), me[:2]) >= 1.5:
            assert command == move_to(me, x, y, 7.0, 0.0)
        else:
            assert command[0] == TURN


def test_a_keeper_that_is_there_faces_the_ball() -> None:
    # All others are on the left, so that (7, 7) and (7, -7) are the emptiest; the taker covers the latter.
    stage = staged([[-8.0, 0.0], [6.5, 7.0, 0.0, 0.0, 0.0]], [[-4.0, -2.5]], [-8.0, 0.0], size=20.0)
    line_up(stage.work, 1)

    # The ball lies at atan2(-7, -14.5) = -154.2 degrees.
    assert get_open(stage.work, 1, stage.setup, 0, 1) == (TURN, -154, 0)


@pytest.mark.parametrize(
    ("me", "target", "back", "command"),
    [
        (ME, (5.0, 0.5), 0.0, (DASH, 100, 0)),  # 5.7 degrees
        (ME, (5.0, 0.7), 0.0, (TURN, 7, 0)),  # 7.97 degrees
        (ME, (-2.0, 0.1), 3.0, (DASH, -100, 0)),
        (ME, (-2.0, 0.1), 0.0, (TURN, 177, 0)),  # 177.1
        (ME, (-3.1, 0.1), 3.0, (TURN, 178, 0)),  # 178.2
        # A turn at speed 0.4 is 60 degrees, a second one at 0.16 is 100: 150 can be reached, 175 cannot.
        ((0.0, 0.0, 0.4, 0.0, 0.0), (-8.0, 5.0), 0.0, (TURN, 180, 0)),
        ((0.0, 0.0, 0.4, 0.0, 0.0), (-9.3, 0.87), 0.0, (DASH, -66, 0)),  # it brakes: 0.4 / 0.006
    ],
)
def test_going_to_a_point(
    me: Player, target: tuple[float, float], back: float, command: tuple[int, int, int]
) -> None:
    assert move_to(me, target[0], target[1], 7.0, back) == command


def test_a_taker_marks_the_keeper_to_whom_a_pass_is_free() -> None:
    # In the frame of takers, turned by 180 degrees: keeper 0 has the ball at (0, 0), keeper 1 is at (10, 0),
    # covered by taker 3 at (5, 0), keeper 2 at (0, 10) is free. Taker 5 goes to 4 m from (-1, 10), before the
    # ball.
    keepers = [[0.0, 0.0], [-10.0, 0.0], [0.0, -10.0]]
    stage = staged(keepers, [[-5.0, 0.0], [9.0, 9.0], [9.0, -5.0, 0.0, 0.0, 180.0]], [0.0, 0.0])
    line_up(stage.work, 5)
    x, y = -1.0 + 4.0 / math.sqrt(101.0), 10.0 - 40.0 / math.sqrt(101.0)

    assert stage.work.views[5, 5].tolist() == pytest.approx([-9.0, 5.0, 0.0, 0.0, 0.0])
    assert mark(stage.work, 5, stage.setup) == move_to((-9.0, 5.0, 0.0, 0.0, 0.0), x, y, 25.0, 3.0)


def test_a_taker_that_marks_sees_ball_and_keeper() -> None:
    # As above, but taker 5 is at (-1.81, 6), just outside the cone and 1.2 m from its place. The keeper is at
    # atan2(4, 1.81) = 65.65 degrees, the ball clockwise of it: it looks to 65.65 - 80.
    keepers = [[0.0, 0.0], [-10.0, 0.0], [0.0, -10.0]]
    stage = staged(keepers, [[-5.0, 0.0], [9.0, 9.0], [1.81, -6.0, 0.0, 0.0, 180.0]], [0.0, 0.0])
    line_up(stage.work, 5)

    assert mark(stage.work, 5, stage.setup) == (TURN, -14, 0)


def test_a_keeper_with_the_ball_counts_as_free() -> None:
    # Now taker 5, at (0, 6), covers keeper 2. Nobody covers keeper 0 from itself, so the place is 4 m from
    # (-1, 0) towards the ball.
    keepers = [[0.0, 0.0], [-10.0, 0.0], [0.0, -10.0]]
    stage = staged(keepers, [[-5.0, 0.0], [9.0, 9.0], [0.0, -6.0, 0.0, 0.0, 180.0]], [0.0, 0.0])
    line_up(stage.work, 5)

    assert mark(stage.work, 5, stage.setup) == move_to((0.0, 6.0, 0.0, 0.0, 0.0), 3.0, 0.0, 25.0, 3.0)
