"""Sparse machines: an optimum by hand, the conditions of optimality, and LIBLINEAR as a peer."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from sklearn.exceptions import ConvergenceWarning
from sklearn.svm import LinearSVC

from relforest.mil.sparse_machine import SparseMachine, train_sparse_machine
from relforest.support.progress import Stage, listening

Floats = NDArray[np.float64]


def problem(seed: int, n: int = 30, k: int = 12) -> tuple[Floats, NDArray[np.bool_]]:
    """Features between 0 and 1, some of them exactly 0; the first one matters."""
    rng = np.random.default_rng(seed)
    features = np.exp(-rng.gamma(1.0, 2.0, (n, k)))
    features[features < 0.05] = 0.0
    return features, features[:, 0] + 0.3 * rng.normal(size=n) > np.median(features[:, 0])


def trained(
    features: Floats, positive: NDArray[np.bool_], C: float = 1.0, *, seed: int = 0, passes: int = 1000
) -> SparseMachine:
    return train_sparse_machine(
        features,
        positive,
        np.full(len(positive), C),
        fit_intercept=True,
        tol=1e-8,
        max_passes=passes,
        seed=seed,
    )


def test_an_optimum_by_hand() -> None:
    # One feature, 1 and -1 in equal numbers: |w| + 4 C (1 - w)^2 is least where 8 C (1 - w) = 1.
    features = np.array([[1.0], [1.0], [-1.0], [-1.0]])
    machine = train_sparse_machine(
        features, features[:, 0] > 0, np.full(4, 2.0), fit_intercept=False, tol=1e-10, max_passes=100, seed=0
    )

    assert machine.coefficients == pytest.approx([1 - 1 / 16])
    assert machine.intercept == 0.0
    assert machine.converged


def test_the_conditions_of_optimality_hold() -> None:
    rng = np.random.default_rng(0)
    features = rng.normal(size=(40, 8))
    positive = features[:, 0] + rng.normal(size=40) > 0
    machine = trained(features, positive, 0.1)
    sign = np.where(positive, 1.0, -1.0)
    slack = np.maximum(0.0, 1.0 - sign * (features @ machine.coefficients + machine.intercept))
    slopes = -2.0 * 0.1 * (sign * slack) @ features

    is_zero = machine.coefficients == 0.0
    assert machine.converged
    assert 0 < is_zero.sum() < 8
    np.testing.assert_allclose(slopes[~is_zero], -np.sign(machine.coefficients[~is_zero]), atol=1e-5)
    assert (np.abs(slopes[is_zero]) <= 1.0 + 1e-5).all()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(("C", "passes"), [(1.0, 300), (1e4, 25)])
def test_liblinear_gives_the_same(seed: int, C: float, passes: int) -> None:
    features, positive = problem(seed)
    peer = LinearSVC(penalty="l1", dual=False, C=C, tol=1e-8, max_iter=passes, random_state=seed)
    machine = trained(features, positive, C, seed=seed, passes=passes)
    if machine.converged:
        peer.fit(features, positive)
    else:
        with pytest.warns(ConvergenceWarning):
            peer.fit(features, positive)

    np.testing.assert_allclose(machine.coefficients, peer.coef_[0], rtol=1e-9, atol=1e-12)
    assert machine.intercept == pytest.approx(peer.intercept_[0], rel=1e-9, abs=1e-12)
    assert machine.n_passes == peer.n_iter_


def test_examples_may_have_different_prices() -> None:
    features, positive = np.ones((10, 1)), np.arange(10) < 5
    for prices, sign in ((np.where(positive, 9.0, 1.0), 1.0), (np.where(positive, 1.0, 9.0), -1.0)):
        machine = train_sparse_machine(
            features, positive, prices, fit_intercept=False, tol=1e-6, max_passes=100, seed=0
        )
        assert np.sign(machine.coefficients[0]) == sign


def test_no_features_give_no_weights() -> None:
    machine = train_sparse_machine(
        np.empty((3, 0)), np.array([True, False, True]), np.ones(3),
        fit_intercept=False, tol=1e-4, max_passes=10, seed=0,
    )  # fmt: skip

    assert machine.coefficients.size == 0
    assert machine.converged


def test_passes_are_reported() -> None:
    features, positive = problem(1)
    heard: list[Stage] = []
    with listening(heard.append):
        trained(features, positive, 1e6, passes=120)

    assert [stage.done for stage in heard] == [0, 50, 100]
    assert str(heard[0]) == "training a linear machine: passes: 0 of 120"
