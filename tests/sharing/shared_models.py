"""Random models of all kinds, their scenes as rows of a table, and what the library predicts for them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from itertools import groupby
from typing import Any

import numpy as np
import pyarrow as pa

import forest_scenes
import random_trees
from relforest.forests import Ensemble
from relforest.forests.scene_tree import SceneTree, Split, Value
from relforest.models import Model, prediction_table
from relforest.scenes import Scenes
from relforest.scenes.arrow import ArrowTable
from relforest.scenes.parquet import to_table
from relforest.trees import ClassLeaf, MeanLeaf, Tree
from relforest.trees.nodes import AnyLeaf

KINDS = ("tree", "numbers", "classes", "conditions", "rules", "several", "smrf")

N_MODELS = int(os.environ.get("RELFOREST_SHARED_MODELS", "3"))
N_SCENES = int(os.environ.get("RELFOREST_SHARED_SCENES", "60"))
"""Models of each kind, and scenes for each of them: 24 models of the 7 kinds with 600 each are 10^5."""


def random_cases(seed: int, kind: str) -> Iterator[tuple[Model, Scenes]]:
    """Models with none, one and two arguments, and scenes for them."""
    rng = np.random.default_rng(seed)
    for number in range(N_MODELS):
        yield random_model(rng, kind, number % 3), random_scenes(rng, kind, number % 3, N_SCENES)


def random_model(rng: np.random.Generator, kind: str, n_parameters: int) -> Model:
    if kind in {"tree", "numbers", "classes"}:
        tree = random_trees.random_tree(rng, n_parameters)
        if kind == "tree":
            return Model(tree, "tree", "done", (False, True), None)
        nodes = tuple(
            _other_leaf(rng, node, kind) if isinstance(node, AnyLeaf) else node for node in tree.nodes
        )
        classes = None if kind == "numbers" else ("red", "it's", "blue")
        return Model(Tree(tree.schema, nodes), "tree", "what", classes, None)
    if kind == "smrf":
        trees = tuple(random_trees.random_tree(rng, n_parameters) for _ in range(3))
        ensemble = Ensemble(trees[0].schema, np.array([0.1]), trees, np.array([0.5, -0.3, 0.4]))
        return Model(ensemble, "forest", "done", (0, 1), None)
    n_outputs = 3 if kind == "several" else 1
    schema = forest_scenes.random_scenes(rng, 1, n_parameters).schema
    scene_trees = tuple(_scene_tree(rng, n_parameters, n_outputs) for _ in range(3))
    ensemble = Ensemble(schema, rng.normal(size=n_outputs), scene_trees, rng.normal(size=3))
    if kind == "several":
        return Model(ensemble, "boosting", "what", ("red", "it's", "blue"), None)
    if kind == "rules":
        return Model(ensemble, "rules", "done", (False, True), None)
    return Model(ensemble, "forest", "space", None, None)


def random_scenes(rng: np.random.Generator, kind: str, n_parameters: int, n_scenes: int) -> Scenes:
    if kind in {"conditions", "rules", "several"}:
        return forest_scenes.random_scenes(rng, n_scenes, n_parameters)
    return random_trees.random_scenes(rng, n_parameters, n_scenes, n_rows=max(20, n_scenes))


def scene_rows(scenes: Scenes) -> list[list[dict[str, Any]]]:
    rows = to_table(scenes.parts).to_pylist()
    return [list(own) for _, own in groupby(rows, key=lambda row: row["scene_number"])]


def expected(model: Model, scenes: Scenes) -> ArrowTable:
    """The predictions of the library without leaf and witnesses."""
    table = prediction_table(model, scenes)
    return table.select([name for name in table.column_names if not name.startswith(("leaf", "witness"))])


def differences(model: Model, scenes: Scenes, found: list[dict[str, Any]]) -> list[tuple[Any, Any]]:
    """What was found in place of what was expected, apart from the last digits of numbers."""
    wanted = expected(model, scenes).drop(["scene"]).to_pylist()
    assert len(found) == len(wanted)
    return [(one, other) for one, other in zip(found, wanted, strict=True) if not _same(one, other)]


def arrow(scenes: Scenes) -> pa.Table:
    return to_table(scenes.parts)


def _same(one: dict[str, Any], other: dict[str, Any]) -> bool:
    return list(one) == list(other) and all(
        abs(mine - theirs) <= 1e-12 * max(1.0, abs(theirs))
        if isinstance(mine, float) and isinstance(theirs, float)
        else mine == theirs
        for mine, theirs in zip(one.values(), other.values(), strict=True)
    )


def _other_leaf(rng: np.random.Generator, leaf: AnyLeaf, kind: str) -> MeanLeaf | ClassLeaf:
    if kind == "numbers":
        return MeanLeaf(leaf.probability, 0, 3, 0.5, lowest=True)
    shares = rng.dirichlet(np.ones(3)).tolist()
    return ClassLeaf(leaf.probability, 1, 2, tuple(shares), (1, 1, 1))


def _scene_tree(rng: np.random.Generator, n_parameters: int, n_outputs: int) -> SceneTree:
    values = [Value(tuple(rng.normal(size=n_outputs).tolist()), 1) for _ in range(4)]
    first, second, third = (forest_scenes.random_condition(rng, n_parameters) for _ in range(3))
    return SceneTree(
        (Split(first, 1, 4, 1.0), Split(second, 2, 3, 1.0), *values[:2], Split(third, 5, 6, 1.0), *values[2:])
    )
