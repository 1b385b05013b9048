"""Ascent on the diverse density."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import minimize

from relforest.mil.baselines.noisy_or import Sample, as_sample, negative_log_density
from relforest.mil.baselines.quasi_newton import descend

Floats = NDArray[np.float64]


def problem(seed: int, d: int = 2) -> tuple[Sample, Floats]:
    """Bags of three, the positive ones with a point near (1, ..., 1), and a start there."""
    rng = np.random.default_rng(seed)
    bags = rng.standard_normal((20, 3, d))
    bags[:10, 0] = 1 + 0.3 * rng.standard_normal((10, d))
    sample = as_sample(bags.reshape(-1, d), np.arange(0, 61, 3), np.arange(20) < 10)
    return sample, np.stack([bags[0, 0], np.ones(d)])


def value_and_gradient(sample: Sample, hypothesis: Floats) -> tuple[float, Floats]:
    gradient = np.empty_like(hypothesis)
    return negative_log_density(sample, hypothesis, gradient, np.empty(len(sample.points))), gradient


@pytest.mark.parametrize("seed", range(4))
def test_it_ends_where_an_independent_optimiser_does(seed: int) -> None:
    sample, start = problem(seed)

    def value_at(flat: Floats) -> float:
        return value_and_gradient(sample, flat.reshape(2, 2))[0]

    expected = minimize(value_at, start.ravel(), method="BFGS", options={"gtol": 1e-6})
    found = start.copy()
    value = descend(sample, found, 500, 1e-12)

    assert value == pytest.approx(expected.fun, rel=1e-6)
    np.testing.assert_allclose(found.ravel(), expected.x, atol=2e-2)
    assert np.abs(value_and_gradient(sample, found)[1]).max() < 1e-3


def test_the_value_is_that_of_the_hypothesis_left_behind() -> None:
    sample, start = problem(7, d=5)
    for steps in (1, 2, 3, 20):
        found = start.copy()
        value = descend(sample, found, steps, 0.0)
        assert value == value_and_gradient(sample, found)[0]


def test_more_steps_never_lose() -> None:
    sample, start = problem(3, d=12)
    values = [descend(sample, start.copy(), steps, 0.0) for steps in (0, 1, 5, 15, 40)]

    assert values[0] == value_and_gradient(sample, start)[0]
    assert all(later <= earlier for earlier, later in itertools.pairwise(values))


def test_a_tolerance_ends_it_early() -> None:
    sample, start = problem(1, d=5)
    rough, fine = (descend(sample, start.copy(), 500, tolerance) for tolerance in (0.1, 1e-9))

    assert fine < rough


def test_a_start_without_slope_stays() -> None:
    # A negative instance at the centre: the gradient is zero.
    sample = as_sample(np.zeros((1, 2)), np.array([0, 1]), np.array([False]))
    hypothesis = np.array([[0.0, 0.0], [1.0, 1.0]])

    assert descend(sample, hypothesis, 50, 0.0) == pytest.approx(-np.log(1e-6))
    assert hypothesis.tolist() == [[0, 0], [1, 1]]


def test_a_line_without_end_is_left_at_its_lowest_trial() -> None:
    # A negative point alone: the density rises for ever as the centre leaves it.
    sample = as_sample(np.zeros((1, 1)), np.array([0, 1]), np.array([False]))
    hypothesis = np.array([[1e-3], [1.0]])
    value = descend(sample, hypothesis, 100, 0.0)

    assert value < 1e-6
    assert np.isfinite(hypothesis).all()


def test_a_bag_far_away_is_reached() -> None:
    sample = as_sample(np.array([[1e4, -1e4]]), np.array([0, 1]), np.array([True]))
    hypothesis = np.array([[0.0, 0.0], [1.0, 1.0]])

    assert descend(sample, hypothesis, 200, 1e-9) < 1e-3
