"""The path of one scene through a tree: the deciding leaf, the nodes above it, and the objects bound."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes import Scenes
from relforest.scenes.ids import plain
from relforest.support.errors import InputError
from relforest.trees import Instantiation, Question, Tree, query
from relforest.trees.nodes import ANSWERS, AnyLeaf, children, variable_name
from relforest.trees.text import introduced, sentence


@final
@dataclass(frozen=True, slots=True, eq=False)
class TreePath:
    """How a tree decided about one scene."""

    scene_id: Any
    leaf: int  # ordinal of the deciding leaf
    nodes: tuple[int, ...]  # node indices from the root to the leaf
    witnesses: tuple[Any, ...]
    """Identifier of the object bound to each variable on the path, None = no object."""
    points: dict[int, NDArray[np.float64]]  # the point seen by each question on the path; NaN if undefined
    says: str  # what the leaf predicts


def tree_path(tree: Tree, scene: Scenes) -> TreePath:
    """Follow a single scene with the schema of the tree through it.

    Raises
    ------
    InputError
        If there is not exactly one scene, or it has a different schema.
    """
    if len(scene) != 1:
        raise InputError(f"expected a single scene, got {len(scene)}: select it with scenes.take([position])")
    answers = query(tree, scene)
    leaf, rows = int(answers.leaf[0]), answers.witnesses[0]
    nodes = _ancestors(tree, tree.leaves[leaf])
    decides = tree.nodes[nodes[-1]]
    says = decides.says if isinstance(decides, AnyLeaf) else ""
    bound_rows = rows[: tree.n_bound[tree.leaves[leaf]]]
    witnesses = tuple(None if row < 0 else plain(scene.object_ids[row]) for row in bound_rows)
    points = {}
    for index in nodes:
        node = tree.nodes[index]
        if isinstance(node, Question):
            bound = np.ascontiguousarray(rows[list(node.variables)][None])
            points[index] = node.mapping.evaluate(scene.schema, scene.matrix, bound)[0]
    return TreePath(plain(scene.scene_ids[0]), leaf, nodes, witnesses, points, says)


def witness_names(tree: Tree, path: TreePath) -> tuple[str, ...]:
    """Return the variables bound on a path as text, such as ``("A (passer) = p3", "B = p7")``."""
    parameters = tree.schema.parameters
    names = []
    for variable, witness in enumerate(path.witnesses):
        letter = variable_name(variable)
        named = variable < len(parameters) and parameters[variable] != letter
        role = f" ({parameters[variable]})" if named else ""
        names.append(f"{letter}{role} = {'no object' if witness is None else witness}")
    return tuple(names)


def path_in_words(tree: Tree, path: TreePath) -> str:
    """Describe the path of a scene: the objects, each question and its answer, and the deciding leaf."""
    new = introduced(tree.schema, tree.nodes)
    lines = [f"scene {path.scene_id}: {path.says}, leaf {path.leaf}"]
    lines += [f"    {name}" for name in witness_names(tree, path)]
    for place, index in enumerate(path.nodes):
        match tree.nodes[index]:
            case Question() as node:
                below = (node.yes, node.no, node.error)
                answer = ANSWERS[below.index(path.nodes[place + 1])]
                lines.append(f"    {sentence(node, new[index])} -> {answer}")
            case AnyLeaf() as leaf:
                lines.append(f"    {leaf.summary}")
            case Instantiation():
                continue
    return "\n".join(lines)


def _ancestors(tree: Tree, index: int) -> tuple[int, ...]:
    parents = {child: parent for parent, node in enumerate(tree.nodes) for child in children(node)}
    path = [index]
    while path[-1] in parents:
        path.append(parents[path[-1]])
    return tuple(reversed(path))
