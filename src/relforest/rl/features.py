"""The features that a forest of SMRF trees extracts from a scene (Palmer (2015), section 6.4).

Letters: n scenes, k columns.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from relforest.rl.settings import FeatureMode
from relforest.scenes import Scenes
from relforest.scenes.arrays import FloatArray
from relforest.trees import Answers, Tree, query

LeafMode = Literal["densities+bits", "bits"]


def leaf_widths(tree: Tree, mode: LeafMode) -> tuple[int, ...]:
    """Return the number of columns of each leaf: a bit and, with densities, one per question above it."""
    if mode == "bits":
        return (1,) * tree.n_leaves
    return tuple(1 + len(above) for above in tree.questions_above)


def width(tree: Tree, mode: FeatureMode) -> int:
    """Return the number of columns that a tree contributes."""
    return 1 if mode == "probability" else sum(leaf_widths(tree, mode))


def tree_features(tree: Tree, answers: Answers, mode: FeatureMode) -> FloatArray:
    """Return the features of n scenes, shape (n, k).

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
        - ``"probability"``: one column, the probability of the deciding leaf (Palmer (2015), section 5.2.3).

    References
    ----------
    Palmer (2015), section 6.4. A density is taken relative to its peak: the source
    leaves the scale open, and a constant factor changes only the weight.
    """
    if mode == "probability":
        probabilities: FloatArray = tree.leaf_probabilities[answers.leaf][:, None]
        return probabilities
    features = np.zeros((len(answers.leaf), width(tree, mode)))
    start = 0
    for leaf, columns in enumerate(leaf_widths(tree, mode)):
        own = np.flatnonzero(answers.leaf == leaf)
        features[own, start] = 1.0
        features[own, start + 1 : start + columns] = answers.densities[own, : columns - 1]
        start += columns
    return features


def forest_features(trees: Sequence[Tree], scenes: Scenes, mode: FeatureMode) -> FloatArray:
    """Return the features of one action type, (n, k): a constant 1 (the bias), then each tree's columns."""
    columns = [tree_features(tree, query(tree, scenes), mode) for tree in trees]
    return np.hstack([np.ones((len(scenes), 1)), *columns])
