"""The optimal ball."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import ortho_group

from mil.baselines.learnable import Y, squeezed
from reference import baselines as reference
from relforest.mil.baselines import OptimalBallClassifier, optimal_ball


def test_a_ball_on_a_line() -> None:
    # Positive bags at {0, 20}, 1 and 2; negative ones at {-8, 9} and 30. From 0 the distances are 0, 1, 2
    # (positive), 8 and 30: the cut between 2 and 8 at 5 is right for all. From 1: 0, 1, 1 | 8 -> 4.5;
    # from 2: 0, 1, 2 | 7 -> 4.5; from 20: the own bag, then 30 at 10. So the centre is 0, the widest.
    bags = [[[20.0], [0.0]], [[1.0]], [[2.0]], [[-8.0], [9.0]], [[30.0]]]
    model = OptimalBallClassifier(normalize=False).fit(bags, [1, 1, 1, 0, 0])

    assert (model.centre_.tolist(), model.radius_, model.scales_.tolist()) == ([0.0], 5.0, [1.0])
    assert model.decision_function([[[5.0]], [[5.5], [-3.0]], [[7.0]]]).tolist() == [0.0, 2.0, -2.0]
    assert model.predict([[[5.0]], [[5.5], [-3.0]], [[7.0]]]).tolist() == [1, 1, 0]
    assert model.decision_instances([[[5.5], [-3.0]]])[0].tolist() == [-0.5, 2.0]


def test_the_range_is_one_after_normalisation() -> None:
    # The line above, 38 wide, as the second feature; the first one is constant.
    line = [[20.0, 0.0], [1.0], [2.0], [-8.0, 9.0], [30.0]]
    bags = [[[7.0, x] for x in bag] for bag in line]
    model = OptimalBallClassifier().fit(bags, [1, 1, 1, 0, 0])

    assert model.centre_.tolist() == [7.0, 0.0]
    assert model.scales_.tolist() == [0.0, 1 / 38]
    assert model.radius_ == pytest.approx(5 / 38)
    assert model.predict([[[-500.0, 4.9]], [[7.0, 5.1]]]).tolist() == [1, 0]


def test_a_ball_may_hold_all_bags() -> None:
    # The negative bag lies amid the positive ones: all inside is right for 2 of 3, one positive alone also.
    model = OptimalBallClassifier(normalize=False).fit([[[0.0]], [[1.0]], [[2.0]]], [1, 0, 1])

    assert model.radius_ == pytest.approx(2.0)
    assert model.radius_ > 2.0
    assert model.predict([[[2.0]], [[-2.0]], [[2.1]]]).tolist() == [1, 1, 0]


def test_bags_at_equal_distances_are_not_parted() -> None:
    # From 0, a positive bag at 1 and a negative one at -1: all three are inside, or only the own bag.
    model = OptimalBallClassifier(normalize=False).fit([[[0.0]], [[1.0]], [[-1.0]]], [1, 1, 0])

    # From 1: 0, 1 | 2 is right for all.
    assert (model.centre_.tolist(), model.radius_) == ([1.0], 1.5)


@given(st.integers(0, 2**32 - 1))
def test_the_plain_twin_finds_the_same(seed: int) -> None:
    rng = np.random.default_rng(seed)
    # Few distinct values, so that distances are often equal.
    bags = [rng.integers(0, 5, (rng.integers(1, 4), 2)).astype(float) for _ in range(8)]
    positive = np.array([True, False, *(rng.random(6) < 0.5)])
    right, radius = reference.best_ball(bags, positive)
    model = OptimalBallClassifier(normalize=False).fit(bags, positive)

    assert model.radius_ == pytest.approx(radius)
    distances = [np.linalg.norm(bag - model.centre_, axis=1).min() for bag in bags]
    assert ((np.array(distances) <= model.radius_) == positive).sum() == right
    assert (model.predict(bags) == positive).sum() == right


def test_blocks_of_centres_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(5)
    bags = [rng.standard_normal((size, 3)) for size in rng.integers(1, 10, 80)]
    y = np.arange(80) % 2
    whole = OptimalBallClassifier().fit(bags, y)
    monkeypatch.setattr(optimal_ball, "_LARGEST_TABLE", 3000)
    pieces = OptimalBallClassifier().fit(bags, y)
    assert (whole.centre_.tolist(), whole.radius_) == (pieces.centre_.tolist(), pieces.radius_)


def test_a_rotation_does_not_matter_without_normalisation() -> None:
    bags, test = squeezed(d=3), squeezed(1, d=3)
    rotation = ortho_group(dim=3, seed=0).rvs()
    model = OptimalBallClassifier(normalize=False).fit(bags, Y)
    turned = OptimalBallClassifier(normalize=False).fit(bags @ rotation, Y)

    np.testing.assert_allclose(turned.centre_, model.centre_ @ rotation)
    np.testing.assert_allclose(turned.decision_function(test @ rotation), model.decision_function(test))
