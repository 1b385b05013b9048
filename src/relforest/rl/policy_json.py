"""A learned policy as plain values: a description, weights, and one JSON file per tree in ``trees/``.

`describe` and `policy_of` convert a value function to and from JSON, with its trees in separate files. The
checkpoint of a run contains the description and the weights; ``policy.json`` and ``weights.npz`` repeat them
for reading.
"""

from __future__ import annotations

import re
import reprlib
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from relforest.rl.settings import FeatureMode
from relforest.rl.value import ValueFunction
from relforest.runs.store import CHECKPOINT
from relforest.scenes import Schema
from relforest.scenes.arrays import FloatArray
from relforest.smdp import ActionType
from relforest.support.documents import well_formed
from relforest.support.errors import ModelFormatError
from relforest.support.files import read_json
from relforest.trees import Tree
from relforest.trees.structure import check_counts
from relforest.trees.tree import FORMAT as TREE_FORMAT
from relforest.trees.tree import VERSION as TREE_VERSION

FORMAT: Final = "relforest-policy"
VERSION: Final = 1
POLICY: Final = "policy.json"
WEIGHTS: Final = "weights.npz"
TREES: Final = "trees"
TREE_FILES: Final = rf"{TREES}/\d{{4}}-.+-\d+\.json"
"""A pattern of the names of the files of trees."""
MAX_ACTIONS: Final = 1000

TreeNames = tuple[tuple[str, ...], ...]
"""For each action type, the file names of its trees."""


def describe(value: ValueFunction, tree_names: TreeNames) -> dict[str, Any]:
    """Return the description of a policy, without trees and weights, as plain JSON values."""
    actions = [
        {
            "name": action_type.name,
            "parameters": list(action_type.parameters),
            "weights": slug,
            "trees": list(names),
        }
        for action_type, slug, names in zip(
            value.action_types, slugs(value.action_types), tree_names, strict=True
        )
    ]
    return {"schema": value.schema.to_dict(), "features": value.features, "actions": actions}


def derived_files(
    value: ValueFunction, tree_names: TreeNames, iteration: int
) -> dict[str, Mapping[str, Any]]:
    """Return ``policy.json`` and ``weights.npz``, for reading."""
    header = {"format": FORMAT, "version": VERSION, "iteration": iteration}
    arrays = {"iteration": np.array(iteration)} | named_weights(value)
    return {POLICY: header | describe(value, tree_names), WEIGHTS: arrays}


def named_weights(value: ValueFunction) -> dict[str, FloatArray]:
    """Return the weights by the names that `describe` uses."""
    return dict(zip(slugs(value.action_types), value.weights, strict=True))


def plain_policy(value: ValueFunction, tree_names: TreeNames) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what `policy_of` reads: the document, and the files of the trees by name."""
    weights = {name: vector.tolist() for name, vector in named_weights(value).items()}
    files = {
        f"{TREES}/{name}": tree.to_dict()
        for names, forest in zip(tree_names, value.forests, strict=True)
        for name, tree in zip(names, forest, strict=True)
    }
    return {"policy": describe(value, tree_names), "weights": weights}, files


def policy_of(document: Mapping[str, Any], folder: Path) -> tuple[ValueFunction, TreeNames]:
    """Return the policy of a checkpoint and the names of its trees; errors are those of `read_policy`."""
    origin = str(folder / CHECKPOINT)
    with well_formed(f"{origin} is damaged", "restore it from a copy or start again in another folder"):
        weights = {name: _vector(name, vector) for name, vector in document["weights"].items()}
        policy = dict(document["policy"])
    with well_formed(f"{origin} does not describe a policy"):
        check_counts({"nodes": (), "schema": policy["schema"]})
        schema = Schema.from_dict(policy["schema"])
        actions = [dict(entry) for entry in policy["actions"]]
        if len(actions) > MAX_ACTIONS:
            raise ModelFormatError(
                f"{len(actions)} action types are too many: at most {MAX_ACTIONS} are allowed"
            )
        types = tuple(ActionType(entry["name"], _listed(entry, "parameters")) for entry in actions)
        names = tuple(tuple(map(_file_name, _listed(entry, "trees"))) for entry in actions)
        (repeated, count), *_ = Counter(name for own in names for name in own).most_common(1) or [("", 0)]
        if count > 1:
            raise ModelFormatError(f"it lists the tree {repeated!r:.100} {count} times")
        features: FeatureMode = policy["features"]
        vectors = tuple(weights[entry["weights"]] for entry in actions)
        forests = tuple(tuple(_read_tree(folder / TREES / name) for name in own) for own in names)
        return ValueFunction(schema, types, features, forests, vectors), names


def tree_name(iteration: int, slug: str, number: int) -> str:
    """Return the file name of a tree, such as ``0001-left-1.json``: iteration, action type, number."""
    return f"{iteration:04d}-{slug}-{number}.json"


def slugs(action_types: Sequence[ActionType]) -> tuple[str, ...]:
    """Return names of action types that are safe and distinct as file names on any file system."""
    plain = [re.sub(r"[^A-Za-z0-9_]+", "_", action_type.name) for action_type in action_types]
    lower = [name.lower() for name in plain]
    return tuple(
        name if lower.count(name.lower()) == 1 and name != "iteration" else f"{name}-{number}"
        for number, name in enumerate(plain)
    )


def _read_tree(path: Path) -> Tree:
    document = read_json(path, format=TREE_FORMAT, version=TREE_VERSION)
    with well_formed(f"{path} is not a valid tree"):
        return Tree.from_dict(document)


def _listed(entry: Mapping[str, Any], key: str) -> tuple[Any, ...]:
    if not isinstance(entry[key], list):
        raise ModelFormatError(f"{key} must be a list, got {entry[key]!r:.100}")
    return tuple(entry[key])


def _file_name(name: object) -> str:
    # A model from elsewhere must not cause files outside its folder to be read.
    if not isinstance(name, str) or not re.fullmatch(r"\w[\w.-]{,200}\.json", name):
        raise ModelFormatError(
            f"{name!r:.100} is no file name of a tree; expected one such as 0001-left-1.json"
        )
    return name


def _vector(name: str, numbers: object) -> FloatArray:
    if not isinstance(numbers, list) or not all(type(number) in (int, float) for number in numbers):
        raise ModelFormatError(f"the weights {reprlib.repr(name)} must be a list of numbers")
    return np.array(numbers, dtype=np.float64)
