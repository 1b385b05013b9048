"""A learned policy as files: ``policy.json``, ``weights.npz`` and one JSON file per tree in ``trees/``.

`describe` and `rebuild` convert a value function to and from JSON, with its trees in separate files. A
checkpoint contains the same description, including the weights.
"""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from relforest.rl.settings import FeatureMode
from relforest.rl.value import ValueFunction
from relforest.scenes import Schema
from relforest.scenes.arrays import FloatArray
from relforest.smdp import ActionType
from relforest.support.documents import well_formed
from relforest.support.errors import ModelFormatError
from relforest.support.files import read_json, read_npz, write_json, write_npz
from relforest.trees import Tree
from relforest.trees.structure import check_counts
from relforest.trees.tree import FORMAT as TREE_FORMAT
from relforest.trees.tree import VERSION as TREE_VERSION

FORMAT: Final = "relforest-policy"
VERSION: Final = 1
POLICY: Final = "policy.json"
WEIGHTS: Final = "weights.npz"
TREES: Final = "trees"
MAX_ACTIONS: Final = 1000

TreeNames = tuple[tuple[str, ...], ...]
"""For each action type, the file names of its trees."""


def describe(value: ValueFunction, tree_names: TreeNames) -> dict[str, Any]:
    """Return the description of a policy, without trees and weights, as plain JSON values."""
    actions = [
        {"name": kind.name, "parameters": list(kind.parameters), "weights": slug, "trees": list(names)}
        for kind, slug, names in zip(value.action_types, slugs(value.action_types), tree_names, strict=True)
    ]
    return {"schema": value.schema.to_dict(), "features": value.features, "actions": actions}


def rebuild(
    document: Mapping[str, Any], weights: Mapping[str, FloatArray], folder: Path, origin: str
) -> tuple[ValueFunction, TreeNames]:
    """Build the value function from a description.

    Parameters
    ----------
    document : mapping
        Contains the output of `describe`.
    weights : mapping of str to (k_a,) float64
        Weights, by the names used in the description.
    folder : path
        The folder that contains the folder of trees.
    origin : str
        Where the description comes from, for error messages.

    Raises
    ------
    ModelFormatError
        If a part is missing or malformed, or the parts do not match.
    """
    with well_formed(f"{origin} does not describe a policy"):
        check_counts({"nodes": (), "schema": document["schema"]})
        schema = Schema.from_dict(document["schema"])
        actions = [dict(entry) for entry in document["actions"]]
        if len(actions) > MAX_ACTIONS:
            raise ModelFormatError(
                f"{len(actions)} action types are too many: at most {MAX_ACTIONS} are allowed"
            )
        kinds = tuple(ActionType(entry["name"], _listed(entry, "parameters")) for entry in actions)
        names = tuple(tuple(map(_file_name, _listed(entry, "trees"))) for entry in actions)
        (repeated, count), *_ = Counter(name for own in names for name in own).most_common(1) or [("", 0)]
        if count > 1:
            raise ModelFormatError(f"it lists the tree {repeated!r:.100} {count} times")
        features: FeatureMode = document["features"]
        vectors = tuple(weights[entry["weights"]] for entry in actions)
        forests = tuple(tuple(_read_tree(folder / TREES / name) for name in own) for own in names)
        return ValueFunction(schema, kinds, features, forests, vectors), names


def write_policy(
    folder: str | os.PathLike[str], value: ValueFunction, tree_names: TreeNames, iteration: int
) -> None:
    """Write ``weights.npz`` and ``policy.json``; the trees must have been written before (`write_tree`)."""
    arrays = {"iteration": np.array(iteration)}
    arrays |= dict(zip(slugs(value.action_types), value.weights, strict=True))
    write_npz(Path(folder) / WEIGHTS, arrays)
    header = {"format": FORMAT, "version": VERSION, "iteration": iteration}
    write_json(Path(folder) / POLICY, header | describe(value, tree_names))


def read_policy(folder: str | os.PathLike[str]) -> ValueFunction:
    """Read the policy from a run folder; its experience and checkpoint are not needed.

    Raises
    ------
    ModelFormatError
        If a file is missing or malformed, or the files do not match.
    """
    value = _read_parts(Path(folder))
    if value is None:
        raise ModelFormatError(
            f"{POLICY} and {WEIGHTS} in {folder} belong to different iterations, as after an interruption; "
            "continue the run to restore both"
        )
    return value


def check_policy(folder: str | os.PathLike[str]) -> None:
    """Check that the files of a policy are readable, even if an interruption left them out of step.

    Raises
    ------
    ModelFormatError
        If a file is missing or malformed.
    """
    _read_parts(Path(folder))


def write_tree(folder: Path, name: str, tree: Tree) -> None:
    """Write one tree to the folder of trees."""
    write_json(folder / TREES / name, tree.to_dict())


def tree_name(iteration: int, slug: str, number: int) -> str:
    """Return the file name of a tree, such as ``0001-left-1.json``: iteration, action type, number."""
    return f"{iteration:04d}-{slug}-{number}.json"


def slugs(action_types: Sequence[ActionType]) -> tuple[str, ...]:
    """Return names of action types that are safe and distinct as file names on any file system."""
    plain = [re.sub(r"[^A-Za-z0-9_]+", "_", kind.name) for kind in action_types]
    lower = [name.lower() for name in plain]
    return tuple(
        name if lower.count(name.lower()) == 1 and name != "iteration" else f"{name}-{number}"
        for number, name in enumerate(plain)
    )


def _read_parts(folder: Path) -> ValueFunction | None:
    """Read a policy; None if its two files are valid but belong to different iterations."""
    path = folder / POLICY
    document = read_json(path, format=FORMAT, version=VERSION)
    with well_formed(f"{path} does not describe a policy"):
        names = [str(entry["weights"]) for entry in document["actions"]]
        iteration = document["iteration"]
        if type(iteration) is not int:
            raise ModelFormatError(f"the iteration must be an integer, got {iteration!r:.100}")
    arrays = read_npz(folder / WEIGHTS, ["iteration", *names])
    if not np.array_equal(arrays["iteration"], iteration):
        return None
    return rebuild(document, arrays, folder, str(path))[0]


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
