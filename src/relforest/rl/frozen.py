"""What learned trees say about actions, for a learner of weights alone (Palmer (2015), section 7.5.2)."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from hashlib import blake2b
from typing import Any, final

import numpy as np

from relforest.forests.tree_features import leaf_widths, width
from relforest.rl.baselines import Features
from relforest.rl.kernels import ForestArrays, forest_rows
from relforest.rl.policy_json import TreeNames
from relforest.rl.settings import FeatureMode
from relforest.rl.value import ValueFunction, pack_forest
from relforest.scenes.arrays import IntArray
from relforest.smdp import Decision
from relforest.trees import Tree
from relforest.trees.kernels import query_work


@final
@dataclass(frozen=True, slots=True, eq=False)
class ForestFeatures:
    """A feature map for decisions: a block for each action type, the features of its trees and a constant.

    They are those of `relforest.rl.value.forest_features`, and 0 in the blocks of other types.

    References
    ----------
    Palmer (2015), sections 6.4 and 7.5.2.
    """

    value: ValueFunction  # the trees; its weights do not matter
    tree_names: TreeNames  # the file names of the trees
    _forests: tuple[tuple[ForestArrays, IntArray], ...] = field(init=False, repr=False)
    """For each action type its trees, and the column of each of their leaves."""
    _starts: IntArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        mode, forests, starts = self.value.features, [], [0]
        for trees in self.value.forests:
            size = 1 + sum(width(tree, mode) for tree in trees)
            forests.append((pack_forest(trees, np.ones(size), mode), _leaf_columns(trees, mode) + starts[-1]))
            starts.append(starts[-1] + size)
        object.__setattr__(self, "_forests", tuple(forests))
        object.__setattr__(self, "_starts", np.array(starts))

    @property
    def n_features(self) -> int:
        """Number of columns of all action types."""
        return int(self._starts[-1])

    @property
    def n_active(self) -> int:
        """Most features of an action that are not 0: of each tree one leaf decides."""
        mode = self.value.features
        active = [
            1 + sum(1 if mode == "probability" else max(leaf_widths(tree, mode)) for tree in trees)
            for trees in self.value.forests
        ]
        return max(active)

    def features(self, decision: Decision, /) -> Features:
        """Return the features of each action, all columns of them."""
        out = np.zeros((len(decision), self.n_features))
        out[np.arange(len(decision)), self._starts[decision.types]] = 1.0
        shared = np.arange(decision.n_shared)
        for number, (forest, columns) in enumerate(self._forests):
            chosen = np.flatnonzero(decision.types == number)
            asked = (chosen, decision.arguments[chosen, : self.value.action_types[number].arity])
            work, place = query_work(*forest.sizes), np.zeros(2, dtype=np.int64)
            # Python can be interrupted between two calls.
            while not forest_rows(forest, columns, decision.objects, shared, asked, work, out, place):
                pass
        return Features(np.tile(np.arange(self.n_features), (len(out), 1)), out)

    def to_dict(self) -> dict[str, Any]:
        """Return what identifies the trees."""
        trees = [[tree.to_dict() for tree in trees] for trees in self.value.forests]
        text = json.dumps([self.value.features, trees], sort_keys=True)
        digest = blake2b(text.encode(), digest_size=8).hexdigest()
        return {"kind": "trees", "n_features": self.n_features, "digest": digest}


def _leaf_columns(trees: tuple[Tree, ...], mode: FeatureMode) -> IntArray:
    """Return the first column of each leaf, (n_leaves,); the first of all holds the constant."""
    found, first = [np.empty(0, dtype=np.int64)], 1
    for tree in trees:
        if mode == "probability":
            found.append(np.full(tree.n_leaves, first))
        else:
            found.append(first + np.cumsum([0, *leaf_widths(tree, mode)[:-1]]))
        first += width(tree, mode)
    return np.concatenate(found)
