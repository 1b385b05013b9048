"""Leaf probabilities (Algorithm 4.2) and the likelihood they give (eq. 4.1)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, final

import numpy as np

from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

_BELOW_PREVIOUS: Final = 1.0 - 1e-6
_LEAST: Final = 1e-12


@final
@dataclass(frozen=True, slots=True, eq=False)
class Assignment:
    """Probabilities of a tree's leaves.

    Parameters
    ----------
    probability : ndarray (n_leaves,)
    counts : int64 ndarray (n_leaves, 2)
        Negative and positive scenes that each leaf won.
    winner : int64 ndarray (n_scenes,)
        The leaf that decides each scene.
    log_likelihood : float
        Logarithm of eq. 4.1 over all scenes.
    """

    probability: NDArray[np.float64]
    counts: NDArray[np.int64]
    winner: NDArray[np.int64]
    log_likelihood: float


def assign(presence: NDArray[np.bool_], labels: NDArray[np.bool_]) -> Assignment:
    """Assign leaf probabilities.

    Parameters
    ----------
    presence : bool ndarray (n_leaves, n_scenes)
        Whether any instantiation sequence of the scene arrives at the leaf. Every scene is present
        somewhere.
    labels : bool ndarray (n_scenes,)
        True for positive scenes.

    Notes
    -----
    Two points are left open by the source. A leaf assigned later is kept strictly below those assigned
    before, so that the most probable leaf of a scene is the leaf that decided it in training. A leaf
    without scenes gets the base rate, after all others and under the same bound: nothing was learned
    there, so a scene that arrives later should be treated as average rather than as certain.

    References
    ----------
    Palmer (2015), Algorithm 4.2, eq. 4.1.
    """
    probability, counts, winner = _assign(presence, labels)
    bounded = np.clip(probability, _LEAST, 1.0 - _LEAST)
    terms = counts[:, 1] * np.log(bounded) + counts[:, 0] * np.log1p(-bounded)
    return Assignment(probability, counts, winner, float(terms.sum()))


@kernel
def _assign(
    presence: NDArray[np.bool_], labels: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    n_leaves, n_scenes = presence.shape
    probability = np.full(n_leaves, -1.0)
    counts = np.zeros((n_leaves, 2), dtype=np.int64)
    winner = np.full(n_scenes, -1, dtype=np.int64)
    undecided = np.zeros((n_leaves, 2), dtype=np.int64)
    for scene in range(n_scenes):
        _count(presence, scene, int(labels[scene]), 1, undecided)
    bound = np.inf
    best = _most_probable(undecided, probability)
    while best >= 0:
        n_positive, n_present = undecided[best, 1], undecided[best, 0] + undecided[best, 1]
        probability[best] = min(n_positive / n_present, bound)
        bound = probability[best] * _BELOW_PREVIOUS
        for scene in range(n_scenes):
            if presence[best, scene] and winner[scene] < 0:
                winner[scene] = best
                counts[best, int(labels[scene])] += 1
                _count(presence, scene, int(labels[scene]), -1, undecided)
        best = _most_probable(undecided, probability)
    for leaf in range(n_leaves):
        if probability[leaf] < 0.0:
            probability[leaf] = min(labels.mean(), bound)
            bound = probability[leaf] * _BELOW_PREVIOUS
    return probability, counts, winner


@kernel
def _count(
    presence: NDArray[np.bool_], scene: int, label: int, by: int, undecided: NDArray[np.int64]
) -> None:
    """Add `by` to the count (n_leaves, 2) of undecided scenes at each leaf where the scene is present."""
    for leaf in range(presence.shape[0]):
        if presence[leaf, scene]:
            undecided[leaf, label] += by


@kernel
def _most_probable(undecided: NDArray[np.int64], probability: NDArray[np.float64]) -> int:
    """Return the unassigned leaf with the largest share of positive undecided scenes, -1 if none."""
    best, highest = -1, -1.0
    for leaf in range(len(probability)):
        total = undecided[leaf, 0] + undecided[leaf, 1]
        if probability[leaf] < 0.0 and total > 0 and undecided[leaf, 1] / total > highest:
            best, highest = leaf, undecided[leaf, 1] / total
    return best


def potential(
    presence: NDArray[np.bool_], labels: NDArray[np.bool_], winner: NDArray[np.int64], leaf: int
) -> float:
    """Return the log likelihood if a question could separate a leaf's own positive scenes from all others.

    The source asks for "the leaf with best potential to improve L" without giving a formula. Here the leaf
    keeps the positive scenes it decides, and all other scenes present move to an imaginary leaf.
    """
    own = (winner == leaf) & labels
    imagined = np.vstack([presence, presence[leaf] & ~own])
    imagined[leaf] = own
    return assign(imagined, labels).log_likelihood
