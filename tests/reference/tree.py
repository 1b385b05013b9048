"""Query of a SMRF tree, written plainly with NumPy (Palmer 2015, section 4.1).

The twin of the compiled query of ``relforest.trees.inference``. All instantiation sequences of one scene walk
down the tree together: an instantiation node multiplies them, a question sorts them, a leaf collects them.
The formulas of mapping functions and volumes are written out here instead of being called.

Letters: s instantiation sequences, v variables bound so far, q questions answered so far, m objects of the
scene.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from relforest.scenes import Scenes
from relforest.trees import Instantiation, Question, Tree
from relforest.trees.nodes import AnyLeaf
from relforest.volumes import Arc, Slab, Volume

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

NOBODY = -1


@dataclass(frozen=True, slots=True)
class SceneAnswer:
    """What a tree says of one scene.

    Attributes
    ----------
    leaf : ordinal of the winning leaf in ``tree.leaves``
    densities : of the most representative sequence, root first, 0 for Error answers and beyond the path
    witnesses : object rows of that sequence, -1 = none
    n_sequences : number of instantiation sequences that arrived at leaves
    """

    leaf: int
    densities: tuple[float, ...]
    witnesses: tuple[int, ...]
    n_sequences: int


@dataclass(frozen=True, slots=True, eq=False)
class Arrivals:
    """The sequences at a node: ``objects`` (s, v) rows of the scene batch, ``logs`` (s, q) log densities.

    A log density is NaN where the question was answered by Error.
    """

    objects: Integers
    logs: Floats


def query(tree: Tree, scenes: Scenes) -> list[SceneAnswer]:
    """Return the answer of the tree for every scene."""
    return [query_scene(tree, scenes, scene) for scene in range(len(scenes))]


def query_scene(tree: Tree, scenes: Scenes, scene: int) -> SceneAnswer:
    """Return the answer of the tree for one scene."""
    at_leaves = sequences_at_leaves(tree, scenes, scene)
    node = max(sorted(at_leaves), key=lambda leaf: _probability(tree, leaf))
    arrivals = at_leaves[node]
    representative = int(np.argmax(np.nansum(arrivals.logs, axis=1)))
    densities = np.zeros(tree.depth)
    densities[: arrivals.logs.shape[1]] = np.nan_to_num(np.exp(arrivals.logs[representative]), nan=0.0)
    witnesses = np.full(tree.n_variables, NOBODY)
    witnesses[: arrivals.objects.shape[1]] = arrivals.objects[representative]
    return SceneAnswer(
        leaf=[int(leaf) for leaf in tree.leaves].index(node),
        densities=tuple(densities.tolist()),
        witnesses=tuple(witnesses.tolist()),
        n_sequences=sum(len(arrived.objects) for arrived in at_leaves.values()),
    )


def sequences_at_leaves(tree: Tree, scenes: Scenes, scene: int) -> dict[int, Arrivals]:
    """Return the sequences of one scene by the node index of the leaf they arrive at."""
    at_leaves: dict[int, Arrivals] = {}

    def visit(index: int, arrivals: Arrivals) -> None:
        if not len(arrivals.objects):
            return
        node = tree.nodes[index]
        if isinstance(node, AnyLeaf):
            at_leaves[index] = arrivals
        elif isinstance(node, Instantiation):
            visit(node.child, _bind_next(scenes, scene, arrivals))
        else:
            answer = _answer(node, scenes, arrivals)
            for child, chosen in zip((node.yes, node.no, node.error), answer.masks, strict=True):
                visit(child, Arrivals(arrivals.objects[chosen], answer.logs[chosen]))

    visit(0, Arrivals(np.empty((1, 0), dtype=np.int64), np.empty((1, 0))))
    return at_leaves


@dataclass(frozen=True, slots=True, eq=False)
class QuestionAnswer:
    """Masks of the sequences that take Yes, No and Error, and the log densities with one column more."""

    masks: tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]
    logs: Floats


def _probability(tree: Tree, index: int) -> float:
    leaf = tree.nodes[index]
    assert isinstance(leaf, AnyLeaf)
    return leaf.probability


def _bind_next(scenes: Scenes, scene: int, arrivals: Arrivals) -> Arrivals:
    """Bind the next variable: an argument of the action, else every object that is not yet in it."""
    sequences, n_bound = arrivals.objects.shape
    if n_bound < scenes.arguments.shape[1]:
        argument = np.full((sequences, 1), scenes.arguments[scene, n_bound])
        return Arrivals(np.hstack([arrivals.objects, argument]), arrivals.logs)
    first = scenes.starts[scene]
    objects = scenes.rows[first : first + scenes.counts[scene]]
    free = np.all(arrivals.objects[:, :, np.newaxis] != objects, axis=1)
    is_exhausted = ~free.any(axis=1, keepdims=True)
    parents, positions = np.nonzero(np.hstack([free, is_exhausted]))
    bound = np.append(objects, NOBODY)[positions]
    return Arrivals(np.column_stack([arrivals.objects[parents], bound]), arrivals.logs[parents])


def _answer(question: Question, scenes: Scenes, arrivals: Arrivals) -> QuestionAnswer:
    """Sort sequences by a question: inside its volume, outside, or undefined."""
    values = _evaluate(question, scenes, arrivals.objects[:, list(question.variables)])
    is_defined = ~np.any(np.isnan(values), axis=1)
    distances, logs = _compare(question.volume, values)
    is_inside = is_defined & (distances <= question.volume.radius)
    is_undefined = np.logical_not(is_defined)
    return QuestionAnswer(
        (is_inside, is_defined & ~is_inside, is_undefined), np.column_stack([arrivals.logs, logs])
    )


def _evaluate(question: Question, scenes: Scenes, objects: Integers) -> Floats:
    """Return the values of the mapping function (section 4.3) for bound objects (s, arity), as (s, dim)."""
    attribute = question.mapping.attribute
    values = scenes.values[attribute.name]
    bound = np.full((*objects.shape, attribute.dim), np.nan)
    is_bound = objects != NOBODY
    bound[is_bound] = values[objects[is_bound]]
    operation = question.mapping.operation
    if operation == "identity":
        return bound[:, 0]
    if operation == "difference":
        return bound[:, 1] - bound[:, 0]
    if operation == "distance":
        gap: Floats = np.linalg.norm(bound[:, 1] - bound[:, 0], axis=1, keepdims=True)
        return gap
    axis, offset = bound[:, 1] - bound[:, 0], bound[:, 2] - bound[:, 0]
    squared = np.sum(axis**2, axis=1)
    squared[squared == 0] = np.nan
    if operation == "reframe":
        scale = np.sqrt(squared)
    elif operation == "scaled_reframe":
        scale = squared
    else:
        raise ValueError(f"the twin does not know the operation {operation!r}")
    along = axis[:, 0] * offset[:, 0] + axis[:, 1] * offset[:, 1]
    across = axis[:, 0] * offset[:, 1] - axis[:, 1] * offset[:, 0]
    return np.column_stack([along / scale, across / scale])


def _compare(volume: Volume, values: Floats) -> tuple[Floats, Floats]:
    """Return distances to the centre of the volume and log densities, both (s,)."""
    if isinstance(volume, Arc):
        offsets = values[:, 0] - volume.mean
        distances = np.abs((offsets + np.pi) % (2 * np.pi) - np.pi)
        return distances, volume.kappa * (np.cos(offsets) - 1)
    if isinstance(volume, Slab):
        return _compare(volume.interval, values[:, [volume.axis]])
    offsets = values - volume.mean
    squared = np.einsum("ij,ij->i", offsets @ np.linalg.inv(volume.covariance), offsets)
    return np.sqrt(squared), -squared * (volume.n_keys + volume.prior_weight) / 2
