"""What a SMRF tree says about scenes as numbers (Palmer (2015), section 6.4).

Letters: n scenes, k columns.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from relforest.scenes.arrays import FloatArray
    from relforest.trees import Answers, Tree

LeafMode = Literal["densities+bits", "bits"]
TreeMode = Literal["densities+bits", "bits", "probability"]


def leaf_widths(tree: Tree, mode: LeafMode) -> tuple[int, ...]:
    """Return the number of columns of each leaf: a bit and, with densities, one per question above it."""
    if mode == "bits":
        return (1,) * tree.n_leaves
    return tuple(1 + len(above) for above in tree.questions_above)


def width(tree: Tree, mode: TreeMode) -> int:
    """Return the number of columns that a tree contributes."""
    return 1 if mode == "probability" else sum(leaf_widths(tree, mode))


def tree_features(tree: Tree, answers: Answers, mode: TreeMode) -> FloatArray:
    """Return the features of n scenes, (n, k).

    Parameters
    ----------
    tree : Tree
    answers : Answers
        The answers of the tree for the scenes.
    mode : {"densities+bits", "bits", "probability"}
        - ``"densities+bits"``: for each leaf in order its bit (1 if it decides the scene), then the density
          at each question above it, root first, for the most representative instantiation sequence. Leaves
          that do not decide the scene, and questions answered with Error, contribute 0.
        - ``"bits"``: the bits alone.
        - ``"probability"``: one column, the probability of the deciding leaf, or its mean (Palmer (2015),
          section 5.2.3).

    References
    ----------
    Palmer (2015), section 6.4. A density is taken relative to its peak: the source
    leaves the scale open, and a constant factor changes only the weight.
    """
    if mode == "probability":
        predictions: FloatArray = tree.leaf_predictions[answers.leaf][:, None]
        return predictions
    features = np.zeros((len(answers.leaf), width(tree, mode)))
    start = 0
    for leaf, columns in enumerate(leaf_widths(tree, mode)):
        own = np.flatnonzero(answers.leaf == leaf)
        features[own, start] = 1.0
        features[own, start + 1 : start + columns] = answers.densities[own, : columns - 1]
        start += columns
    return features
