from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.volumes.conditioning import condition, extreme_eigenvalues, ridge, whiten

Floats = NDArray[np.float64]
DIMS = [1, 2, 3, 4, 5]


def symmetric(rng: np.random.Generator, eigenvalues: Floats) -> Floats:
    """A randomly turned matrix with these eigenvalues."""
    turn = np.linalg.qr(rng.standard_normal((len(eigenvalues), len(eigenvalues))))[0]
    matrix: Floats = turn @ np.diag(eigenvalues) @ turn.T
    return np.asarray((matrix + matrix.T) / 2)


def spectra(rng: np.random.Generator, dim: int) -> Iterator[Floats]:
    """Eigenvalues of many forms: spread over decades, equal, pairwise equal, partly zero, tiny, huge."""
    for _ in range(15):
        yield 10.0 ** rng.uniform(-4, 4, size=dim)
    yield np.ones(dim)
    yield np.append(np.ones(dim - 1), 5.0)
    yield np.append(5 * np.ones(dim - 1), 1.0)
    yield np.append(np.zeros(dim - 1), 1.0)
    yield np.append(np.ones(dim - 1), 0.0)
    yield 1e-60 * rng.uniform(1, 2, size=dim)
    yield 1e-90 * np.append(np.zeros(dim - 1), 1.5)
    yield 1e60 * rng.uniform(1, 2, size=dim)


@pytest.mark.parametrize("dim", DIMS)
def test_extreme_eigenvalues_agree_with_lapack(dim: int) -> None:
    rng = np.random.default_rng(dim)
    # The closed form in three dimensions knows a double eigenvalue to half the digits only.
    slack = 5e-8 if dim == 3 else 1e-13
    for eigenvalues in spectra(rng, dim):
        matrix = symmetric(rng, eigenvalues)
        expected = np.linalg.eigvalsh(matrix)
        largest, smallest = extreme_eigenvalues(matrix)
        assert largest == pytest.approx(expected[-1], rel=slack)
        assert smallest == pytest.approx(expected[0], rel=1e-10, abs=slack * expected[-1])


@pytest.mark.parametrize("dim", DIMS)
def test_diagonal_matrices_have_exact_eigenvalues(dim: int) -> None:
    diagonal = np.array([3.0, 2.0, 5.0, 1.0, 4.0])[:dim]

    largest, smallest = extreme_eigenvalues(np.diag(diagonal))

    assert largest == pytest.approx(diagonal.max(), rel=1e-15)
    assert smallest == pytest.approx(diagonal.min(), rel=1e-14)


@pytest.mark.parametrize("dim", DIMS)
def test_a_matrix_of_zeros_has_no_positive_eigenvalue(dim: int) -> None:
    assert extreme_eigenvalues(np.zeros((dim, dim))) == (0, 0)


def test_a_negative_definite_plane_is_no_covariance() -> None:
    largest, smallest = extreme_eigenvalues(np.diag([-1.0, -2.0]))

    assert (largest, smallest) == (-1, -2)
    assert ridge(largest, smallest, 10.0) == -1


@pytest.mark.parametrize(
    ("largest", "smallest", "max_condition", "expected"),
    [
        (4.0, 1.0, 5.0, 0.0),
        # Exactly at the limit.
        (4.0, 1.0, 4.0, 0.0),
        # (4 - 3 * 1) / 2: (4 + .5) / (1 + .5) = 3.
        (4.0, 1.0, 3.0, 0.5),
        (1.0, 0.0, 3.0, 0.5),
        # Rounding below zero counts as above the limit: (1 + 3 * .01) / 2.
        (1.0, -0.01, 3.0, 0.515),
        # A matrix that vanishes is replaced.
        (0.0, 0.0, 3.0, -1.0),
        (-1.0, -2.0, 3.0, -1.0),
        (1e-100, 1e-101, 3.0, -1.0),
        (float("nan"), 0.0, 3.0, -1.0),
    ],
)
def test_ridge_by_hand(largest: float, smallest: float, max_condition: float, expected: float) -> None:
    assert ridge(largest, smallest, max_condition) == pytest.approx(expected)


def test_conditioning_by_hand() -> None:
    # (1 - 0) / (3 - 1) = .5 on the diagonal.
    covariance = np.array([[1.0, 0.0], [0.0, 0.0]])
    condition(covariance, 3.0)

    np.testing.assert_allclose(covariance, [[1.5, 0], [0, 0.5]])


@pytest.mark.parametrize("dim", DIMS)
def test_conditioning_leaves_a_good_matrix_alone(dim: int) -> None:
    covariance = symmetric(np.random.default_rng(dim), np.linspace(1, 2, dim))
    before = covariance.copy()
    condition(covariance, 10.0)

    np.testing.assert_array_equal(covariance, before)


@pytest.mark.parametrize("dim", DIMS[1:])
def test_conditioning_reaches_the_limit_and_keeps_the_axes(dim: int) -> None:
    rng = np.random.default_rng(dim)
    for _ in range(10):
        eigenvalues = np.append(10.0 ** rng.uniform(-9, -4, size=dim - 1), 1.0)
        covariance = symmetric(rng, eigenvalues)
        before = covariance.copy()
        condition(covariance, 100.0)
        added = covariance - before
        assert np.linalg.cond(covariance) == pytest.approx(100, rel=1e-4)
        np.testing.assert_allclose(added, added[0, 0] * np.eye(dim), atol=1e-15)


@pytest.mark.parametrize("size", [0.0, 1e-100, 1e-200, 1e-320])
@pytest.mark.parametrize("dim", DIMS)
def test_a_vanishing_matrix_becomes_the_identity(dim: int, size: float) -> None:
    covariance = np.diag(np.full(dim, size))
    condition(covariance, 1e5)

    np.testing.assert_array_equal(covariance, np.eye(dim))


def inverse(covariance: Floats) -> Floats:
    metric = np.empty_like(covariance)
    whiten(covariance, metric)
    result: Floats = metric if len(covariance) <= 3 else metric.T @ metric
    return result


@pytest.mark.parametrize("dim", DIMS)
def test_whitening_inverts(dim: int) -> None:
    rng = np.random.default_rng(dim)
    for _ in range(20):
        covariance = symmetric(rng, 10.0 ** rng.uniform(-2, 2, size=dim))
        np.testing.assert_allclose(inverse(covariance) @ covariance, np.eye(dim), atol=1e-9)


@pytest.mark.parametrize("dim", DIMS)
def test_whitening_may_work_in_place(dim: int) -> None:
    covariance = symmetric(np.random.default_rng(dim), np.arange(1.0, dim + 1))
    expected = np.empty_like(covariance)
    whiten(covariance, expected)
    whiten(covariance, covariance)

    np.testing.assert_array_equal(covariance, expected)


@pytest.mark.parametrize("rank", [1, 2])
@pytest.mark.parametrize("dim", [3, 4])
def test_whitening_keeps_its_digits_for_flat_clouds(dim: int, rank: int) -> None:
    # What conditioning makes of points on a line or in a plane. Cofactors would lose six digits here.
    rng = np.random.default_rng(rank)
    for _ in range(20):
        covariance = symmetric(rng, np.append(np.full(dim - rank, 1e-7), rng.uniform(0.5, 1, size=rank)))
        expected = np.linalg.inv(covariance)
        np.testing.assert_allclose(inverse(covariance), expected, atol=1e-8 * np.abs(expected).max())
