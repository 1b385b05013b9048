from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.worlds.keepaway.decisions.variables import (
    by_distance,
    n_variables,
    nearest_keeper,
    state_variables,
    tile_widths,
    variable_names,
)

Floats = NDArray[np.float64]


def variables(players: Any, ball: Any, keepers: int) -> Floats:
    """State variables of a list of (x, y)."""
    matrix = np.array(players, dtype=np.float64)
    out = np.full(n_variables(keepers, len(matrix) - keepers), np.nan)
    state_variables(matrix, np.array(ball, dtype=np.float64), keepers, out)
    return out


THREE = [(3.0, 4.0), (3.0, -4.0), (-9.0, 4.0)]


def test_three_against_two_by_hand() -> None:
    # Keeper 0 at (3, 4) has the ball. Its teammates: keeper 1 straight below, 8 away; keeper 2 to the left,
    # 12 away. Takers: 3 at (3, 0), 4 below; 4 at (0, 4), 3 to the left, so it comes first.
    found = variables([*THREE, (3.0, 0.0), (0.0, 4.0)], (3.0, 4.0), 3)
    expected = [
        5.0,  # |K1 C| = sqrt(9 + 16)
        *(8.0, 12.0),  # |K1 K2|, |K1 K3|
        *(3.0, 4.0),  # |K1 T1|, |K1 T2|
        *(5.0, math.sqrt(97.0)),  # |K2 C| = sqrt(9 + 16), |K3 C| = sqrt(81 + 16)
        *(4.0, 3.0),  # |T1 C|, |T2 C|
        4.0,  # K2 (3, -4): T2 (3, 0) is 4 away, T1 (0, 4) sqrt(9 + 64)
        9.0,  # K3 (-9, 4): T1 (0, 4) is 9 away, T2 (3, 0) sqrt(144 + 16)
        *(0.0, 0.0),  # T2 stands on the line from K1 to K2, T1 on that to K3
    ]
    assert found == pytest.approx(expected, abs=1e-12)


def test_angles_by_hand() -> None:
    # K1 at the centre, K2 along +x, K3 along -y; takers at 60 and at 135 degrees (y axis = 90).
    takers = [(math.cos(math.radians(60)), math.sin(math.radians(60))), (-1.0, 1.0)]
    found = variables([(0.0, 0.0), (5.0, 0.0), (0.0, -6.0), *takers], (0.1, 0.0), 3)
    # From K2 (0 degrees) the nearer is 60 away. From K3 (-90): 150 to the first, 225 = 135 to the second.
    assert found[-2:] == pytest.approx([60.0, 135.0])


def test_four_against_three_by_hand() -> None:
    # Everybody on the x axis but keeper 3, who has the ball at (0, 3).
    keepers = [(4.0, 0.0), (-4.0, 0.0), (-8.0, 0.0), (0.0, 3.0)]
    takers = [(8.0, 0.0), (0.0, 0.0), (-3.0, 3.0)]
    found = variables([*keepers, *takers], (0.0, 3.0), 4)
    assert len(found) == 19
    # K1 = 3. Teammates: 0 and 1 both at 5 (sqrt(16 + 9)): the higher number first, so K2 = 1, K3 = 0; K4 = 2
    # at sqrt(64 + 9). Takers: 5 and 6 both at 3: T1 = 6, T2 = 5, then T3 = 4 at sqrt(73).
    assert found[:7] == pytest.approx([3.0, 5.0, 5.0, math.sqrt(73), 3.0, 3.0, math.sqrt(73)])
    # To the centre: K2 4, K3 4, K4 8; T1 sqrt(9 + 9), T2 0, T3 8.
    assert found[7:13] == pytest.approx([4.0, 4.0, 8.0, math.sqrt(18), 0.0, 8.0])
    # K2 (-4, 0): taker 6 at (-3, 3) is sqrt(1 + 9) away, taker 5 is 4 away. K3 (4, 0): takers 5 and 4 are
    # both 4 away. K4 (-8, 0): taker 6 is sqrt(25 + 9) away.
    assert found[13:16] == pytest.approx([math.sqrt(10), 4.0, math.sqrt(34)])
    # At (0, 3), 0 degrees = straight down. Taker 5: 0; taker 6: 90 to the left; taker 4: atan(8/3) to the
    # right.
    # K2: atan(4/3) = 53.13 to the left, so 53.13 from taker 5 and 36.87 from taker 6. K3: 53.13 to the right;
    # taker 4 is at 69.44, so 16.31 away. K4: 69.44 to the left, 20.56 from taker 6.
    right = math.degrees(math.atan(8 / 3))
    expected = [90 - math.degrees(math.atan(4 / 3)), right - math.degrees(math.atan(4 / 3)), 90 - right]
    assert found[16:] == pytest.approx(expected)


def test_k1_is_the_keeper_nearest_to_the_ball() -> None:
    ball_at_keeper_2 = variables([*THREE, (3.0, 0.0), (0.0, 4.0)], (-8.5, 4.0), 3)
    # K1 = keeper 2 at (-9, 4): its teammates are 12 and sqrt(144 + 64) away.
    assert ball_at_keeper_2[:3] == pytest.approx([math.sqrt(97), 12.0, math.sqrt(208)])


def test_of_equally_near_keepers_the_highest_number_counts() -> None:
    players = np.array([(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, 0.0)])
    assert nearest_keeper(players, np.zeros(2), 3) == 2
    out = np.zeros(3, dtype=np.int64)
    by_distance(players, 3, 0, out)
    assert out.tolist() == [2, 1, 0]


