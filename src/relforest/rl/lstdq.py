"""Least-squares temporal-difference learning of action values, block by block (Palmer (2015), Algorithm 2.1).

The feature vector of (s, a) is zero outside the block of a's action type (section 6.4). So a row block of the
matrix A = Phi^T (Phi - discount * Phi') only gathers the transitions of its own type, and Phi' falls apart by
the type of the greedy next action; the dense feature matrix over all types is never built.

Letters: n transitions, m_a pairs and k_a features of action type a, k features in use over all types.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

import numpy as np

from relforest.rl.samples import Transitions
from relforest.scenes.arrays import FloatArray, IntArray


@final
class LSTDQ:
    """The regression problem of one set of features and transitions, for any number of policies.

    Parameters
    ----------
    features : sequence of (m_a, k_a) float64
        For each action type the features of its state-action pairs.
    transitions : Transitions
    max_condition : float
        Largest condition number (from singular values) that A may have, above 1.

    Notes
    -----
    Features that are 0 in every observed pair are cut out and get the weight 0 (section 7.2).
    What does not depend on the policy, Phi^T Phi and Phi^T r, is computed once.

    References
    ----------
    Palmer (2015), Algorithm 2.1, section 6.4 and section 7.2; Lagoudakis and Parr (2003).
    """

    def __init__(
        self, features: Sequence[FloatArray], transitions: Transitions, *, max_condition: float
    ) -> None:
        self._transitions = transitions
        self._max_condition = max_condition
        self._widths = [phi.shape[1] for phi in features]
        self._owners = [np.flatnonzero(transitions.types == number) for number in range(len(features))]
        taken = [phi[transitions.rows[own]] for phi, own in zip(features, self._owners, strict=True)]
        self._used = [np.flatnonzero(phi.any(axis=0)) for phi in taken]
        self._features = [phi.take(used, axis=1) for phi, used in zip(features, self._used, strict=True)]
        self._taken = [phi.take(used, axis=1) for phi, used in zip(taken, self._used, strict=True)]
        ends = np.cumsum([len(used) for used in self._used])
        self._blocks = [slice(end - len(used), end) for end, used in zip(ends, self._used, strict=True)]
        self._gram = np.zeros((self.n_features, self.n_features))
        self._rewards = np.zeros(self.n_features)
        for block, phi, own in zip(self._blocks, self._taken, self._owners, strict=True):
            self._gram[block, block] = phi.T @ phi
            self._rewards[block] = phi.T @ transitions.rewards[own]

    @property
    def n_features(self) -> int:
        """Number k of features in use."""
        return sum(len(used) for used in self._used)

    def matrix(self, chosen: IntArray) -> FloatArray:
        """Return A of the policy that takes the `chosen` next actions; (k, k)."""
        transitions = self._transitions
        follows = np.flatnonzero(chosen >= 0)
        next_types = np.full(len(transitions), -1)
        next_types[follows] = transitions.next_types[chosen[follows]]
        matrix = self._gram.copy()
        for block, phi, own in zip(self._blocks, self._taken, self._owners, strict=True):
            for number, (next_block, table) in enumerate(zip(self._blocks, self._features, strict=True)):
                here = np.flatnonzero(next_types[own] == number)
                moved = own[here]
                following = table[transitions.next_rows[chosen[moved]]]
                following *= transitions.discounts[moved, None]
                matrix[block, next_block] -= phi[here].T @ following
        return matrix

    def solve(self, chosen: IntArray) -> tuple[FloatArray, ...]:
        """Return the weights that evaluate a policy.

        Parameters
        ----------
        chosen : (n,) int64
            For each transition the policy's action in s' as a position among all candidates, -1 where nothing
            follows.

        Returns
        -------
        tuple of (k_a,) float64
            For each action type the weights of all its features; 0 for features without data.
        """
        solution: FloatArray = np.empty(0)
        if self.n_features:
            matrix = well_conditioned(self.matrix(chosen), self._max_condition)
            solution = np.asarray(np.linalg.solve(matrix, self._rewards), dtype=np.float64)
        weights = tuple(np.zeros(width) for width in self._widths)
        for full, used, block in zip(weights, self._used, self._blocks, strict=True):
            full[used] = solution[block]
        return weights


def well_conditioned(matrix: FloatArray, limit: float) -> FloatArray:
    """Return `matrix` (k, k), or the matrix plus c * I such that its condition number is at most `limit`.

    c begins with (s_max - limit * s_min) / (limit - 1), the formula of eq. 3.6. The matrix of LSTDQ is not
    symmetric, so this does not bound the ratio of singular values exactly; c is doubled until it holds.

    References
    ----------
    Palmer (2015), section 7.2 (condition number of at most 1e5, by singular values).
    """
    singular = np.linalg.svd(matrix, compute_uv=False)
    largest, smallest = float(singular[0]), float(singular[-1])
    if smallest > 0.0 and largest <= limit * smallest:
        return matrix
    shift = (largest - limit * smallest) / (limit - 1.0) if largest > 0.0 else 1.0
    identity = np.eye(len(matrix))
    while True:
        shifted = matrix + shift * identity
        singular = np.linalg.svd(shifted, compute_uv=False)
        if singular[0] <= limit * singular[-1]:
            return shifted
        shift *= 2.0
