"""Diverse density."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np
import pytest
from scipy.special import expit

from mil.baselines.learnable import Y, squeezed
from reference import baselines as reference
from relforest.mil.baselines import DiverseDensityClassifier
from relforest.mil.baselines.diverse_density import densest
from relforest.mil.baselines.noisy_or import as_sample

BAGS = squeezed()


@functools.cache
def learned(**options: Any) -> DiverseDensityClassifier:
    """Fit to `BAGS`; for all tests, which must leave it as it is."""
    return DiverseDensityClassifier(**options).fit(BAGS, Y)


def fixed(centre: float, scale: float) -> DiverseDensityClassifier:
    """A model of one feature with a hypothesis of our choice."""
    model = DiverseDensityClassifier().fit([[[0.0]], [[1.0]]], [0, 1])
    model.centre_, model.scales_ = np.array([centre]), np.array([scale])
    return model


def test_the_density_is_that_of_the_attributes() -> None:
    for scale in (True, False):
        model = learned(scale=scale)
        expected = reference.negative_log_density(list(BAGS), Y == 1, model.centre_, model.scales_)
        assert model.negative_log_density_ == pytest.approx(expected, rel=1e-6)


def test_no_hypothesis_nearby_is_denser() -> None:
    model = learned(scale=False)
    rng = np.random.default_rng(0)
    for _ in range(20):
        centre = model.centre_ + 0.05 * rng.standard_normal(2)
        scales = model.scales_ * (1 + 0.05 * rng.standard_normal(2))
        other = reference.negative_log_density(list(BAGS), Y == 1, centre, scales)
        assert other > model.negative_log_density_ - 1e-3


def test_scores_are_log_odds() -> None:
    # D^2 = ln 4 gives p = 1/4, odds 1 : 3.
    model = fixed(1.0, 2.0)
    x = 1 + math.sqrt(math.log(4)) / 2

    assert model.decision_instances([[[x]]])[0] == pytest.approx([math.log(1 / 3)], rel=1e-5)
    assert model.decision_function([[[x]]]) == pytest.approx([math.log(1 / 3)], rel=1e-5)
    assert expit(model.decision_function([[[x], [x]]])) == pytest.approx([1 - (3 / 4) ** 2], rel=1e-5)


def test_a_bag_may_be_positive_without_a_positive_instance() -> None:
    # Three instances with p = 1/4 each: 1 - (3/4)^3 = 0.578; two: 0.4375.
    model = fixed(0.0, 1.0)
    x = [math.sqrt(math.log(4))]

    assert model.predict([[x, x, x], [x, x]]).tolist() == [1, 0]
    assert [bag.tolist() for bag in model.predict_instances([[x, x, x]])] == [[False] * 3]


def test_instances_given_twice_count_twice() -> None:
    # The noisy-or multiplies 1 - p over all instances, so that it is squared where each comes twice.
    model = learned(scale=True)
    once, twice = (model.decision_function(np.concatenate([BAGS] * times, axis=1)) for times in (1, 2))
    np.testing.assert_allclose(expit(-twice), expit(-once) ** 2, rtol=1e-6)

    # That moves the optimum: the hypothesis for instances that come twice explains them better.
    doubled = np.concatenate([BAGS, BAGS], axis=1)
    other = DiverseDensityClassifier().fit(doubled, Y)
    here = reference.negative_log_density(list(doubled), Y == 1, model.centre_, model.scales_)
    assert other.negative_log_density_ < here
    assert other.score(BAGS, Y) >= 0.96


def test_far_instances_still_have_an_order() -> None:
    model = fixed(0.0, 1.0)

    assert model.witness([[[5000.0], [-4000.0], [6000.0]]]).tolist() == [1]
    assert model.decision_function([[[5000.0]], [[4000.0]]]) == pytest.approx([-25e6, -16e6])


def test_climbing_all_starts_is_never_worse() -> None:
    few, every = learned(refined=1), learned(refined=None)

    assert every.negative_log_density_ <= few.negative_log_density_ + 1e-6


def test_more_starts_wanted_than_there_are() -> None:
    many, every = learned(refined=10_000), learned(refined=None)

    assert many.centre_.tolist() == every.centre_.tolist()


def test_starts_are_the_instances_of_the_largest_positive_bags(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = []

    def spy(sample: object, starts: np.ndarray, kept: int, max_steps: int) -> object:
        seen.append(starts[:, 0].ravel().tolist())
        return densest(sample, starts, kept, max_steps)  # type: ignore[arg-type]  # passed through

    monkeypatch.setattr("relforest.mil.baselines.diverse_density.densest", spy)
    bags = [[[1.0], [2.0]], [[3.0]], [[2.0], [5.0]], [[9.0], [8.0], [7.0]]]
    mean = np.mean([1, 2, 3, 2, 5, 9, 8, 7])
    DiverseDensityClassifier(scale=False).fit(bags, [1, 1, 1, 0])

    assert seen == [[1 - mean, 2 - mean, 5 - mean]]


def test_only_the_most_promising_starts_are_climbed_to_the_end() -> None:
    # One positive bag at 0. Starts at 0.5 and 5: after few steps the first is better, and it alone is kept.
    sample = as_sample(np.array([[0.0], [20.0]]), np.array([0, 1, 2]), np.array([True, False]))
    starts = np.array([[[5.0], [1.0]], [[0.5], [1.0]]])
    both = densest(sample, starts, 2, 100)
    one = densest(sample, starts, 1, 100)

    assert one[1] == pytest.approx(both[1], abs=1e-4)
    assert one[0][0] == pytest.approx([0.0], abs=1e-2)


def test_a_limit_of_steps_holds() -> None:
    short, long = learned(max_steps=1), learned(scale=True)

    assert long.negative_log_density_ < short.negative_log_density_