@pytest.mark.parametrize(("keepers", "takers", "count"), [(3, 2, 13), (4, 3, 19), (2, 1, 7), (6, 5, 31)])
def test_numbers_names_and_widths_agree(keepers: int, takers: int, count: int) -> None:
    assert n_variables(keepers, takers) == count
    assert len(set(variable_names(keepers, takers))) == count
    assert len(tile_widths(keepers, takers)) == count


def test_names_follow_the_order_of_the_variables() -> None:
    assert variable_names(3, 2) == (
        *("K1-C", "K1-K2", "K1-K3", "K1-T1", "K1-T2"),
        *("K2-C", "K3-C", "T1-C", "T2-C"),
        *("K2-nearest T", "K3-nearest T", "angle T-K1-K2", "angle T-K1-K3"),
    )


def test_tile_widths_of_the_benchmark() -> None:
    # Groups: K1 C; K1 K; K1 T; K C; T C; nearest taker; angle.
    assert tile_widths(3, 2) == (2, *(2, 3), *(2, 3), *(2, 3), *(3, 3), *(4, 4), *(10, 10))
    assert tile_widths(4, 3) == (
        *(2, 2, 2, 3, 3, 3, 3),
        *(2, 2, 3, 3, 3, 3),
        *(4, 4, 4, 10, 10, 10),
    )


def test_tile_widths_of_other_numbers() -> None:
    assert tile_widths(2, 1) == (2, 2, 2, 2, 3, 4, 10)
    assert tile_widths(5, 4)[:9] == (2, 2, 2, 2, 3, 3, 3, 3, 3)


@pytest.mark.parametrize("function", [n_variables, variable_names, tile_widths])
@pytest.mark.parametrize(("teams", "name"), [((1, 2), "keepers"), ((3, 0), "takers"), ((2.5, 1), "keepers")])
def test_impossible_teams_are_errors(function: Any, teams: Any, name: str) -> None:
    with pytest.raises(InputError, match=f"{name} must be an integer of at least"):
        function(*teams)


def test_a_taker_on_top_of_k1_blocks_every_pass() -> None:
    found = variables([(0.0, 0.0), (-1.0, 0.0), (0.0, -2.0), (-0.0, 0.0), (5.0, 5.0)], (0.0, 0.0), 3)
    assert found[-2:].tolist() == [0.0, 0.0]


coordinates = st.floats(-12.0, 12.0).map(lambda value: round(value, 3))


@st.composite
def states(draw: st.DrawFn) -> tuple[Floats, Floats, int]:
    """Positions of players and ball, and the number of keepers."""
    keepers, takers = draw(st.integers(2, 5)), draw(st.integers(1, 4))
    players = draw(arrays(np.float64, (keepers + takers, 2), elements=coordinates))
    return players, draw(arrays(np.float64, 2, elements=coordinates)), keepers


def slow_variables(players: Floats, ball: Floats, keepers: int) -> list[float]:
    """Compute the same from the definition, with sorting and complex numbers."""
    numbers = list(range(len(players)))[::-1]
    k1 = min((i for i in numbers if i < keepers), key=lambda i: float(np.sum((players[i] - ball) ** 2)))

    def gap(i: int, j: int) -> float:
        return float(np.sum((players[i] - players[j]) ** 2))

    def angle(i: int, j: int) -> float:
        there, away = (complex(*(players[k] - players[k1])) for k in (i, j))
        ratio = there * away.conjugate()
        return abs(math.degrees(cmath.phase(ratio))) if ratio else 0.0

    mates = sorted((i for i in numbers if i < keepers and i != k1), key=lambda i: gap(k1, i))
    takers = sorted((i for i in numbers if i >= keepers), key=lambda i: gap(k1, i))
    return [
        math.hypot(*players[k1]),
        *(math.sqrt(gap(k1, i)) for i in mates + takers),
        *(math.hypot(*players[i]) for i in mates + takers),
        *(min(math.sqrt(gap(i, j)) for j in takers) for i in mates),
        *(min(angle(i, j) for j in takers) for i in mates),
    ]


@given(states())
def test_they_are_what_their_definition_says(state: tuple[Floats, Floats, int]) -> None:
    players, ball, keepers = state
    assert variables(players, ball, keepers) == pytest.approx(
        slow_variables(players, ball, keepers), rel=1e-9, abs=1e-6
    )


@given(states(), st.integers(0, 3), st.sampled_from([1.0, -1.0]))
def test_turning_or_mirroring_everything_changes_nothing(
    state: tuple[Floats, Floats, int], quarters: int, mirror: float
) -> None:
    # Quarter turns and reflections keep all squares exact, so that ties stay ties.
    players, ball, keepers = state
    cos, sin = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarters]
    motion = np.array([[cos, sin], [-sin, cos]]) @ np.diag([1.0, mirror])
    moved = variables(players @ motion, ball @ motion, keepers)
    np.testing.assert_allclose(moved, variables(players, ball, keepers), rtol=1e-12, atol=1e-12)


def test_turning_by_any_angle_changes_nothing() -> None:
    rng = np.random.default_rng(0)
    for angle in rng.uniform(-math.pi, math.pi, 50):
        # Far from ties, which rounding could break.
        players, ball = rng.uniform(-10, 10, (7, 2)), rng.uniform(-10, 10, 2)
        motion = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
        moved = variables(players @ motion, ball @ motion, 4)
        np.testing.assert_allclose(moved, variables(players, ball, 4), atol=1e-6)
