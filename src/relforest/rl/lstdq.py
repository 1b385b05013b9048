"""Least-squares temporal-difference learning of action values, block by block (Palmer (2015), Algorithm 2.1).

The feature vector of (s, a) is zero outside the block of a's action type (section 6.4). So a row block of the
matrix A = Phi^T (Phi - discount * Phi') only gathers the transitions of its own type, and Phi' falls apart by
the type of the greedy next action; the dense feature matrix over all types is never built.

Letters: n transitions, m_a pairs and k_a features of action type a, k features in use over all types.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, final

import numpy as np

from relforest.rl.bellman import Lookahead, look_ahead_at
from relforest.rl.samples import Transitions
from relforest.scenes.arrays import FloatArray, IntArray


class Block(NamedTuple):
    """Features of one action type that were added together."""

    number: int  # of the action type
    used: IntArray  # those with data
    place: slice  # of these among all
    table: FloatArray  # (m_a, width) of every pair
    taken: FloatArray  # (n_a, k) of the observed pairs, if used


@final
@dataclass(frozen=True, slots=True, eq=False)
class LSTDQ:
    """The regression problem of a policy, from which those of other policies and more features are derived.

    Use `of`.

    References
    ----------
    Palmer (2015), Algorithm 2.1, section 6.4 and section 7.2; Lagoudakis and Parr (2003).
    """

    transitions: Transitions
    owners: tuple[IntArray, ...]  # the transitions of each action type
    max_condition: float  # largest condition number (from singular values) that A may have, above 1
    chosen: IntArray
    """(n,): for each transition the policy's action in s' as a position among all candidates, -1 where
    nothing follows."""
    blocks: tuple[Block, ...]
    """The features. Those that are 0 in every observed pair are cut out and get the weight 0 (section
    7.2)."""
    matrix: FloatArray  # (k, k) A
    rewards: FloatArray  # (k,) b

    @classmethod
    def of(cls, features: Sequence[FloatArray], transitions: Transitions, max_condition: float) -> LSTDQ:
        """Return the problem of these features (m_a, k_a) of each action type, if nothing ever followed."""
        owners = tuple(np.flatnonzero(transitions.types == number) for number in range(len(features)))
        nothing = np.full(len(transitions), -1)
        problem = cls(transitions, owners, max_condition, nothing, (), np.zeros((0, 0)), np.zeros(0))
        for number, table in enumerate(features):
            problem = problem.extended(number, table)
        return problem

    @property
    def n_features(self) -> int:
        """Number k of features in use."""
        return len(self.rewards)

    def extended(self, number: int, columns: FloatArray) -> LSTDQ:
        """Return the problem of the same policy with more features (m_a, k) of one action type.

        A only gets more rows and columns.
        """
        own, before = self.owners[number], self.n_features
        taken = columns[self.transitions.rows[own]]
        used = np.flatnonzero(taken.any(axis=0))
        place = slice(before, before + len(used))
        added = Block(number, used, place, columns, taken.take(used, axis=1))
        blocks, every = (*self.blocks, added), np.arange(len(self.transitions))
        matrix = np.pad(self.matrix, (0, len(used)))
        for block in blocks:
            for row, column in ((added, block), (block, added)):
                gram = row.taken.T @ column.taken if row.number == column.number else 0.0
                matrix[row.place, column.place] = gram - self._following(row, column, self.chosen, every)
        rewards = np.concatenate([self.rewards, added.taken.T @ self.transitions.rewards[own]])
        return replace(self, blocks=blocks, matrix=matrix, rewards=rewards)

    def with_policy(self, chosen: IntArray) -> LSTDQ:
        """Return the problem of another policy (n,).

        Only transitions after which it does something else change A.
        """
        changed = np.flatnonzero(chosen != self.chosen)
        matrix = self.matrix.copy()
        for row in self.blocks:
            for column in self.blocks:
                matrix[row.place, column.place] += self._following(row, column, self.chosen, changed)
                matrix[row.place, column.place] -= self._following(row, column, chosen, changed)
        return replace(self, chosen=chosen, matrix=matrix)

    def weights(self) -> tuple[FloatArray, ...]:
        """Return the weights that evaluate the policy: for each action type those of all its features."""
        solution: FloatArray = np.empty(0)
        if self.n_features:
            matrix = well_conditioned(self.matrix, self.max_condition)
            solution = np.asarray(np.linalg.solve(matrix, self.rewards), dtype=np.float64)
        weights: list[list[FloatArray]] = [[] for _ in self.owners]
        for block in self.blocks:
            full = np.zeros(block.table.shape[1])
            full[block.used] = solution[block.place]
            weights[block.number].append(full)
        return tuple(np.concatenate(parts) for parts in weights)

    def look_ahead(self, weights: Sequence[FloatArray]) -> Lookahead:
        """Return what weights of all features say, see `relforest.rl.bellman.look_ahead`."""
        values: list[FloatArray] = [np.zeros(0)] * len(self.owners)
        ends = [0] * len(self.owners)
        for number, _, _, table, _ in self.blocks:
            first, ends[number] = ends[number], ends[number] + table.shape[1]
            part = table @ weights[number][first : ends[number]]
            values[number] = values[number] + part if first else part
        return look_ahead_at(values, self.transitions)

    def _following(self, row: Block, column: Block, chosen: IntArray, some: IntArray) -> FloatArray:
        """Return the part of discount * Phi^T Phi' that is due to some transitions, (k_row, k_column)."""
        transitions = self.transitions
        some = some[(transitions.types[some] == row.number) & (chosen[some] >= 0)]
        some = some[transitions.next_types[chosen[some]] == column.number]
        following = column.table[transitions.next_rows[chosen[some]]].take(column.used, axis=1)
        following *= transitions.discounts[some, None]
        here = np.searchsorted(self.owners[row.number], some)
        found: FloatArray = row.taken[here].T @ following
        return found


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
