"""The diverse density and its gradient."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import approx_fprime
from scipy.special import expit

from reference import baselines as reference
from relforest.mil.baselines.noisy_or import (
    CERTAINTY,
    Sample,
    as_sample,
    bag_log_odds,
    fill_squared_distances,
    instance_log_odds,
    negative_log_density,
)

Floats = NDArray[np.float64]


def sample(bags: list[Floats], positive: list[bool]) -> Sample:
    starts = np.cumsum([0, *map(len, bags)])
    return as_sample(np.concatenate(bags), starts, np.array(positive))


def evaluated(bags: list[Floats], positive: list[bool], hypothesis: Floats) -> tuple[float, Floats]:
    gradient, slopes = np.empty_like(hypothesis), np.empty(sum(map(len, bags)))
    value = negative_log_density(sample(bags, positive), hypothesis, gradient, slopes)
    return value, gradient


def some_bags(seed: int, spread: float = 1.0) -> tuple[list[Floats], list[bool], Floats]:
    rng = np.random.default_rng(seed)
    bags = [spread * rng.standard_normal((rng.integers(1, 5), 3)) for _ in range(6)]
    hypothesis = np.stack([spread * rng.standard_normal(3), rng.standard_normal(3)])
    return bags, [True, False, True, True, False, False], hypothesis


def test_a_density_worked_by_hand() -> None:
    # One feature, centre 1, scale 2. The positive bag has D^2 = 4 and 0: 1 - (1 - e^-4)(1 - 1) = 1.
    # The negative bag has D^2 = 1: 1 - e^-1 = 0.6321.
    bags = [np.array([[0.0], [1.0]]), np.array([[1.5]])]
    value, _ = evaluated(bags, [True, False], np.array([[1.0], [2.0]]))

    assert value == pytest.approx(-math.log(0.6321205588), rel=1e-5)


@given(st.integers(0, 2**32 - 1))
def test_it_is_the_product_of_all_probabilities(seed: int) -> None:
    bags, positive, hypothesis = some_bags(seed)
    expected = reference.negative_log_density(bags, np.array(positive), *hypothesis)

    assert evaluated(bags, positive, hypothesis)[0] == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_a_bag_counts_as_often_as_it_weighs() -> None:
    bags, positive, hypothesis = some_bags(0)
    counts = [2, 1, 3, 1, 1, 2]
    several = [[bag] * count for bag, count in zip(bags, counts, strict=True)]
    repeated = evaluated(sum(several, []), np.repeat(positive, counts).tolist(), hypothesis)  # noqa: RUF017
    gradient, slopes = np.empty_like(hypothesis), np.empty(sum(map(len, bags)))
    weighted = sample(bags, positive)._replace(weights=np.array(counts, dtype=np.float64))

    value = negative_log_density(weighted, hypothesis, gradient, slopes)
    assert value == pytest.approx(repeated[0], rel=1e-12)
    np.testing.assert_allclose(gradient, repeated[1], rtol=1e-9)


# Near and far bags take different ways through the arithmetic; at 3 and 30 they meet.
@pytest.mark.parametrize("spread", [0.05, 0.5, 1.0, 2.0, 4.0, 30.0])
@pytest.mark.parametrize("seed", range(5))
def test_the_gradient_is_that_of_finite_differences(seed: int, spread: float) -> None:
    bags, positive, hypothesis = some_bags(seed, spread)
    found = evaluated(bags, positive, hypothesis)[1]

    def value(flat: Floats) -> float:
        return evaluated(bags, positive, flat.reshape(2, 3))[0]

    expected = approx_fprime(hypothesis.ravel(), value, 1e-7).reshape(2, 3)
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-4 * max(1.0, np.abs(expected).max()))


@pytest.mark.parametrize("border", [3.0, 30.0])
@pytest.mark.parametrize("other", [0.0, 0.1, 40.0])
def test_the_ways_of_reckoning_agree_at_their_borders(border: float, other: float) -> None:
    values, slopes = [], []
    for nearest in (border - 1e-9, border + 1e-9):
        bags = [np.sqrt([[nearest], [border + other]])]
        value, gradient = evaluated(bags, [True], np.array([[0.0], [1.0]]))
        values.append(value)
        slopes.append(gradient)

    assert values[0] == pytest.approx(values[1], rel=1e-8)
    np.testing.assert_allclose(slopes[0], slopes[1], rtol=1e-7)


def test_a_negative_instance_at_the_centre_is_dear_but_not_infinite() -> None:
    value, gradient = evaluated([np.array([[2.0, 1.0]])], [False], np.array([[2.0, 1.0], [1.0, 1.0]]))

    assert value == pytest.approx(-math.log(1e-6))
    assert gradient.tolist() == [[0, 0], [0, 0]]


def test_bags_beyond_the_range_of_floats_have_finite_surprise() -> None:
    # exp(-10^8) is no float, its logarithm is: 10^8.
    value, gradient = evaluated([np.array([[1e4]])], [True], np.array([[0.0], [1.0]]))

    assert value == pytest.approx(1e8)
    # D^2 = s^2 (x - c)^2: by c -2 * 10^4, by s 2 * 10^8.
    assert gradient.tolist() == [[pytest.approx(-2e4)], [pytest.approx(2e8)]]
    assert evaluated([np.array([[1e4]])], [False], np.array([[0.0], [1.0]]))[0] == 0.0


def test_infinite_distances_give_an_infinite_surprise() -> None:
    with np.errstate(over="ignore"):
        value, _ = evaluated([np.array([[1e30]])], [True], np.array([[0.0], [1e150]]))

    assert value == np.inf


def test_many_certain_instances_of_a_negative_bag_do_not_underflow() -> None:
    # 100 times -log(1e-6), a product of 1e-600.
    value, _ = evaluated([np.zeros((100, 1))], [False], np.array([[0.0], [1.0]]))

    assert value == pytest.approx(600 * math.log(10))


def test_distances_worked_by_hand() -> None:
    squared = np.empty(2)
    fill_squared_distances(np.array([[0.0, 1.0], [5.0, 7.0]]), np.array([[1.0, 5.0], [2.0, -3.0]]), squared)

    # 4 * 1 + 9 * 0, 4 * 0 + 9 * 4
    assert squared.tolist() == [4.0, 36.0]


def test_odds_are_those_of_the_probabilities() -> None:
    squared = np.array([0.0, 0.5, 2.0, 50.0, 1e5])
    p = CERTAINTY * np.exp(-squared)

    np.testing.assert_allclose(expit(instance_log_odds(squared)), p, rtol=1e-9)
    # Where the probability is no float, the odds still are: e^-1e5.
    assert instance_log_odds(squared)[-1] == pytest.approx(-1e5)
    odds = bag_log_odds(squared.copy(), np.array([0, 1, 3, 5]))
    none = np.array([1 - p[0], (1 - p[1]) * (1 - p[2])])
    np.testing.assert_allclose(odds[:2], np.log((1 - none) / none), rtol=1e-9)
    assert odds[2] == pytest.approx(-50, rel=1e-6)


def test_a_bag_of_one_has_the_odds_of_its_instance() -> None:
    squared = np.array([0.1, 1.0, 4.0, 29.0, 31.0, 800.0])

    np.testing.assert_allclose(
        bag_log_odds(squared.copy(), np.arange(7)), instance_log_odds(squared), rtol=1e-8
    )
