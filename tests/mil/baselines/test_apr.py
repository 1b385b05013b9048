"""Axis-parallel rectangles by iterated discrimination."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm

from mil.baselines.learnable import Y, squeezed
from relforest.mil.baselines import APRClassifier


def test_a_box_learned_by_hand() -> None:
    # Feature 0 parts the classes, feature 1 does not, feature 2 is constant.
    bags = [
        [[0.0, 0.0, 1.0], [90.0, 0.0, 1.0]],
        [[1.0, 4.0, 1.0]],
        [[2.0, 2.0, 1.0]],
        [[50.0, 1.0, 1.0], [60.0, 3.0, 1.0]],
    ]
    model = APRClassifier(margin=0.1).fit(bags, [1, 1, 1, 0])
    # Chosen are 0, 1 and 2; the kernels have sigma = 1 / 3.2905, and the estimate leaves 1/200 beyond.
    sigma = 1 / norm.ppf(0.9995)

    assert model.features_.tolist() == [0]
    assert model.lower_[1:].tolist() == [-np.inf] * 2
    assert model.upper_[1:].tolist() == [np.inf] * 2
    assert np.mean(norm.cdf(model.lower_[0], [0, 1, 2], sigma)) == pytest.approx(0.005)
    assert model.upper_[0] - 2 == pytest.approx(-model.lower_[0])
    assert model.predict([[[1.0, 99.0, 7.0]], [[4.0, 0.0, 1.0]], [[3.0, 0, 0], [-0.1, 0, 0]]]).tolist() == [
        1,
        0,
        1,
    ]


def test_scores_are_distances_from_the_nearest_bound() -> None:
    model = APRClassifier().fit([[[0.0, 0.0]], [[4.0, 2.0]], [[9.0, 9.0]]], [1, 1, 0])
    model.features_ = np.array([0, 1])
    model.lower_, model.upper_ = np.array([0.0, -1.0]), np.array([4.0, 1.0])

    assert model.decision_function([[[2.0, 0.5]], [[0.0, 0.0]], [[6.0, 0.0], [5.0, 1.0]]]).tolist() == [
        0.5,
        0,
        -1,
    ]


def test_all_features_stay_where_the_box_holds_all_negatives() -> None:
    bags = [[[0.0, 0.0]], [[10.0, 10.0]], [[5.0, 5.0], [4.0, 3.0]]]
    model = APRClassifier().fit(bags, [1, 1, 0])

    assert model.features_.tolist() == [0, 1]
    assert model.predict(bags).tolist() == [1, 1, 1]


def test_features_are_selected_again_until_they_stay() -> None:
    noise = np.random.default_rng(0).standard_normal((2, 30, 3, 7))
    bags, test = (np.concatenate([squeezed(seed, d=3), noise[seed]], axis=2) for seed in (0, 1))
    model = APRClassifier().fit(bags, Y)

    assert set(model.features_) <= {0, 1, 2}
    assert model.score(test, Y) > 0.9


def test_the_chosen_instances_are_inside_whatever_the_rounding() -> None:
    # One chosen value per bag, all equal: the box has no width, and scaling must not round it away.
    bags = [[[0.1, 0.3]], [[0.1, 0.7]], [[0.7, 0.5]], [[1 / 3, 1 / 7]]]
    for scale in (True, False):
        model = APRClassifier(scale=scale).fit(bags, [1, 1, 0, 0])
        assert model.predict(bags)[:2].tolist() == [1, 1]


def test_a_narrow_box_from_a_large_epsilon() -> None:
    bags = squeezed()
    sizes = [
        np.sum(m.upper_ - m.lower_) for m in (APRClassifier(epsilon=e).fit(bags, Y) for e in (0.5, 1e-6))
    ]

    assert sizes[0] < sizes[1]


def test_the_least_tau_and_epsilon_still_give_bounds() -> None:
    # One positive instance per bag at 0 and 1. Kernels with 1e-6 of their mass within 1/2 of their middle are
    # sigma = 1 / (2 * 1.2533e-6) = 3.99e5 wide, and 1/200 of the mass is beyond 2.576 sigma.
    bags, y = [[[0.0]], [[1.0]], [[-9.0]]], [1, 1, 0]
    wide = APRClassifier(tau=1e-6).fit(bags, y)

    assert wide.upper_ == pytest.approx(2.5758 * 3.9894e5, rel=1e-4)
    assert wide.lower_ == pytest.approx(1 - wide.upper_)
    # Beyond 7.13 sigma of a kernel there are 5e-13, and sigma is 1 / (2 * 3.2905).
    far = APRClassifier(epsilon=1e-12).fit(bags, y)
    assert 1 < far.upper_[0] <= 1 + 7.14 / 6.581
