"""Regression trees as arrays, the form that kernels read and files keep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from sklearn.ensemble import ExtraTreesRegressor

from relforest.rl.fitted.settings import ForestSettings
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.support.documents import LARGEST_NUMBER
from relforest.support.errors import ModelFormatError
from relforest.support.jit import kernel

NONE: Final = -1
LEAST_EXAMPLES: Final = 8
"""From fewer transitions, no trees are learned."""


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
    roots = np.full((len(grown), len(grown[0]) if grown else 0, n_trees), NONE)
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
                feature = np.where(is_leaf, NONE, tree.feature)
                children[is_leaf] = NONE
                parts.append((feature, tree.threshold, children, tree.value[:, 0, 0]))
                begin += tree.node_count
    feature, threshold, children, value = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    return ForestArrays(feature, threshold, children, value, roots)


def together(first: ForestArrays, second: ForestArrays) -> ForestArrays:
    """Return forests of the same features as one: those of the second after those of the first."""
    begin = len(first.feature)
    children, roots = (np.where(each < 0, NONE, each + begin) for each in (second.children, second.roots))
    return ForestArrays(
        np.concatenate([first.feature, second.feature]),
        np.concatenate([first.threshold, second.threshold]),
        np.concatenate([first.children, children]),
        np.concatenate([first.value, second.value]),
        np.concatenate([first.roots, roots], axis=2),
    )


def pruned(forests: ForestArrays, places: Sequence[IntArray]) -> ForestArrays:
    """Return forests of fewer features: a comparison of one that is left out becomes a leaf.

    Parameters
    ----------
    forests : ForestArrays
    places : sequence of (k,) int64
        For each action type, the place that each feature will have, -1 if it is left out.
    """
    types = np.empty(len(forests.feature), dtype=np.int64)
    _find_types(forests, types)
    inner = np.flatnonzero((forests.feature >= 0) & (types >= 0))
    first = np.cumsum([0, *map(len, places)])
    feature = forests.feature.copy()
    feature[inner] = np.concatenate(places)[first[types[inner]] + feature[inner]]
    return forests._replace(feature=feature)


def randomised(
    settings: ForestSettings, share: float, rng: np.random.Generator, n_jobs: int = 1
) -> ExtraTreesRegressor:
    """Return randomised trees, not yet grown, that compare this share of the features at a node."""
    return ExtraTreesRegressor(
        settings.trees,
        min_samples_leaf=settings.min_leaf,
        max_features=share,
        n_jobs=n_jobs,
        random_state=int(rng.integers(2**31)),
    )


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
    if (children[inner] <= inner[:, None]).any() or (children >= n).any() or feature.min(initial=-1) < NONE:
        raise ModelFormatError(f"{origin}: its trees are damaged")
    if not (np.abs(value) <= LARGEST_NUMBER).all() or np.isnan(threshold).any():
        raise ModelFormatError(f"{origin}: its trees contain numbers that are not finite")
    if roots.min(initial=NONE) < NONE or roots.max(initial=NONE) >= n:
        raise ModelFormatError(f"{origin}: its roots are no nodes")
    forests = ForestArrays(feature, threshold, children, value, roots)
    types = np.empty(n, dtype=np.int64)
    if not _find_types(forests, types):
        raise ModelFormatError(f"{origin}: its trees are damaged")
    limit = np.array([*widths, n], dtype=np.int64)[types]
    if (feature[types >= 0] >= limit[types >= 0]).any():
        raise ModelFormatError(f"{origin}: its trees compare features that there are not")
    return forests


@kernel
def _find_types(forests: ForestArrays, out: IntArray) -> bool:
    """Write the action type whose trees contain each node, -1 if none do; False if two types share a node."""
    out[:] = NONE
    for i in range(forests.roots.shape[0]):
        for j in range(forests.roots.shape[1]):
            for root in forests.roots[i, j]:
                if root >= 0:
                    if out[root] not in (NONE, j):
                        return False
                    out[root] = j
    for node in range(len(forests.feature)):
        if forests.feature[node] >= 0 and out[node] >= 0:
            for child in forests.children[node]:
                if out[child] not in (NONE, out[node]):
                    return False
                out[child] = out[node]
    return True


@kernel
def _add_up(forests: ForestArrays, roots: IntArray, features: NDArray[np.float32], out: FloatArray) -> None:
    n_trees = max(1, (roots >= 0).sum())
    out[:] = 0.0
    # Tree by tree, because one of them fits into the fast memory near the processor.
    for root in roots:
        if root < 0:
            continue
        for i in range(len(features)):
            node = root
            while forests.feature[node] >= 0:
                is_first = features[i, forests.feature[node]] <= forests.threshold[node]
                node = forests.children[node, 0 if is_first else 1]
            out[i] += forests.value[node] / n_trees


@kernel
def _add_steps(
    forests: ForestArrays, roots: IntArray, features: NDArray[np.float32], out: FloatArray
) -> None:
    n_trees = max(1, (roots >= 0).sum())
    for i in range(len(features)):
        for root in roots:
            if root < 0:
                continue
            out[i, 0] += forests.value[root] / n_trees
            node = root
            while forests.feature[node] >= 0:
                feature = forests.feature[node]
                child = forests.children[node, 0 if features[i, feature] <= forests.threshold[node] else 1]
                out[i, 1 + feature] += (forests.value[child] - forests.value[node]) / n_trees
                node = child
