"""EM-DD."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import expit

from interpreted import compiled_only
from mil.baselines.learnable import Y, squeezed
from reference import baselines as reference
from relforest.mil.baselines import EMDDClassifier
from relforest.mil.baselines.em_dd import count_mistakes, improve_by_rounds, witnesses
from relforest.mil.baselines.noisy_or import as_sample

BAGS = squeezed()


def noisy() -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Bags (30, 3, 2) that no hypothesis parts."""
    rng = np.random.default_rng(2)
    bags = rng.standard_normal((30, 3, 2))
    bags[1::2, 0] = [1, 0] + 0.5 * rng.standard_normal((15, 2))
    return bags, np.arange(30) % 2 == 1


def test_witnesses_and_mistakes_on_a_line() -> None:
    # Centre 0, scale 1: positive at distances up to sqrt(ln 2) = 0.83.
    points = np.array([[3.0], [-0.5], [0.9], [2.0], [0.4], [-0.4]])
    sample = as_sample(points, np.array([0, 2, 4, 6]), np.array([True, True, False]))
    hypothesis, squared = np.array([[0.0], [1.0]]), np.empty(6)

    # The last bag has two points equally near: the first one speaks.
    assert witnesses(sample, hypothesis, squared).tolist() == [1, 2, 4]
    # 0.5 is inside, rightly; 0.9 outside, wrongly; 0.4 inside, wrongly.
    assert count_mistakes(sample, hypothesis, squared) == 2
    assert count_mistakes(sample._replace(weights=np.array([9.0, 0.5, 4.0])), hypothesis, squared) == 4.5


@pytest.mark.parametrize("start", [1, 5, 7, 9])
def test_the_plain_twin_alternates_to_the_same(start: int) -> None:
    bags, positive = noisy()
    hypothesis = np.array([bags[start, 0], [1.0, 1.0]])
    expected, centre, scales = reference.alternate(list(bags), positive, bags[start, 0])
    sample = as_sample(bags.reshape(-1, 2), np.arange(0, 91, 3), positive)
    value = improve_by_rounds(sample, hypothesis, 500, np.empty(90))

    assert value == pytest.approx(expected, rel=1e-3)
    np.testing.assert_allclose(hypothesis[0], centre, atol=0.02)
    np.testing.assert_allclose(np.abs(hypothesis[1]), np.abs(scales), atol=0.02)


def test_one_instance_per_bag_makes_it_diverse_density() -> None:
    rows = BAGS[:, 0]
    model = EMDDClassifier(start_bags=None, scale=False).fit(rows, Y)
    expected = reference.negative_log_density(list(rows[:, None]), Y == 1, model.centre_, model.scales_)

    assert model.negative_log_density_ == pytest.approx(expected, rel=1e-6)


def test_scores_are_log_odds_of_the_best_instance() -> None:
    model = EMDDClassifier(random_state=0).fit([[[0.0]], [[1.0]]], [0, 1])
    model.centre_, model.scales_ = np.array([1.0]), np.array([2.0])
    half, quarter = (1 + math.sqrt(math.log(n)) / 2 for n in (2, 4))

    assert expit(model.decision_function([[[quarter]], [[quarter], [half]]])) == pytest.approx(
        [1 / 4, 1 / 2], rel=1e-5
    )
    # Many improbable instances are no probable one.
    assert model.predict([[[quarter]] * 9]).tolist() == [0]


@compiled_only
def test_the_seed_decides_which_bags_it_starts_from() -> None:
    noise = np.random.default_rng(0).standard_normal((40, 3, 2))
    y = np.arange(40) % 2

    def centre(seed: int | None, start_bags: int | None = 1) -> list[float]:
        model = EMDDClassifier(start_bags=start_bags, random_state=seed).fit(noise, y)
        return list(model.centre_.tolist())

    assert centre(1) == centre(1)
    assert len({tuple(centre(seed)) for seed in range(8)}) > 1
    # All positive bags, by number or by None: nothing is left to chance.
    assert centre(1, None) == centre(2, None) == centre(3, 1000)


def test_more_starts_make_no_more_mistakes() -> None:
    rng = np.random.default_rng(4)
    bags, y = rng.standard_normal((30, 3, 2)), np.arange(30) % 2
    scores = [EMDDClassifier(start_bags=n, random_state=0).fit(bags, y).score(bags, y) for n in (1, None)]

    assert scores[0] <= scores[1]
