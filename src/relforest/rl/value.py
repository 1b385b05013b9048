"""The action-value function of an agent: a forest and a weight vector per action type.

Policies call `ValueFunction.values` at every step of an episode. It does not build features: the forest of an
action type is packed once into a few arrays, and a kernel adds up the weights of the leaves that decide.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import final

import numpy as np

from relforest.forests.questions import leaf_in_words
from relforest.forests.tree_features import leaf_widths, tree_features, width
from relforest.rl.action_scenes import action_scenes
from relforest.rl.explaining import AS_SUCH, Key, Part, Told
from relforest.rl.kernels import ForestArrays, forest_values
from relforest.rl.settings import FEATURE_MODES, FeatureMode
from relforest.scenes import Scenes, Schema
from relforest.scenes.arrays import FloatArray
from relforest.smdp import ActionType, Decision, Decisions
from relforest.support.documents import LARGEST_NUMBER
from relforest.support.errors import InputError
from relforest.support.options import one_of
from relforest.trees import Tree, query
from relforest.trees.kernels import query_work
from relforest.trees.nodes import variable_name
from relforest.trees.packing import CHILDREN, VOLUME


@final
@dataclass(frozen=True, slots=True, eq=False)
class ValueFunction:
    """Q(s, a), linear in the features of the trees of a's action type.

    Parameters
    ----------
    schema : Schema
        The attributes of the world, without parameters.
    action_types : tuple of ActionType
        The action types of the world.
    features : {"densities+bits", "bits", "probability"}
        The features that trees contribute.
    forests : tuple of tuple of Tree
        The trees of each action type; their schema includes the parameters of the type.
    weights : tuple of (k_a,) float64
        The weights of each action type: the bias, then the weights of each tree's columns.

    Raises
    ------
    InputError
        If the parts do not match, or a weight is not finite or exceeds 1e100.

    References
    ----------
    Palmer (2015), sections 2.1.2 and 6.4.
    """

    schema: Schema
    action_types: tuple[ActionType, ...]
    features: FeatureMode
    forests: tuple[tuple[Tree, ...], ...]
    weights: tuple[FloatArray, ...]
    _packed: tuple[ForestArrays, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        one_of("features", self.features, FEATURE_MODES)
        if not len(self.forests) == len(self.weights) == len(self.action_types):
            raise InputError(
                f"each of the {len(self.action_types)} action types needs a forest and a weight vector, "
                f"got {len(self.forests)} and {len(self.weights)}"
            )
        for number, schema in enumerate(action_schemas(self.schema, self.action_types)):
            self._check_forest(number, schema)
        packed = [
            pack_forest(trees, weights, self.features)
            for trees, weights in zip(self.forests, self.weights, strict=True)
        ]
        object.__setattr__(self, "_packed", tuple(packed))

    @classmethod
    def zero(cls, schema: Schema, action_types: Sequence[ActionType], features: FeatureMode) -> ValueFunction:
        """Return the value function before learning: no trees, and 0 for every action."""
        none: tuple[Tree, ...] = ()
        types = tuple(action_types)
        return cls(schema, types, features, (none,) * len(types), tuple(np.zeros(1) for _ in types))

    @property
    def n_trees(self) -> int:
        """Number of trees over all action types."""
        return sum(len(trees) for trees in self.forests)

    @property
    def n_leaves(self) -> int:
        """Number of leaves of all trees."""
        return sum(tree.n_leaves for trees in self.forests for tree in trees)

    def values(self, decision: Decision) -> FloatArray:
        """Return Q of each available action, (n_actions,).

        The decision must come from a world with this schema and these action types; this is not checked.
        """
        values = np.empty(len(decision))
        # Private objects are bound by the actions that see them, so they need not be searched.
        shared = np.arange(decision.n_shared)
        for number, (forest, action_type) in enumerate(zip(self._packed, self.action_types, strict=True)):
            chosen = np.flatnonzero(decision.types == number)
            if not len(chosen):
                continue
            out = np.empty(len(chosen))
            arguments = decision.arguments[chosen, : action_type.arity]
            work, place = query_work(*forest.sizes), np.zeros(2, dtype=np.int64)
            # Python can be interrupted between two calls.
            while not forest_values(forest, decision.objects, shared, arguments, work, out, place):
                pass
            values[chosen] = out
        return values

    def scene_values(self, number: int, scenes: Scenes) -> FloatArray:
        """Return Q of each scene of one action type, (n_scenes,), using features."""
        values: FloatArray = (
            forest_features(self.forests[number], scenes, self.features) @ self.weights[number]
        )
        return values

    def parts(self, decision: Decision, position: int) -> list[Part]:
        """Return what adds up to the value of an action, see `relforest.rl.explaining`.

        That is the weight of its type as such, and for each tree its features times their weights.
        """
        number = int(decision.types[position])
        scene, weights = self._scene(decision, position), self.weights[number]
        found, column = [Part((number, AS_SUCH), float(weights[0]))], 1
        for place, tree in enumerate(self.forests[number]):
            features = tree_features(tree, query(tree, scene), self.features)[0]
            found.append(Part((number, place), float(features @ weights[column : column + len(features)])))
            column += len(features)
        return found

    def tell(self, decision: Decision, position: int, key: Key) -> Told:
        """Return a part of the value of an action in words: the answers that lead to the leaf of a tree."""
        number, place = key
        if place == AS_SUCH:
            return Told(f"{self.action_types[number].name} as such")
        tree, scene = self.forests[number][place], self._scene(decision, position)
        answers = query(tree, scene)
        leaf = int(answers.leaf[0])
        bound = answers.witnesses[0][: tree.n_bound[tree.leaves[leaf]]].tolist()
        named = [(variable_name(variable), row) for variable, row in enumerate(bound) if row >= 0]
        return Told(leaf_in_words(tree, leaf, tree.schema), "", tuple(named))

    def _scene(self, decision: Decision, position: int) -> Scenes:
        """Return the scene of an action; its rows are positions in the decision."""
        schema = action_schemas(self.schema, self.action_types)[int(decision.types[position])]
        return action_scenes(Decisions.of([decision]), np.array([position]), schema)

    def _check_forest(self, number: int, schema: Schema) -> None:
        trees, weights, name = self.forests[number], self.weights[number], self.action_types[number].name
        if any(tree.schema != schema for tree in trees):
            raise InputError(
                f"a tree of action type {name!r} is for scenes with a schema other than {schema}"
            )
        columns = 1 + sum(width(tree, self.features) for tree in trees)
        # The negated test also catches NaN.
        if weights.shape != (columns,) or not (np.abs(weights) <= LARGEST_NUMBER).all():
            raise InputError(
                f"action type {name!r} needs {columns} finite weights, at most {LARGEST_NUMBER:g}, "
                f"for its bias and {len(trees)} trees, "
                f"got the shape {weights.shape}"
            )


def action_schemas(schema: Schema, action_types: Sequence[ActionType]) -> tuple[Schema, ...]:
    """Return the schema of the scenes of each action type, with the parameters of the type."""
    return tuple(Schema(schema.attributes, action_type.parameters) for action_type in action_types)


def forest_features(trees: Sequence[Tree], scenes: Scenes, mode: FeatureMode) -> FloatArray:
    """Return the features of one action type, (n, k): a constant 1 (the bias), then each tree's columns."""
    columns = [tree_features(tree, query(tree, scenes), mode) for tree in trees]
    return np.hstack([np.ones((len(scenes), 1)), *columns])


