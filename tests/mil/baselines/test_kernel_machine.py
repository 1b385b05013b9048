"""Machines with a radial kernel: they are scikit-learn's, whether kernel values are stored or not."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from sklearn.svm import SVC

from relforest.mil.baselines import kernel_machine
from relforest.mil.baselines.kernel_machine import KernelMachine, KernelProblem, radial_kernel

Floats = NDArray[np.float64]
SETTINGS: Any = {"C": 10.0, "tol": 1e-6, "max_iter": 1_000_000}


def clouds(seed: int = 0, n: int = 60) -> tuple[Floats, NDArray[np.bool_]]:
    rng = np.random.default_rng(seed)
    labels = np.arange(n) % 2 == 0
    return rng.normal(size=(n, 2)) + labels[:, np.newaxis], labels


@pytest.fixture(params=["stored", "not stored"])
def storage(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if request.param == "not stored":
        monkeypatch.setattr(kernel_machine, "MOST_STORED_POINTS", 1)


def test_kernel_values_by_hand() -> None:
    # Squared distances from (0, 0) and (3, 4) to (0, 0) and (0, 4).
    a, b = np.array([[0.0, 0.0], [3.0, 4.0]]), np.array([[0.0, 0.0], [0.0, 4.0]])

    expected = [[1, math.exp(-1.6)], [math.exp(-2.5), math.exp(-0.9)]]
    np.testing.assert_allclose(radial_kernel(a, b, 0.1), expected)
    assert radial_kernel(a * 1e25, b, 1e300)[1].tolist() == [0, 0]


def test_a_machine_adds_up_its_support_vectors(monkeypatch: pytest.MonkeyPatch) -> None:
    vectors = np.array([[0.0], [2.0]])
    machine = KernelMachine(vectors, np.array([1.0, -2.0]), np.arange(2), 0.5, 1.0, converged=True)
    expected = [0.5 + math.exp(-(x**2)) - 2 * math.exp(-((x - 2) ** 2)) for x in (0.0, 1.0, 5.0)]

    np.testing.assert_allclose(machine.scores(np.array([[0.0], [1.0], [5.0]])), expected)
    monkeypatch.setattr(kernel_machine, "_BLOCK", 1)
    np.testing.assert_allclose(machine.scores(np.array([[0.0], [1.0], [5.0]])), expected)


@pytest.mark.usefixtures("storage")
@pytest.mark.parametrize("offset", [0.0, 1e6])
def test_a_trained_machine_is_that_of_scikit_learn(offset: float) -> None:
    points, labels = clouds()
    problem = KernelProblem(points + offset, 0.7, **SETTINGS)
    machine = problem.solve(labels, np.ones(len(labels)))
    expected = SVC(C=10.0, gamma=0.7, tol=1e-6).fit(points, labels).decision_function(points)

    assert machine.converged
    np.testing.assert_allclose(machine.scores(points + offset), expected, atol=1e-4)
    np.testing.assert_allclose(problem.scores(machine), expected, atol=1e-4)
    np.testing.assert_array_equal(machine.vectors, (points + offset)[machine.rows])


@pytest.mark.usefixtures("storage")
def test_the_last_points_can_be_replaced() -> None:
    points, labels = clouds()
    others, _ = clouds(seed=1, n=20)
    problem = KernelProblem(points, 0.7, **SETTINGS)
    problem.replace_last(others)
    expected = KernelProblem(np.concatenate([points[:-20], others]), 0.7, **SETTINGS).solve(
        labels, np.ones(len(labels))
    )

    np.testing.assert_allclose(
        problem.solve(labels, np.ones(len(labels))).scores(points), expected.scores(points), atol=1e-4
    )


@pytest.mark.usefixtures("storage")
def test_too_few_steps_are_said_not_warned_of() -> None:
    points, labels = clouds()

    assert (
        not KernelProblem(points, 0.7, **SETTINGS | {"max_iter": 2})
        .solve(labels, np.ones(len(labels)))
        .converged
    )


@pytest.mark.usefixtures("storage")
def test_weights_are_factors_of_the_price_of_slack() -> None:
    points, labels = clouds()
    weights = np.resize([1.0, 2.0, 3.0], len(labels))
    machine = KernelProblem(points, 0.7, **SETTINGS).solve(labels, weights)
    peer = SVC(C=10.0, gamma=0.7, tol=1e-6).fit(points, labels, sample_weight=weights)

    np.testing.assert_allclose(machine.scores(points), peer.decision_function(points), atol=1e-4)
