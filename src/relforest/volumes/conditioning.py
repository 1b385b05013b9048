"""Covariance of the key points, conditioned and inverted (eq. 3.5 and 3.6)."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.support.jit import kernel

# Points closer than about the square root of this count as one point: determinants of smaller matrices
# would vanish.
_NEGLIGIBLE: Final = 1e-90


@kernel
def ridge(largest: float, smallest: float, max_condition: float) -> float:
    """What eq. 3.6 adds to the diagonal; -1 if the matrix vanishes and the identity must replace it."""
    if not largest > _NEGLIGIBLE:
        return -1.0
    if smallest > 0.0 and largest <= max_condition * smallest:
        return 0.0
    return (largest - max_condition * smallest) / (max_condition - 1.0)


@kernel
def extreme_eigenvalues(matrix: NDArray[np.float64]) -> tuple[float, float]:
    """Largest and smallest eigenvalue of a symmetric matrix (d, d), in closed form up to d = 3."""
    dim = matrix.shape[0]
    if dim == 1:
        return matrix[0, 0], matrix[0, 0]
    if dim == 2:
        centre = 0.5 * (matrix[0, 0] + matrix[1, 1])
        half, mixed = 0.5 * (matrix[0, 0] - matrix[1, 1]), matrix[0, 1]
        spread = math.sqrt(half * half + mixed * mixed)
        largest = centre + spread
        if largest <= 0.0:
            return largest, centre - spread
        # The quotient keeps its digits where centre - spread would cancel.
        determinant = matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[0, 1]
        return largest, determinant / largest
    if dim == 3:
        return _extreme_eigenvalues_3(matrix)
    # LAPACK allocates its own workspace; from four dimensions on that no longer shows.
    eigenvalues = np.linalg.eigvalsh(matrix)
    return eigenvalues[dim - 1], eigenvalues[0]


@kernel
def _extreme_eigenvalues_3(matrix: NDArray[np.float64]) -> tuple[float, float]:
    """Trigonometric solution of the characteristic polynomial of a symmetric 3 x 3 matrix."""
    centre = (matrix[0, 0] + matrix[1, 1] + matrix[2, 2]) / 3.0
    a, b, c = matrix[0, 0] - centre, matrix[1, 1] - centre, matrix[2, 2] - centre
    d, e, f = matrix[0, 1], matrix[0, 2], matrix[1, 2]
    spread = math.sqrt((a * a + b * b + c * c + 2.0 * (d * d + e * e + f * f)) / 6.0)
    # All equal, or so small that its cube would vanish, far below what counts as a covariance.
    if spread < 1e-10 * _NEGLIGIBLE:
        return centre, centre
    determinant = a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e)
    angle = math.acos(min(1.0, max(-1.0, determinant / (2.0 * spread**3)))) / 3.0
    largest = centre + 2.0 * spread * math.cos(angle)
    smallest = centre + 2.0 * spread * math.cos(angle + 2.0 * math.pi / 3.0)
    return largest, smallest


@kernel
def condition(covariance: NDArray[np.float64], max_condition: float) -> None:
    """Apply eq. 3.6 to a posterior covariance (d, d) in place."""
    dim = covariance.shape[0]
    largest, smallest = extreme_eigenvalues(covariance)
    added = ridge(largest, smallest, max_condition)
    if added < 0.0:
        covariance[:, :] = 0.0
        added = 1.0
    for i in range(dim):
        covariance[i, i] += added


@kernel
def whiten(covariance: NDArray[np.float64], whitening: NDArray[np.float64]) -> None:
    """Write the metric of `covariance` (d, d), positive definite, into `whitening`, which may be the same.

    Up to three dimensions the metric is the inverse; beyond, it is the lower triangular W with
    ``W.T @ W`` = inverse, which needs half the multiplications per point.
    """
    dim = covariance.shape[0]
    if dim == 1:
        whitening[0, 0] = 1.0 / covariance[0, 0]
    elif dim == 2:
        a, b, c = covariance[0, 0], covariance[0, 1], covariance[1, 1]
        scale = 1.0 / (a * c - b * b)
        whitening[0, 0] = c * scale
        whitening[0, 1] = whitening[1, 0] = -b * scale
        whitening[1, 1] = a * scale
    elif dim == 3:
        _invert_3(covariance, whitening)
    else:
        whitening[:, :] = np.linalg.inv(np.linalg.cholesky(covariance))


@kernel
def _invert_3(matrix: NDArray[np.float64], inverse: NDArray[np.float64]) -> None:
    """Invert a positive definite 3 x 3 matrix by its factors L D L', which keep more digits than minors."""
    d, e, f = matrix[0, 1], matrix[0, 2], matrix[1, 2]
    first = matrix[0, 0]
    low_10, low_20 = d / first, e / first
    second = matrix[1, 1] - low_10 * d
    rest = f - low_20 * d
    low_21 = rest / second
    third = matrix[2, 2] - low_20 * e - low_21 * rest
    up_20 = low_10 * low_21 - low_20
    inverse[0, 0] = 1.0 / first + low_10 * low_10 / second + up_20 * up_20 / third
    inverse[1, 1] = 1.0 / second + low_21 * low_21 / third
    inverse[2, 2] = 1.0 / third
    inverse[0, 1] = inverse[1, 0] = -low_10 / second - up_20 * low_21 / third
    inverse[0, 2] = inverse[2, 0] = up_20 / third
    inverse[1, 2] = inverse[2, 1] = -low_21 / third
