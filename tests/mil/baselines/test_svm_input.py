"""Odd and bad bags for every machine: a documented result, or an error that says what is wrong."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from sklearn.exceptions import NotFittedError

from relforest.mil.baselines import (
    BagMarginSVMClassifier,
    InstanceMarginSVMClassifier,
    MILESClassifier,
    SingleInstanceSVMClassifier,
)
from relforest.support.errors import InputError

MACHINES: dict[str, Any] = {
    "MI-SVM": BagMarginSVMClassifier(),
    "mi-SVM": InstanceMarginSVMClassifier(),
    "single instance": SingleInstanceSVMClassifier(),
    "MILES": MILESClassifier(random_state=0),
}
each_machine = pytest.mark.parametrize("name", MACHINES)


@each_machine
@pytest.mark.parametrize(
    ("bags", "y", "message"),
    [
        ([], [], "there are no bags"),
        ([[[0.0]], []], [0, 1], "bag 1 is empty"),
        ([[[0.0]], [[0.0, 1.0]]], [0, 1], "bag 1 has points of 2 components, but bag 0 of 1"),
        ([[[0.0]], [[np.nan]]], [0, 1], "Input X contains NaN or infinity"),
        ([[[0.0]], [[np.inf]]], [0, 1], "Input X contains NaN or infinity"),
        ([[[0.0]], [[1e31]]], [0, 1], "values beyond 1e.30"),
        ([[[0.0]]], [1], "labels of 2 classes are needed, but 1 bags have only 1 class"),
        (np.zeros((2, 1)), [1, 1], "labels of 2 classes are needed"),
        (np.zeros((3, 1)), [0, 1, 2], "3 bags have 3 classes"),
    ],
)
def test_bad_bags_are_refused(name: str, bags: Any, y: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        MACHINES[name].fit(bags, y)


@each_machine
def test_prediction_needs_a_fitted_machine_and_points_of_its_space(name: str) -> None:
    model = type(MACHINES[name])()
    with pytest.raises(NotFittedError, match="not fitted yet"):
        model.predict(np.zeros((2, 1)))
    model.fit(np.array([[0.0], [1.0]]), [0, 1])
    with pytest.raises(InputError, match="X has 2 features"):
        model.predict(np.zeros((2, 2)))


@each_machine
def test_two_bags_of_one_instance_are_enough(name: str) -> None:
    assert MACHINES[name].fit([[[0.0]], [[1.0]]], [0, 1]).predict([[[0.1]], [[0.9]]]).tolist() == [0, 1]


@each_machine
def test_where_all_instances_coincide_gamma_is_one(name: str) -> None:
    model = MACHINES[name].fit(np.full((6, 2, 3), 5.0), [0, 1] * 3)

    assert model.gamma_ == 1.0
    assert np.isfinite(model.decision_function(np.full((2, 1, 3), 5.0))).all()


@each_machine
def test_constant_features_change_nothing(name: str) -> None:
    rng = np.random.default_rng(0)
    bags, y = rng.normal(size=(20, 3, 2)), np.arange(20) % 2
    bags[1::2, 0] = [5.0, 5.0]
    wider = np.concatenate([bags, np.full((20, 3, 2), 8.0)], axis=2)
    model = MACHINES[name].fit(bags, y)
    expected, gamma = model.decision_function(bags), model.gamma_

    model.fit(wider, y)
    assert model.gamma_ == pytest.approx(gamma)
    np.testing.assert_allclose(model.decision_function(wider), expected, atol=1e-2)


@each_machine
def test_ten_thousand_features(name: str) -> None:
    rng = np.random.default_rng(0)
    bags, y = rng.normal(size=(20, 2, 10_000)), np.arange(20) % 2
    bags[1::2, 0] += 1.0

    assert MACHINES[name].fit(bags, y).predict(bags).tolist() == y.tolist()


@each_machine
@pytest.mark.parametrize("scale", [2.0**-100, 2.0**90])
def test_units_do_not_matter(name: str, scale: float) -> None:
    rng = np.random.default_rng(1)
    bags, y = rng.normal(size=(20, 3, 2)), np.arange(20) % 2
    bags[1::2, 0] = [6.0, 6.0]

    expected = MACHINES[name].fit(bags, y).decision_function(bags)

    scores = MACHINES[name].fit(bags * scale, y).decision_function(bags * scale)
    np.testing.assert_allclose(scores, expected, atol=1e-2)


@each_machine
@pytest.mark.parametrize("gamma", [1e-300, 1e300])
def test_kernels_without_shape_still_give_numbers(name: str, gamma: float) -> None:
    bags, y = np.random.default_rng(0).normal(size=(12, 2, 2)), np.arange(12) % 2
    model = type(MACHINES[name])(gamma=gamma, **({"random_state": 0} if name == "MILES" else {}))

    assert np.isfinite(model.fit(bags, y).decision_function(bags)).all()
