from __future__ import annotations

import numpy as np
import pytest

from relforest.rl.baselines.kernels import DIVERGED, NO_FEATURE, action_values, pick

TIED = np.array([2.0, 1.0, 2.0, 2.0])


@pytest.mark.parametrize(
    ("draw", "expected"),
    # Epsilon 0.2: a twentieth of [0, 1) for each of four actions, then 0.8 / 3 for each of the best.
    [
        *[(0.0, 0), (0.04, 0), (0.06, 1), (0.14, 2), (0.19, 3)],
        *[(0.2, 0), (0.46, 0), (0.47, 2), (0.73, 2), (0.74, 3), (np.nextafter(1.0, 0.0), 3)],
    ],
)
def test_one_number_decides_on_exploration_and_ties(draw: float, expected: int) -> None:
    assert pick(TIED, 0.2, draw) == expected


@pytest.mark.parametrize("draw", [0.0, 0.5, np.nextafter(1.0, 0.0)])
def test_a_single_best_action_needs_no_luck(draw: float) -> None:
    assert pick(np.array([-3.0, -1.0, -2.0]), 0.0, draw) == 1


def test_every_draw_explores_at_epsilon_one() -> None:
    assert [pick(TIED, 1.0, draw) for draw in (0.1, 0.3, 0.6, np.nextafter(1.0, 0.0))] == [0, 1, 2, 3]


@pytest.mark.parametrize("index", [-1, 2, 10**12])
def test_features_outside_the_weights_are_noticed(index: int) -> None:
    indices, out = np.array([[0, index]]), np.empty(1)
    assert action_values(np.ones(2), indices, np.ones((1, 2)), out) == NO_FEATURE


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e101])
def test_values_beyond_reason_are_noticed(value: float) -> None:
    indices, out = np.array([[0], [1]]), np.empty(2)
    assert action_values(np.ones(2), indices, np.array([[1.0], [value]]), out) == DIVERGED
