"""Assignment of leaf probabilities, written plainly (Palmer 2015, Algorithm 4.2).

The twin of the assignment in ``relforest.trees``. Two rules complete the source: a leaf never gets a
probability as high as one assigned before it, and a leaf that no remaining scene reaches comes last with the
base rate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

CAP = 1 - 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Assignment:
    """Probabilities of leaves and what they were counted from.

    Attributes
    ----------
    probabilities : (n_leaves,) float64
    negatives, positives : (n_leaves,) int64, scenes won by each leaf
    winners : (n_scenes,) int64, the leaf that won each scene, -1 for a scene that is present at no leaf
    """

    probabilities: NDArray[np.float64]
    negatives: NDArray[np.int64]
    positives: NDArray[np.int64]
    winners: NDArray[np.int64]


def assign(presence: NDArray[np.bool_], labels: NDArray[np.bool_]) -> Assignment:
    """Return the assignment for a presence matrix (n_leaves, n_scenes) and the labels of the scenes."""
    n_leaves, n_scenes = presence.shape
    probabilities = np.zeros(n_leaves)
    negatives = np.zeros(n_leaves, dtype=np.int64)
    positives = np.zeros(n_leaves, dtype=np.int64)
    winners = np.full(n_scenes, -1, dtype=np.int64)
    waiting = list(range(n_leaves))
    previous: float | None = None
    while waiting:
        best = -1
        best_rate = -1.0
        for leaf in waiting:
            here = presence[leaf] & (winners == -1)
            if here.any() and labels[here].mean() > best_rate:
                best, best_rate = leaf, float(labels[here].mean())
        if best == -1:
            best, best_rate = waiting[0], float(labels.mean())
        if previous is not None and best_rate >= previous:
            best_rate = CAP * previous
        won = presence[best] & (winners == -1)
        winners[won] = best
        probabilities[best] = best_rate
        positives[best] = int(labels[won].sum())
        negatives[best] = int(won.sum()) - positives[best]
        waiting.remove(best)
        previous = best_rate
    return Assignment(probabilities, negatives, positives, winners)
