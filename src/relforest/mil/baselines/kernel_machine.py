"""Support vector machines with a radial kernel, trained repeatedly by LIBSVM on the same points.

Dimensions: n training points, m support vectors, d features, p points to score.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, final

import numpy as np
from sklearn.svm import _libsvm

from relforest.mil.squared_distances import squared_distances

if TYPE_CHECKING:
    from numpy.typing import NDArray

# 32 MB of kernel values. For more points, LIBSVM is faster, since it computes only the rows it needs.
MOST_STORED_POINTS: Final = 2000
# LIBSVM's code for classification with a price of slack.
_C_SVC: Final = 0
# Size of LIBSVM's cache of kernel rows, in MB.
_CACHE_SIZE: Final = 200
# Kernel values in a block of points to score, 32 MB.
_BLOCK: Final = 4_000_000


@final
@dataclass(frozen=True, slots=True, eq=False)
class KernelMachine:
    """A trained machine: f(x) = sum_i coefficient_i exp(-gamma |x - vector_i|^2) + intercept.

    Attributes
    ----------
    vectors : (m, d) float64
        Support vectors.
    coefficients : (m,) float64
        Weights of the support vectors, at least 0 for positive ones.
    rows : (m,) int64
        Indices of the support vectors among the training points.
    intercept : float
        Constant term.
    gamma : float
        Coefficient of squared distances.
    converged : bool
        Whether the solver reached its tolerance.
    """

    vectors: NDArray[np.float64]
    coefficients: NDArray[np.float64]
    rows: NDArray[np.int64]
    intercept: float
    gamma: float
    converged: bool

    def scores(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values (p,) of f for points (p, d); positive on the side of the positive class."""
        # Squared distances lose fewer digits near the origin.
        centre = self.vectors.mean(axis=0)
        vectors = self.vectors - centre
        found = np.empty(len(points))
        step = max(1, _BLOCK // len(vectors))
        for first in range(0, len(points), step):
            block = slice(first, first + step)
            found[block] = radial_kernel(points[block] - centre, vectors, self.gamma) @ self.coefficients
        found += self.intercept
        return found


@final
class KernelProblem:
    """Points on which machines are trained for a sequence of labellings.

    For up to `MOST_STORED_POINTS` points, kernel values are computed only once. Every training starts from
    scratch, since scikit-learn's interface to LIBSVM does not accept an earlier solution.

    Parameters
    ----------
    points : (n, d) float64
        Copied.
    gamma : float
        Coefficient of squared distances.
    C : float
        Price of slack per training point.
    tol : float
        Largest violation of the optimality conditions.
    max_iter : int
        Largest number of LIBSVM's steps in a training.
    """

    def __init__(
        self, points: NDArray[np.float64], gamma: float, *, C: float, tol: float, max_iter: int
    ) -> None:
        self._points = points.copy()
        # Squared distances lose fewer digits near the origin.
        self._centre = points.mean(axis=0)
        self._centred = points - self._centre
        self._gamma = gamma
        self._settings = {"C": C, "tol": tol, "max_iter": max_iter, "cache_size": _CACHE_SIZE}
        self._kernel: NDArray[np.float64] | None = None
        if len(points) <= MOST_STORED_POINTS:
            self._kernel = radial_kernel(self._centred, self._centred, gamma)

    def replace_last(self, points: NDArray[np.float64]) -> None:
        """Replace the last k points by others (k, d)."""
        first = len(self._points) - len(points)
        self._points[first:] = points
        self._centred[first:] = points - self._centre
        if self._kernel is not None:
            columns = radial_kernel(self._centred, self._centred[first:], self._gamma)
            self._kernel[:, first:] = columns
            self._kernel[first:] = columns.T

    def solve(self, positive: NDArray[np.bool_], weights: NDArray[np.float64]) -> KernelMachine:
        """Train a machine; both values occur in `positive` (n,), and `weights` (n,) are factors of C."""
        stored = self._kernel is not None
        # `sklearn.svm.SVC` would change warning filters and NumPy's global random state for all threads.
        _libsvm.set_verbosity_wrap(0)
        rows, _, _, coefficients, threshold, *_, status, _ = _libsvm.fit(
            self._kernel if stored else self._centred,
            positive.astype(np.float64),
            sample_weight=weights,
            svm_type=_C_SVC,
            kernel="precomputed" if stored else "rbf",
            gamma=self._gamma,
            **self._settings,
        )
        support = np.asarray(rows, dtype=np.int64)
        # LIBSVM's scores are positive for the first class, which is the negative one here.
        return KernelMachine(
            self._points[support],
            -np.asarray(coefficients)[0],
            support,
            -float(threshold[0]),
            self._gamma,
            status == 0,
        )

    def scores(self, machine: KernelMachine) -> NDArray[np.float64]:
        """Scores of all training points by a machine, (n,)."""
        if self._kernel is None:
            return machine.scores(self._points)
        found: NDArray[np.float64] = self._kernel[:, machine.rows] @ machine.coefficients + machine.intercept
        return found


def radial_kernel(a: NDArray[np.float64], b: NDArray[np.float64], gamma: float) -> NDArray[np.float64]:
    """Return exp(-gamma |x - y|^2), (n, k), for all x in `a` (n, d) and y in `b` (k, d)."""
    values = squared_distances(a, b)
    # If the product overflows, the kernel value is still right: 0.
    with np.errstate(over="ignore"):
        values *= -gamma
    return np.exp(values, out=values)
