from __future__ import annotations

import numpy as np
import pytest

from relforest.worlds.corridor.dynamics import reward


@pytest.mark.parametrize(
    ("x", "expected"),
    [
        (0.0, 1.0),
        (0.05, 1.0),
        (0.1, 1.0),  # the boundary of the window belongs to it
        (np.nextafter(0.1, 1.0), 0.0),
        (0.5, 0.0),
        (np.nextafter(0.9, 0.0), 0.0),
        (0.9, 1.0),
        (1.0, 1.0),
    ],
)
def test_windows_at_both_edges_pay_inclusively(x: float, expected: float) -> None:
    assert reward(x) == expected
    np.testing.assert_array_equal(reward(np.array([x])), [expected])


def test_a_single_location_pays_a_python_float() -> None:
    assert type(reward(0.05)) is float
    assert type(reward(0.5)) is float


@pytest.mark.parametrize(
    ("window", "expected"), [(0.0, [1.0, 0.0, 0.0]), (0.3, [1.0, 1.0, 0.0]), (0.5, [1.0] * 3)]
)
def test_the_window_is_an_option(window: float, expected: list[float]) -> None:
    np.testing.assert_array_equal(reward(np.array([0.0, 0.3, 0.5]), window=window), expected)
