"""Regression trees as arrays, the form that kernels read and files keep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from relforest.scenes.arrays import FloatArray, IntArray
from relforest.support.documents import LARGEST_NUMBER
from relforest.support.errors import ModelFormatError
from relforest.support.jit import kernel

_NONE: Final = -1


class ForestArrays(NamedTuple):
    """Trees end to end: a forest for each number of remaining actions and each action type."""

    feature: IntArray  # (n_nodes,): what a node compares, -1 for a leaf
    threshold: FloatArray  # (n_nodes,): the first child is for features of at most this
    children: IntArray  # (n_nodes, 2): later nodes
    value: FloatArray  # (n_nodes,): of a leaf; of other nodes, the mean of what is below
    roots: IntArray  # (n_remaining, n_types, n_trees): -1 where nothing was learned


def joined(grown: Sequence[Sequence[Sequence[Any]]]) -> ForestArrays:
    """Lay forests of scikit-learn's trees end to end: for each number of actions, and each action type."""
    n_trees = max((len(trees) for own in grown for trees in own), default=0)
    roots = np.full((len(grown), len(grown[0]) if grown else 0, n_trees), _NONE)
    parts: list[tuple[NDArray[Any], ...]] = [
        (np.empty(0, np.int64), np.empty(0), np.empty((0, 2), np.int64), np.empty(0))
    ]
    begin = 0
    for i, own in enumerate(grown):
        for j, trees in enumerate(own):
            for k, tree in enumerate(trees):
                roots[i, j, k] = begin
                is_leaf = tree.children_left < 0
                children = np.column_stack([tree.children_left, tree.children_right]) + begin
                feature = np.where(is_leaf, _NONE, tree.feature)
                children[is_leaf] = _NONE
                parts.append((feature, tree.threshold, children, tree.value[:, 0, 0]))
                begin += tree.node_count
    feature, threshold, children, value = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    return ForestArrays(feature, threshold, children, value, roots)


def forest_mean(forests: ForestArrays, roots: IntArray, features: NDArray[np.float32]) -> FloatArray:
    """Return the mean of the trees with these roots, (n,), for features (n, k); 0 if there are none."""
    out = np.empty(len(features))
    _add_up(forests, roots, features, out)
    return out


def path_parts(forests: ForestArrays, roots: IntArray, features: NDArray[np.float32]) -> FloatArray:
    """Return the parts of `forest_mean`, (n, 1 + k): the mean at the roots, then what each feature adds.

    A comparison adds the mean below it less the mean before it.

    References
    ----------
    Saabas, Interpreting random forests (2014).
    """
    out = np.zeros((len(features), 1 + features.shape[1]))
    _add_steps(forests, roots, features, out)
    return out


def forests_of(arrays: Mapping[str, NDArray[Any]], widths: Sequence[int], *, origin: str) -> ForestArrays:
    """Return forests from the columns of a file, after checks that every tree ends.

    Parameters
    ----------
    arrays : mapping
        The fields of `ForestArrays` by name.
    widths : sequence of int
        How many features actions of each type have.
    origin : str
        Named in errors.

    Raises
    ------
    ModelFormatError
        If the arrays do not form trees of these features.
    """
    try:
        feature, children, roots = (
            np.asarray(arrays[name]).astype(np.int64, casting="same_kind", copy=False)
            for name in ("feature", "children", "roots")
        )
        threshold, value = (
            np.asarray(arrays[name]).astype(np.float64, casting="same_kind", copy=False)
            for name in ("threshold", "value")
        )
    except TypeError as error:
        raise ModelFormatError(f"{origin}: the arrays of its forests have wrong types") from error
    n = len(feature)
    shapes = (feature.shape, threshold.shape, children.shape, value.shape, roots.shape[1:2])
    if shapes != ((n,), (n,), (n, 2), (n,), (len(widths),)) or roots.ndim != 3:
        raise ModelFormatError(f"{origin}: the arrays of its forests have wrong shapes")
    inner = np.flatnonzero(feature >= 0)
    # Children come later than their parent, so no path returns.
    if (children[inner] <= inner[:, None]).any() or (children >= n).any() or feature.min(initial=-1) < _NONE:
        raise ModelFormatError(f"{origin}: its trees are damaged")
    if not (np.abs(value) <= LARGEST_NUMBER).all() or np.isnan(threshold).any():
        raise ModelFormatError(f"{origin}: its trees contain numbers that are not finite")
    if roots.min(initial=_NONE) < _NONE or roots.max(initial=_NONE) >= n:
        raise ModelFormatError(f"{origin}: its roots are no nodes")
    forests = ForestArrays(feature, threshold, children, value, roots)
    limit = np.empty(n, dtype=np.int64)
    _widths(forests, np.array(widths, dtype=np.int64), limit)
    if (feature >= limit).any():
        raise ModelFormatError(f"{origin}: its trees compare features that there are not")
    return forests


@kernel
def _widths(forests: ForestArrays, widths: IntArray, out: IntArray) -> None:
    """Write how many features there are for each node: as many as for the root of its tree."""
    out[:] = widths.min() if len(widths) else 0
    for i in range(forests.roots.shape[0]):
        for j in range(forests.roots.shape[1]):
            for root in forests.roots[i, j]:
                if root >= 0:
                    out[root] = widths[j]
    for node in range(len(forests.feature)):
        if forests.feature[node] >= 0:
            for child in forests.children[node]:
                out[child] = out[node]


@kernel
def _add_up(forests: ForestArrays, roots: IntArray, features: NDArray[np.float32], out: FloatArray) -> None:
    for i in range(len(features)):
        total = 0.0
        for root in roots:
            if root >= 0:
                node = root
                while forests.feature[node] >= 0:
                    is_first = features[i, forests.feature[node]] <= forests.threshold[node]
                    node = forests.children[node, 0 if is_first else 1]
                total += forests.value[node] / len(roots)
        out[i] = total


@kernel
def _add_steps(
    forests: ForestArrays, roots: IntArray, features: NDArray[np.float32], out: FloatArray
) -> None:
    for i in range(len(features)):
        for root in roots:
            if root < 0:
                continue
            out[i, 0] += forests.value[root] / len(roots)
            node = root
            while forests.feature[node] >= 0:
                feature = forests.feature[node]
                child = forests.children[node, 0 if features[i, feature] <= forests.threshold[node] else 1]
                out[i, 1 + feature] += (forests.value[child] - forests.value[node]) / len(roots)
                node = child