def pack_forest(trees: Sequence[Tree], weights: FloatArray, mode: FeatureMode) -> ForestArrays:
    """Lay the trees of one action type end to end, with the contribution of each leaf to the value."""
    nodes, numbers, added = [], [np.empty(0)], [np.empty(0)]
    roots: list[tuple[int, int]] = []
    leaves: list[tuple[int, int]] = []
    node_start, number_start, added_start, column = 0, 0, 0, 1
    for tree in trees:
        packed = tree.packed
        table = packed.nodes.copy()
        links = table[:, CHILDREN : CHILDREN + 3]
        links[links >= 0] += node_start
        table[table[:, VOLUME] >= 0, VOLUME] += number_start
        nodes.append(table)
        numbers.append(packed.numbers)
        roots.append((node_start, len(leaves)))
        for leaf in _leaf_weights(tree, weights[column : column + width(tree, mode)], mode):
            leaves.append((added_start, len(leaf) - 1))
            added.append(leaf)
            added_start += len(leaf)
        node_start, number_start, column = (
            node_start + len(table),
            number_start + len(packed.numbers),
            column + width(tree, mode),
        )
    return ForestArrays(
        np.concatenate(nodes) if nodes else np.empty((0, 0), np.int64),
        np.concatenate(numbers),
        np.array(roots, dtype=np.int64).reshape(-1, 2),
        np.array(leaves, dtype=np.int64).reshape(-1, 2),
        np.concatenate(added),
        float(weights[0]),
        (
            max((tree.packed.n_variables for tree in trees), default=0),
            max((tree.packed.n_asked for tree in trees), default=0),
            max((tree.packed.n_dims for tree in trees), default=0),
        ),
    )


def _leaf_weights(tree: Tree, weights: FloatArray, mode: FeatureMode) -> list[FloatArray]:
    """Return the contribution of each leaf when it decides: a constant, then the weights of its densities."""
    if mode == "probability":
        return list((tree.leaf_probabilities * weights[0])[:, None])
    ends = np.cumsum(leaf_widths(tree, mode))
    return np.split(weights, ends[:-1])
