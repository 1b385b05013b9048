from __future__ import annotations

import numpy as np
import pytest

from relforest.rl.bellman import error_labels, look_ahead
from rl.linear_problems import transitions_of


def test_errors_by_hand() -> None:
    # Type 0: Q = 1 for pair 0 and 2 for pair 1. Type 1: Q = 3 * 1 + 1 * (-1) = 2 and 0.
    features = [np.array([[1.0], [2.0]]), np.array([[1.0, -1.0], [0.0, 0.0]])]
    weights = [np.array([1.0]), np.array([3.0, 1.0])]
    transitions = transitions_of(
        [
            ((0, 0), 1.0, 0.5, [(0, 1), (1, 0), (1, 1)]),  # max(2, 2, 0), the first: 1 + 0.5 * 2 - 1 = 1
            ((1, 0), 0.5, 0.25, [(1, 1)]),  # 0.5 + 0.25 * 0 - 2 = -1.5
            ((0, 1), 3.0, 0.0, []),  # 3 - 2 = 1
        ]
    )
    found = look_ahead(features, weights, transitions)
    assert found.values.tolist() == [1.0, 2.0, 2.0]
    assert found.chosen.tolist() == [0, 3, -1]
    assert found.errors.tolist() == [1.0, -1.5, 1.0]
    assert found.squared_error == 1.0 + 2.25 + 1.0


def test_negative_values_are_not_replaced_by_nothing() -> None:
    transitions = transitions_of([((0, 0), 0.0, 0.5, [(0, 1)])])
    found = look_ahead([np.array([[0.0], [1.0]])], [np.array([-4.0])], transitions)
    assert found.errors.tolist() == [-2.0]


def test_labels_are_above_the_mean_of_their_own_type() -> None:
    # Means: type 0 (0 + 4) / 2 = 2, type 1 (10 + 10 + 13) / 3 = 11.
    labels = error_labels(np.array([0.0, 10.0, 4.0, 10.0, 13.0]), np.array([0, 1, 0, 1, 1]))
    assert labels.tolist() == [False, False, True, False, True]


@pytest.mark.parametrize("error", [0.1, 1e-17, -0.7])
def test_equal_errors_have_no_label_above(error: float) -> None:
    # The mean of 7 times 0.1 is 0.09999999999999999 in floating point.
    assert not error_labels(np.full(7, error), np.zeros(7, dtype=np.int64)).any()
