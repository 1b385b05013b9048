from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.worlds.keepaway.server.rounding import heading, whole, wrapped


@pytest.mark.parametrize(
    ("value", "expected"),
    [(2.9, 2), (-2.9, -2), (0.4, 0), (-0.4, 0), (3.0 - 1e-12, 3), (-3.0 + 1e-12, -3), (179.9999, 179)],
)
def test_numbers_are_cut_towards_zero_unless_rounding_made_them_smaller(value: float, expected: int) -> None:
    assert whole(value) == expected


@pytest.mark.parametrize(
    ("angle", "expected"),
    [(0.0, 0.0), (180.0, 180.0), (-180.0, 180.0), (190.0, -170.0), (-190.0, 170.0), (540.0, 180.0)],
)
def test_angles_lie_above_minus_180_and_up_to_180(angle: float, expected: float) -> None:
    assert wrapped(angle) == expected


def test_rounding_does_not_decide_to_which_side_a_player_turns_round() -> None:
    assert wrapped(-180.0 + 1e-12) == pytest.approx(180.0)
    assert wrapped(180.0 + 1e-12) == pytest.approx(180.0)


@given(st.floats(-1000.0, 1000.0))
def test_wrapping_changes_an_angle_by_whole_turns(angle: float) -> None:
    turns = (wrapped(angle) - angle) / 360.0

    assert turns == pytest.approx(round(turns), abs=1e-9)
    assert -180.0 < wrapped(angle) < 180.0 + 1e-6


def test_headings() -> None:
    assert heading(1.0, 1.0) == pytest.approx(45.0)
    assert heading(0.0, -2.0) == pytest.approx(-90.0)
    assert heading(0.0, -0.0) == 0.0
    assert heading(-0.0, 0.0) == 0.0
