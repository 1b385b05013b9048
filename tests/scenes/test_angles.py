from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from relforest.scenes.angles import wrap


def test_a_turn_more_or_less_is_the_same_angle() -> None:
    # 4 - 2 pi = -2.283..., -4 + 2 pi = 2.283..., 10 - 4 pi = -2.566...
    expected = [4 - 2 * np.pi, 2 * np.pi - 4, 10 - 4 * np.pi]

    np.testing.assert_allclose(wrap([4.0, -4.0, 10.0]), expected, atol=1e-15)


def test_half_a_turn_is_positive_on_both_sides() -> None:
    assert wrap([np.pi, -np.pi, 3 * np.pi, -3 * np.pi]).tolist() == [np.pi] * 4


def test_nan_stays() -> None:
    assert np.isnan(wrap(np.array([[np.nan]]))).all()


@given(st.floats(-1e6, 1e6))
def test_wrapped_angles_lie_on_the_half_open_turn_and_point_the_same_way(theta: float) -> None:
    wrapped = float(wrap(theta))

    assert -np.pi < wrapped <= np.pi
    np.testing.assert_allclose([np.cos(wrapped), np.sin(wrapped)], [np.cos(theta), np.sin(theta)], atol=1e-9)


@given(st.floats(np.nextafter(-np.pi, 0), np.pi))
def test_angles_already_wrapped_do_not_change_at_all(theta: float) -> None:
    assert float(wrap(theta)) == theta
