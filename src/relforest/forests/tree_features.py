"""What a SMRF tree says about scenes as numbers (Palmer (2015), section 6.4).

Letters: n scenes, k columns.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from relforest.trees import Instantiation, Question
from relforest.trees.nodes import children
from relforest.trees.sequences import Sequences, argument_places, rows_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from relforest.scenes import Scenes
    from relforest.scenes.arrays import FloatArray
    from relforest.trees import Answers, Tree

LeafMode = Literal["densities+bits", "bits"]
TreeMode = Literal["densities+bits", "bits", "probability"]

# Instantiation sequences looked at together.
_MOST_SEQUENCES: Final = 1_000_000


def leaf_widths(tree: Tree, mode: LeafMode) -> tuple[int, ...]:
    """Return the number of columns of each leaf: a bit and, with densities, one per question above it."""
    if mode == "bits":
        return (1,) * tree.n_leaves
    return tuple(1 + len(above) for above in tree.questions_above)


def width(tree: Tree, mode: TreeMode) -> int:
    """Return the number of columns that a tree contributes."""
    return 1 if mode == "probability" else sum(leaf_widths(tree, mode))


def tree_features(tree: Tree, answers: Answers, mode: TreeMode) -> FloatArray:
    """Return the features of n scenes, shape (n, k).

    Parameters
    ----------
    tree : Tree
    answers : Answers
        The answers of the tree for the scenes.
    mode : {"densities+bits", "bits", "probability"}
        - ``"densities+bits"``: for each leaf in order its bit (1 if it decides the scene), then the density
          at each question above it, root first, for the most representative instantiation sequence. Leaves
          that do not decide the scene, and questions answered with Error, contribute 0.
        - ``"bits"``: the bits alone.
        - ``"probability"``: one column, the probability of the deciding leaf, or its mean (Palmer (2015),
          section 5.2.3).

    References
    ----------
    Palmer (2015), section 6.4. A density is taken relative to its peak: the source
    leaves the scale open, and a constant factor changes only the weight.
    """
    if mode == "probability":
        predictions: FloatArray = tree.leaf_predictions[answers.leaf][:, None]
        return predictions
    features = np.zeros((len(answers.leaf), width(tree, mode)))
    start = 0
    for leaf, columns in enumerate(leaf_widths(tree, mode)):
        own = np.flatnonzero(answers.leaf == leaf)
        features[own, start] = 1.0
        features[own, start + 1 : start + columns] = answers.densities[own, : columns - 1]
        start += columns
    return features


def question_measures(tree: Tree, scenes: Scenes) -> tuple[FloatArray, FloatArray]:
    """Return margins and counts of all questions, two arrays (n, n_questions) in the order of the nodes.

    Parameters
    ----------
    tree : Tree
    scenes : Scenes
        n scenes of its schema. Time grows exponentially with the number of variables.

    Returns
    -------
    margins : ndarray
        The least distance from the volume's mean of any instantiation sequence that meets the question, less
        the volume's radius: at most 0 if one is answered Yes; NaN if the point of none is defined.
    counts : ndarray
        How many sequences are answered Yes.
    """
    parts = [_measured(tree, part) for part in _parts(tree, scenes)]
    n_questions = sum(isinstance(node, Question) for node in tree.nodes)
    empty = np.empty((0, n_questions))
    margins, counts = zip(*parts, strict=True) if parts else ((empty,), (empty,))
    return np.concatenate(margins), np.concatenate(counts)


def _parts(tree: Tree, scenes: Scenes) -> Iterator[Scenes]:
    """Yield successive scenes with not too many sequences in all; a single one may have more."""
    n_free = max(tree.n_variables - tree.schema.n_parameters, 0)
    upto = np.cumsum(np.maximum(scenes.counts, 1.0) ** n_free)
    begin = 0
    while begin < len(scenes):
        before = upto[begin - 1] if begin else 0.0
        end = max(int(np.searchsorted(upto, before + _MOST_SEQUENCES, side="right")), begin + 1)
        yield scenes.take(np.arange(begin, end))
        begin = end


def _measured(tree: Tree, scenes: Scenes) -> tuple[FloatArray, FloatArray]:
    places, n = argument_places(scenes), len(scenes)
    arriving: dict[int, Sequences] = {0: Sequences.empty(n)}
    margins, counts = [np.empty((n, 0))], [np.empty((n, 0))]
    for index, node in enumerate(tree.nodes):
        sequences = arriving.pop(index)
        if isinstance(node, Instantiation):
            arriving[node.child] = sequences.extended(scenes.counts, places)
        elif isinstance(node, Question):
            rows = np.ascontiguousarray(rows_of(scenes, sequences)[:, node.variables])
            points = node.mapping.evaluate(scenes.schema, scenes.matrix, rows)
            undefined: NDArray[np.bool_] = np.asarray(np.isnan(points).any(axis=1))
            margin = np.full(len(sequences), np.inf)
            margin[~undefined] = node.volume.distance(points[~undefined]) - node.volume.radius
            least = np.full(n, np.inf)
            np.minimum.at(least, sequences.scene, margin)
            margins.append(np.where(np.isinf(least), np.nan, least)[:, None])
            yes = margin <= 0.0
            counts.append(np.bincount(sequences.scene[yes], minlength=n)[:, None].astype(np.float64))
            for child, kept in zip(children(node), (yes, ~(yes | undefined), undefined), strict=True):
                arriving[child] = sequences.where(kept)
    return np.hstack(margins), np.hstack(counts)
