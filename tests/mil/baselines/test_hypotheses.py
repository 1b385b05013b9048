"""From bags to the space of a search, and back."""

from __future__ import annotations

import numpy as np

from relforest.mil.baselines import DiverseDensityClassifier
from relforest.mil.baselines.hypotheses import search_space
from relforest.mil.baselines.noisy_or import instance_log_odds
from relforest.scenes import as_bags

# Feature 0: mean 3, deviation 2; feature 1 is constant.
BAGS = as_bags([[[1.0, 7.0], [5.0, 7.0]], [[1.0, 7.0]], [[5.0, 7.0]]])
POSITIVE = np.array([True, True, False])
EQUAL = np.ones(3)


def test_features_are_divided_by_their_deviations() -> None:
    search = search_space(BAGS, POSITIVE, EQUAL, scale=True)

    assert search.sample.points.tolist() == [[-1, 0], [1, 0], [-1, 0], [1, 0]]
    assert search.sample.columns.tolist() == [[-1, 1, -1, 1], [0, 0, 0, 0]]
    assert search.factors.tolist() == [0.5, 0]


def test_without_scaling_they_are_only_moved() -> None:
    search = search_space(BAGS, POSITIVE, EQUAL, scale=False)

    assert search.sample.points.tolist() == [[-2, 0], [2, 0], [-2, 0], [2, 0]]
    assert search.factors.tolist() == [1, 0]


def test_starts_are_the_different_instances_of_the_bags_chosen() -> None:
    search = search_space(BAGS, POSITIVE, EQUAL, scale=True)

    assert search.starts(POSITIVE).tolist() == [[[-1, 0], [1, 0]], [[1, 0], [1, 0]]]
    assert search.starts(np.array([False, True, False])).tolist() == [[[-1, 0], [1, 0]]]


def test_a_hypothesis_comes_back_in_the_units_of_the_bags() -> None:
    search = search_space(BAGS, POSITIVE, EQUAL, scale=True)
    centre, scales = search.in_own_units(np.array([[0.5, 0.0], [-3.0, 0.0]]))

    # 3 + 0.5 * 2; scales count as absolute values, per deviation: 3 / 2.
    assert centre.tolist() == [4, 7]
    assert scales.tolist() == [1.5, 0]
    model = DiverseDensityClassifier()
    model.centre_, model.scales_ = centre, scales
    # (1.5 * 2)^2, whatever the constant feature says.
    expected = instance_log_odds(np.array([9.0, 0.0]))
    assert model._instance_scores(np.array([[6.0, 100.0], [4.0, 0.0]])).tolist() == expected.tolist()
