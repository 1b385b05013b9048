"""What holds for every geometric peer: who learns, what does not matter, and what is refused."""

from __future__ import annotations

import functools
import os
import re
from typing import Any

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.model_selection import cross_val_score
from sklearn.pipeline import make_pipeline

from interpreted import compiled_only
from mil.baselines.learnable import N_BAGS, Y, squeezed
from relforest.mil.baselines import (
    APRClassifier,
    DiverseDensityClassifier,
    EMDDClassifier,
    OptimalBallClassifier,
)
from relforest.mil.scaling import BagScaler
from relforest.support.errors import InputError

pytestmark = compiled_only

BAGS, TEST = squeezed(), squeezed(1)
# EM-DD from all bags, because the order of bags decides which ones are drawn.
PEERS = {
    "ball": OptimalBallClassifier(),
    "ball, own units": OptimalBallClassifier(normalize=False),
    "box": APRClassifier(),
    "box, scaled": APRClassifier(scale=True),
    "density": DiverseDensityClassifier(),
    "density, own units": DiverseDensityClassifier(scale=False),
    "EM": EMDDClassifier(start_bags=None, random_state=0),
    "EM, own units": EMDDClassifier(start_bags=None, scale=False, random_state=0),
}
# Interpreted, ten thousand would take minutes.
MANY = 50 if os.environ.get("NUMBA_DISABLE_JIT") == "1" else 10_000
SCALED = ["ball", "box, scaled", "density", "EM"]
ALL = pytest.mark.parametrize("peer", PEERS)


def fitted(peer: str, bags: Any, y: Any = Y) -> Any:
    return clone(PEERS[peer]).fit(bags, y)


@functools.cache
def learned(peer: str) -> Any:
    """Fit to `BAGS`; for all tests, which must leave it as it is."""
    return fitted(peer, BAGS)


@ALL
def test_it_learns_the_concept(peer: str) -> None:
    model = learned(peer)

    assert model.score(BAGS, Y) >= 0.96
    assert model.score(TEST, Y) >= 0.85
    # The concept is one instance of each odd bag.
    inside = np.array(model.predict_instances(TEST))
    assert inside[1::2].sum() == pytest.approx(N_BAGS / 2, abs=3)
    near = np.abs(TEST - 4).max(axis=2) < 1.5
    assert (np.array(model.witness(TEST))[1::2] == near[1::2].argmax(axis=1)).mean() > 0.9


@ALL
def test_the_order_of_bags_and_instances_does_not_matter(peer: str) -> None:
    rng = np.random.default_rng(3)
    shuffled = rng.permutation(N_BAGS)
    bags = [rng.permutation(BAGS[bag]) for bag in shuffled]
    expected, model = learned(peer), fitted(peer, bags, Y[shuffled])

    np.testing.assert_allclose(
        model.decision_function(TEST), expected.decision_function(TEST), rtol=1e-4, atol=1e-4
    )


@ALL
def test_the_origin_does_not_matter(peer: str) -> None:
    model = fitted(peer, BAGS + np.array([100.0, -30.0]))

    np.testing.assert_allclose(
        model.decision_function(TEST + np.array([100.0, -30.0])),
        learned(peer).decision_function(TEST),
        rtol=1e-3,
        atol=1e-3,
    )


@pytest.mark.parametrize("peer", SCALED)
def test_units_do_not_matter_where_features_are_scaled(peer: str) -> None:
    units = np.array([1000.0, 1e-3])
    model = fitted(peer, BAGS * units)

    np.testing.assert_allclose(
        model.decision_function(TEST * units), learned(peer).decision_function(TEST), rtol=1e-3, atol=1e-3
    )


# Not the diverse density, whose noisy-or counts every instance; see its own tests.
@pytest.mark.parametrize("peer", [name for name in PEERS if not name.startswith("density")])
def test_instances_given_twice_change_nothing(peer: str) -> None:
    model = fitted(peer, np.concatenate([BAGS, BAGS], axis=1))

    np.testing.assert_allclose(
        model.decision_function(np.concatenate([TEST, TEST], axis=1)),
        learned(peer).decision_function(TEST),
        rtol=1e-9,
        atol=1e-9,
    )


@ALL
def test_fitting_again_gives_the_same(peer: str) -> None:
    first, second = learned(peer), fitted(peer, BAGS)

    assert first.decision_function(TEST).tolist() == second.decision_function(TEST).tolist()


@ALL
def test_features_constant_in_training_do_not_matter(peer: str) -> None:
    bags = np.concatenate([BAGS, np.full((N_BAGS, 3, 1), 0.1)], axis=2)
    test = np.concatenate([TEST, np.full((N_BAGS, 3, 1), 77.0)], axis=2)
    scores = fitted(peer, bags).decision_function(test)

    if peer == "ball, own units":
        assert (scores < 0).all()  # its distances count every feature
    else:
        np.testing.assert_allclose(scores, learned(peer).decision_function(TEST), rtol=1e-4, atol=1e-4)


