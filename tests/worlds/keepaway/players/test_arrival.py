from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from relforest.worlds.keepaway.players.arrival import (
    LONGEST,
    cycles_to_ball,
    cycles_to_point,
    fastest,
    line_up,
)
from worlds.keepaway.staged_games import staged

FAR = [[19.0, 19.0]]


@pytest.mark.parametrize(
    ("x", "y", "cycles"),
    [
        (1.0, 0.0, 0),  # in reach
        (5.0, 0.0, 5),  # 3.915 m to run: 0.6 + 0.84 + 0.936 + 0.9744 = 3.3504, and 0.98976 more
        (0.0, -5.0, 6),  # the same after a turn
        (-2.0, 0.0, 2),  # 0.915 m backwards: 0.6 + 0.84
        (-5.0, 0.0, 6),  # too far to go backwards
        (20.0, 0.0, 20),  # 18.915 m: k full dashes cover k - 2/3 m
    ],
)
def test_a_player_at_rest_needs_the_cycles_of_the_dash_series(x: float, y: float, cycles: int) -> None:
    for observer in (0, 1):
        assert cycles_to_point((x, y, 0.0, 0.0), observer, 1, LONGEST) == cycles


def test_of_others_it_is_not_known_that_they_run_past_at_the_side() -> None:
    # 1.1 m aside at 10.05 m the line along the body passes within the 2.17 m that hold beyond 10 m. Others
    # are taken to run straight; the player itself has to turn when it is nearer.
    pursuit = (10.0, 1.1, 0.0, 0.0)

    assert cycles_to_point(pursuit, 0, 1, LONGEST) == 10  # 10.06 - 1.085 = 8.975 <= 10 - 2/3
    assert cycles_to_point(pursuit, 1, 1, LONGEST) == 11


@given(
    st.floats(-15.0, 15.0),
    st.floats(-15.0, 15.0),
    st.floats(-0.4, 0.4),
    st.floats(-0.4, 0.4),
    st.integers(0, 30),
)
@settings(deadline=None)
def test_estimates_are_exact_as_far_as_asked(tx: float, ty: float, vx: float, vy: float, most: int) -> None:
    for observer in (0, 1):
        cycles = cycles_to_point((tx, ty, vx, vy), observer, 1, LONGEST)
        limited = cycles_to_point((tx, ty, vx, vy), observer, 1, most)

        assert limited == cycles if cycles <= most else limited > most
        # Nobody covers more than 1.05 m in a cycle.
        assert 1.05 * cycles + 1.085 + 1e-9 >= (tx * tx + ty * ty) ** 0.5


def test_the_nearest_is_the_fastest() -> None:
    stage = staged([[0.0, 0.0], [12.0, 0.0], [5.0, 9.0]], FAR, [4.0, 0.0])
    line_up(stage.work, 1)

    assert fastest(stage.work, 1, (0, 3), (3, 4)) == (0, 4)  # 2.915 m: 0.6 + 0.84 + 0.936 = 2.376, one more
    assert cycles_to_ball(stage.work, 1, 0, 1) == 4


def test_of_equally_fast_players_the_one_of_the_highest_number_counts() -> None:
    stage = staged([[-5.0, 0.0, 0.0, 0.0, 0.0], [5.0, 0.0, 0.0, 0.0, 180.0]], FAR, [0.0, 0.0])
    for observer in (0, 1, 2):
        line_up(stage.work, observer)
        assert fastest(stage.work, observer, (0, 2), (2, 3)) == (1, 5)


def test_a_rolling_ball_is_met_on_its_way() -> None:
    # The ball comes at 2 m per cycle: it is at 6.69 m after four cycles, at 5.13 m after five. The player
    # runs 3.35 m in four and 4.34 m in five: 6.69 - 3.35 is out of reach, 5.13 - 4.34 in reach.
    stage = staged([[0.0, 0.0], [0.0, 15.0]], FAR, [14.0, 0.0, -2.0, 0.0])
    line_up(stage.work, 1)

    assert fastest(stage.work, 1, (0, 2), (2, 3)) == (0, 5)


def test_if_rivals_come_first_the_place_where_they_do_counts() -> None:
    # The way of the ball leads to keeper 1. The taker has it at once, and keeper 0 is nearer to that place.
    ball = [0.0, 0.0, 1.0, 0.0]
    keepers = [[0.0, 5.0, 0.0, 0.0, -90.0], [9.0, 0.0, 0.0, 0.0, 180.0]]
    alone = staged(keepers, [[0.0, 19.0]], ball, perception="fullstate")
    line_up(alone.work, 0)
    assert fastest(alone.work, 0, (0, 2), (2, 3))[0] == 1

    pressed = staged(keepers, [[0.5, 0.0]], ball, perception="fullstate")
    line_up(pressed.work, 0)
    assert fastest(pressed.work, 0, (0, 2), (2, 3)) == (0, -1)
    assert fastest(pressed.work, 0, (2, 3), (0, 0)) == (2, 0)


def test_a_ball_that_nobody_reaches_is_awaited_where_it_stops() -> None:
    stage = staged(
        [[-80.0, 0.0], [-81.0, 0.0, 0.0, 0.0, 180.0]],
        [[-90.0, 0.0]],
        [90.0, 0.0, 1.0, 0.0],
        size=(200.0, 200.0),
    )
    line_up(stage.work, 0)

    assert fastest(stage.work, 0, (0, 2), (2, 3)) == (0, -1)
    assert cycles_to_ball(stage.work, 0, 1, 1) == 30


def test_who_has_the_ball_need_not_go() -> None:
    stage = staged([[0.0, 0.0], [9.0, 9.0]], FAR, [1.0, 0.0, 2.0, 0.0])
    line_up(stage.work, 1)

    assert cycles_to_ball(stage.work, 1, 0, 1) == 0
