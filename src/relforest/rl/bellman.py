"""Bellman errors of a linear action-value function, and the binary labels that trees learn from.

Letters: n transitions, m_a state-action pairs and k_a features of action type a.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from relforest.rl.experience import BoolArray
from relforest.rl.kernels import segment_argmax
from relforest.rl.samples import Transitions
from relforest.scenes.arrays import FloatArray, IntArray


@final
@dataclass(frozen=True, slots=True, eq=False)
class Lookahead:
    """The predictions of an action-value function for a set of transitions."""

    values: FloatArray  # (n,) Q(s, a) of the observed pairs
    chosen: IntArray
    """(n,): the greedy action in s': its position among all candidates of the transitions, -1 where nothing
    follows. Of equal values, the first wins."""
    errors: FloatArray  # (n,) the Bellman errors ``r + discount * max Q(s', a') - Q(s, a)``

    @property
    def squared_error(self) -> float:
        """Sum of the squared Bellman errors."""
        return float(self.errors @ self.errors)


def look_ahead(
    features: Sequence[FloatArray], weights: Sequence[FloatArray], transitions: Transitions
) -> Lookahead:
    """Evaluate a linear action-value function and its greedy policy on transitions.

    For each action type there are the features of its state-action pairs, (m_a, k_a), and weights, (k_a,).

    References
    ----------
    Palmer (2015), eq. 2.3 and section 6.3, in the form for options (section 2.1).
    """
    return look_ahead_at([phi @ w for phi, w in zip(features, weights, strict=True)], transitions)


def look_ahead_at(table: Sequence[FloatArray], transitions: Transitions) -> Lookahead:
    """Evaluate the values (m_a,) of all state-action pairs of each action type; see `look_ahead`."""
    following = _lookup(table, transitions.next_types, transitions.next_rows)
    chosen = np.empty(len(transitions), dtype=np.int64)
    segment_argmax(following, transitions.next_starts, chosen)
    values = _lookup(table, transitions.types, transitions.rows)
    best = np.zeros(len(transitions))
    follows = chosen >= 0
    best[follows] = following[chosen[follows]]
    return Lookahead(values, chosen, transitions.rewards + transitions.discounts * best - values)


def error_labels(errors: FloatArray, types: IntArray) -> BoolArray:
    """Label each transition True if its error exceeds the mean error of its action type.

    Errors and action types are (n,).

    For a type whose errors are equal, all are False.

    References
    ----------
    Palmer (2015), section 6.3.
    """
    labels = np.zeros(len(errors), dtype=np.bool_)
    for number in np.unique(types):
        own = types == number
        # Rounding may put the mean of equal errors just below them.
        labels[own] = (errors[own] > errors[own].mean()) & (errors[own] > errors[own].min())
    return labels


def _lookup(table: Sequence[FloatArray], types: IntArray, rows: IntArray) -> FloatArray:
    """Pick ``table[types[i]][rows[i]]`` for every i."""
    starts = np.cumsum([0, *(len(column) for column in table)])[:-1]
    joined: FloatArray = np.concatenate([np.empty(0), *table])[starts[types] + rows]
    return joined
