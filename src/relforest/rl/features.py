"""The features that a forest of SMRF trees extracts from a scene (Palmer (2015), section 6.4)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from relforest.forests.tree_features import tree_features
from relforest.rl.settings import FeatureMode
from relforest.scenes import Scenes
from relforest.scenes.arrays import FloatArray
from relforest.trees import Tree, query


def forest_features(trees: Sequence[Tree], scenes: Scenes, mode: FeatureMode) -> FloatArray:
    """Return the features of one action type, (n, k): a constant 1 (the bias), then each tree's columns."""
    columns = [tree_features(tree, query(tree, scenes), mode) for tree in trees]
    return np.hstack([np.ones((len(scenes), 1)), *columns])
