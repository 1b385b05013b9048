"""The points that each question of a tree sees in a batch of scenes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes import Scenes
from relforest.scenes.schema import misfit
from relforest.support.errors import InputError
from relforest.trees import Instantiation, Question, Tree
from relforest.trees.nodes import AnyLeaf
from relforest.trees.sequences import Sequences, argument_places, n_extensions, rows_of
from relforest.volumes import Volume

MOST_SEQUENCES: Final = 200_000


@final
@dataclass(frozen=True, slots=True, eq=False)
class QuestionPoints:
    """Points in the codomain of a mapping, with the class of their scenes.

    Parameters
    ----------
    points : (n, d) float64
    positive : (n,) bool
    """

    points: NDArray[np.float64]
    positive: NDArray[np.bool_]

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.points)

    def thinned(self, most: int, volume: Volume) -> QuestionPoints:
        """Return at most `most` points per class, evenly spaced in their order.

        For a two-dimensional volume, points inside are kept first, up to half of the number; otherwise, a
        small volume among many points would look empty. In other dimensions points are drawn as histograms,
        where every point must be equally likely to be kept.
        """
        inside = np.zeros(len(self), dtype=np.bool_)
        if volume.dim == 2:
            inside = volume.contains(self.points)
        kept = np.concatenate([_chosen(self.positive == label, inside, most) for label in (False, True)])
        kept.sort()
        return QuestionPoints(self.points[kept], self.positive[kept])


def question_points(tree: Tree, scenes: Scenes, labels: NDArray[np.bool_]) -> dict[int, QuestionPoints]:
    """Return the defined points of all instantiation sequences that reach each question.

    Parameters
    ----------
    tree : Tree
    scenes : Scenes
        Scenes with the schema of the tree.
    labels : (n_scenes,) bool
        True for positive scenes.

    Returns
    -------
    dict of int to QuestionPoints
        Points by node index. Of more than `MOST_SEQUENCES` sequences, only an evenly spaced selection is
        followed: a picture cannot show more.

    Raises
    ------
    InputError
        If the scenes have a different schema, or the number of labels is wrong.
    """
    if scenes.schema != tree.schema:
        raise InputError(misfit(tree.schema, scenes.schema))
    if labels.shape != (len(scenes),):
        raise InputError(f"expected one label per scene, got {labels.shape} for {len(scenes)} scenes")
    return {
        index: QuestionPoints(points, labels[scene])
        for index, scene, points in _visit(tree, scenes, argument_places(scenes))
    }


def _visit(
    tree: Tree, scenes: Scenes, places: NDArray[np.int64]
) -> Iterator[tuple[int, NDArray[np.int64], NDArray[np.float64]]]:
    """Yield node index, scenes (n,) and points (n, d) of the defined points at each question."""
    stack = [(0, Sequences.empty(len(scenes)))]
    while stack:
        index, sequences = stack.pop()
        node = tree.nodes[index]
        if isinstance(node, AnyLeaf):
            continue
        if isinstance(node, Instantiation):
            stack.append((node.child, _extended(sequences, scenes, places)))
            continue
        points = _points(node, scenes, sequences)
        defined = np.asarray(~np.isnan(points).any(axis=1))
        inside = np.zeros(len(points), dtype=np.bool_)
        inside[defined] = node.volume.contains(points[defined])
        stack.append((node.error, sequences.where(~defined)))
        stack.append((node.no, sequences.where(defined & ~inside)))
        stack.append((node.yes, sequences.where(inside)))
        # Sequences that differ only in variables not used by the question share one point.
        distinct = sequences.where(defined).distinct(node.variables)
        mapped = node.mapping.evaluate(scenes.schema, scenes.matrix, rows_of(scenes, distinct))
        yield index, distinct.scene, mapped


def _points(node: Question, scenes: Scenes, sequences: Sequences) -> NDArray[np.float64]:
    rows = np.ascontiguousarray(rows_of(scenes, sequences)[:, node.variables])
    return node.mapping.evaluate(scenes.schema, scenes.matrix, rows)


def _extended(sequences: Sequences, scenes: Scenes, places: NDArray[np.int64]) -> Sequences:
    arriving = n_extensions(sequences.scene, sequences.objects, scenes.counts, places, 1)
    if arriving > MOST_SEQUENCES:
        kept = np.zeros(len(sequences), dtype=np.bool_)
        share = max(int(len(sequences) * MOST_SEQUENCES / arriving), 1)
        kept[_spread(np.arange(len(sequences)), share)] = True
        sequences = sequences.where(kept)
    return sequences.extended(scenes.counts, places)


def _chosen(of_class: NDArray[np.bool_], inside: NDArray[np.bool_], most: int) -> NDArray[np.intp]:
    """Return the indices of at most `most` points of a class, up to half of them from inside first."""
    within, outside = np.flatnonzero(of_class & inside), np.flatnonzero(of_class & ~inside)
    share = max(most // 2, most - len(outside))
    chosen = _spread(within, share)
    return np.concatenate([chosen, _spread(outside, most - len(chosen))])


def _spread(indices: NDArray[np.intp], most: int) -> NDArray[np.intp]:
    """Return at most `most` of the indices, evenly spaced."""
    if len(indices) <= most:
        return indices
    return indices[np.linspace(0, len(indices) - 1, most).round().astype(np.int64)]
