"""What the scores of an ensemble say about classes: probabilities that add up to 1."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.special import expit, softmax

if TYPE_CHECKING:
    from numpy.typing import NDArray


def mean_shares(scores: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the probabilities of classes that the trees of a forest give on average.

    Scores (n_scenes, n_outputs) are those of all classes, or of the second of two only; probabilities are
    (n_scenes, n_classes).
    """
    if scores.shape[1] == 1:
        positive = np.clip(scores[:, 0], 0.0, 1.0)
        return np.column_stack([1.0 - positive, positive])
    bounded = np.clip(scores, 0.0, None)
    total = bounded.sum(axis=1, keepdims=True)
    # A file may hold trees that give no class a share.
    same = np.full_like(bounded, 1.0 / scores.shape[1])
    return np.asarray(np.divide(bounded, total, out=same, where=total > 0.0))


def logistic_shares(scores: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the probabilities of classes by their log-odds, as boosting and rule sets learn them.

    Scores (n_scenes, n_outputs) are unnormalised log probabilities of all classes, or the log-odds of the
    second of two; probabilities are (n_scenes, n_classes).
    """
    if scores.shape[1] == 1:
        return np.column_stack([expit(-scores[:, 0]), expit(scores[:, 0])])
    return np.asarray(softmax(scores, axis=1))