@ALL
def test_bags_that_are_all_alike_are_all_positive(peer: str) -> None:
    model = fitted(peer, np.ones((6, 2, 3)), [0, 1] * 3)

    assert model.predict(np.ones((2, 1, 3))).tolist() == [1, 1]
    assert np.isfinite(model.decision_function(np.ones((2, 1, 3)))).all()


@ALL
def test_two_bags_are_enough(peer: str) -> None:
    model = fitted(peer, [[[0.0, 1.0]], [[5.0, 5.0], [7.0, 6.0]]], [1, 0])

    assert model.predict([[[0.0, 1.0]], [[5.0, 5.0]]]).tolist() == [1, 0]


@ALL
def test_bags_of_one_instance_and_of_many_features(peer: str) -> None:
    rows = np.random.default_rng(0).standard_normal((10, MANY))
    rows[1::2] += 3
    model = fitted(peer, rows, np.arange(10) % 2)

    assert model.predict(rows).tolist() == [0, 1] * 5


@ALL
@pytest.mark.parametrize("factor", [5e28, 1e-25])
def test_scores_stay_finite_at_extreme_units(peer: str, factor: float) -> None:
    scores = fitted(peer, BAGS * factor).decision_function(TEST * factor)

    assert np.isfinite(scores).all()
    assert np.isfinite(learned(peer).decision_function(TEST + 9e29)).all()


@ALL
def test_an_instance_far_out_in_each_class_is_survived(peer: str) -> None:
    far = np.full((2, 3, 2), 1e20)
    scores = fitted(peer, np.concatenate([BAGS, far]), [*Y, 0, 1]).decision_function(TEST)

    assert np.isfinite(scores).all()


@ALL
@pytest.mark.parametrize(
    ("bags", "y", "message"),
    [
        ([], [], "there are no bags"),
        ([[[0.0]], []], [0, 1], "bag 1 is empty"),
        ([[[0.0]], [[0.0, 1.0]]], [0, 1], "bag 1 has points of 2 components, but bag 0 of 1"),
        ([[[0.0]], [[np.nan]]], [0, 1], "Input X contains NaN or infinity: bag 1, row 0, component 0"),
        ([[[0.0]], [[np.inf]]], [0, 1], "Input X contains NaN or infinity"),
        ([[[0.0]], [[1e31]]], [0, 1], "values beyond 1e+30: use other units"),
        ([[[0.0]], [[-1e31]]], [0, 1], "values beyond 1e+30: use other units"),
        (np.zeros((1, 1)), [1], "labels of 2 classes are needed, but 1 bags have only 1 class: 1"),
        (np.zeros((2, 1)), [1, 1], "labels of 2 classes are needed, but 2 bags have only 1 class: 1"),
        (np.zeros((3, 1)), [0, 1, 2], "3 bags have 3 classes"),
    ],
)
def test_bad_bags_and_labels_are_refused(peer: str, bags: Any, y: Any, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        fitted(peer, bags, y)


@ALL
def test_bad_bags_to_predict_are_refused(peer: str) -> None:
    model = learned(peer)

    with pytest.raises(NotFittedError):
        clone(model).predict(BAGS)
    with pytest.raises(InputError, match=r"X has 3 features, but .* is expecting 2 features"):
        model.predict(np.zeros((2, 1, 3)))
    with pytest.raises(InputError, match="beyond 1e"):
        model.decision_function(np.full((2, 1, 2), 1e31))
    with pytest.raises(InputError, match="beyond 1e"):
        model.predict_instances(np.full((2, 1, 2), 1e31))


@pytest.mark.parametrize(
    ("model", "message"),
    [
        (APRClassifier(margin=-1.0), "margin must be a finite number of at least 0, got -1.0"),
        (APRClassifier(tau=1.0), "tau must be a number of at least 1e-06 and below 1, got 1.0"),
        (APRClassifier(tau=1e-17), "tau must be a number of at least 1e-06 and below 1, got 1e-17"),
        (APRClassifier(epsilon=0), "epsilon must be a number of at least 1e-12 and below 1, got 0"),
        (APRClassifier(epsilon=5e-324), "epsilon must be a number of at least 1e-12 and below 1, got 5e-324"),
        (DiverseDensityClassifier(refined=0), "refined must be an integer of at least 1, got 0"),
        (DiverseDensityClassifier(max_steps=0), "max_steps must be an integer of at least 1, got 0"),
        (EMDDClassifier(start_bags=0), "start_bags must be an integer of at least 1, got 0"),
        (EMDDClassifier(max_steps=0), "max_steps must be an integer of at least 1, got 0"),
        (EMDDClassifier(random_state=-1), "random_state must be an integer of at least 0"),
    ],
)
def test_bad_parameters_are_refused(model: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        model.fit(BAGS, Y)


@ALL
def test_it_works_behind_a_scaler_and_in_cross_validation(peer: str) -> None:
    pipeline = make_pipeline(BagScaler(), clone(PEERS[peer]))

    assert cross_val_score(pipeline, list(BAGS), Y, cv=3).mean() > 0.8
