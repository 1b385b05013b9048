from __future__ import annotations

import math

import numpy as np
import pytest

from relforest.rl.bellman import Lookahead
from relforest.rl.selection import Fit, f_test, fit_of, select
from relforest.scenes.arrays import FloatArray


def lookahead(values: list[float], errors: list[float]) -> Lookahead:
    as_array: FloatArray = np.array(values)
    return Lookahead(as_array, np.full(len(values), -1), np.array(errors))


def test_f_test_by_hand() -> None:
    statistic, p_value = f_test(Fit(120.0, 2, 104), Fit(100.0, 4, 104))
    # F = (20 / 2) / (100 / 100) = 10 with 2 and 100 degrees of freedom; for 2, the upper tail is just
    # (1 + 2 F / 100) ** -50.
    assert statistic == 10.0
    assert p_value == pytest.approx(1.2**-50)


@pytest.mark.parametrize(
    ("new", "why"),
    [
        (Fit(120.0, 4, 104), "no improvement"),
        (Fit(130.0, 4, 104), "worse"),
        (Fit(100.0, 2, 104), "no features more"),
        (Fit(100.0, 104, 104), "no degrees of freedom left"),
        (Fit(math.inf, 4, 104), "constant values"),
    ],
)
def test_candidates_without_merit(new: Fit, why: str) -> None:
    assert f_test(Fit(120.0, 2, 104), new)[1] == 1.0, why


def test_any_fit_beats_constant_values() -> None:
    constant = Fit(math.inf, 2, 104)
    assert f_test(constant, Fit(1e6, 5, 104))[1] == 0.0
    assert f_test(constant, Fit(math.inf, 5, 104))[1] == 1.0


def test_a_perfect_fit_is_significant() -> None:
    assert f_test(Fit(1.0, 2, 104), Fit(0.0, 5, 104))[1] == 0.0


def test_errors_are_measured_in_deviations_of_the_values() -> None:
    # Values 1 and 3: standard deviation 1. Values 2 and 6: 2, so the same errors count a quarter.
    assert fit_of(lookahead([1.0, 3.0], [1.0, 2.0]), 3) == Fit(5.0, 3, 2)
    assert fit_of(lookahead([2.0, 6.0], [1.0, 2.0]), 3) == Fit(1.25, 3, 2)


@pytest.mark.parametrize("value", [0.0, 0.1])
def test_constant_values_have_infinite_error(value: float) -> None:
    assert fit_of(lookahead([value] * 7, [0.0] * 7), 1).squared_error == math.inf


OLD = Fit(120.0, 2, 104)


def test_the_most_significant_candidate_is_selected() -> None:
    candidates = [Fit(110.0, 4, 104), Fit(100.0, 4, 104), Fit(100.0, 9, 104)]
    assert select(OLD, candidates, 0.0125) == 1


def test_none_is_selected_above_the_threshold() -> None:
    candidates = [Fit(119.0, 4, 104)]
    p_value = f_test(OLD, candidates[0])[1]
    assert select(OLD, candidates, p_value) is None
    assert select(OLD, candidates, p_value * 1.001) == 0
    assert select(OLD, [], 0.5) is None


def test_vanishing_p_values_are_ordered_by_statistic_then_error_then_place() -> None:
    huge = Fit(1e9, 2, 5000)
    # Both p-values underflow to 0.
    assert select(huge, [Fit(2.0, 4, 5000), Fit(1.0, 4, 5000)], 0.01) == 1
    constant = Fit(math.inf, 2, 104)
    assert select(constant, [Fit(3.0, 4, 104), Fit(2.0, 9, 104), Fit(2.0, 4, 104)], 0.01) == 1
