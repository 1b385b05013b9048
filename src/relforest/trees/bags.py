"""The points of a question, scene by scene."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from relforest.trees.sequences import rows_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.mappings import Mapping
    from relforest.scenes import Scenes
    from relforest.trees.sequences import Sequences


class Bags(NamedTuple):
    """The points that a mapping gives for tuples of objects: a bag per scene."""

    points: NDArray[np.float64]  # (n_points, d) those that are defined, grouped by scene
    starts: NDArray[np.int64]  # (n_bags + 1,) where each scene's points begin
    scenes: NDArray[np.int64]  # (n_bags,) the scenes with at least one point

    @property
    def differ(self) -> bool:
        """Whether a volume can hold a point of one bag and none of another: whether their sets differ."""
        bags = pairwise(self.starts.tolist())
        sets = (set(map(tuple, self.points[begin:end].tolist())) for begin, end in bags)
        first = next(sets, set())
        return any(other != first for other in sets)


def bags_of(scenes: Scenes, asked: Sequences, mapping: Mapping) -> Bags:
    """Map tuples of objects, as many in each as the mapping takes."""
    points = mapping.evaluate(scenes.schema, scenes.matrix, rows_of(scenes, asked))
    # An overflow is no point either.
    defined = np.isfinite(points).all(axis=1)
    scene = asked.scene[defined]
    first = np.flatnonzero(np.diff(scene, prepend=-1))
    return Bags(points[defined], np.append(first, len(scene)), scene[first])
