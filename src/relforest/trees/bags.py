"""The points of a question, scene by scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from relforest.mappings.kernels import map_point
from relforest.support.jit import kernel
from relforest.trees.kernels import row_at

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
        return _differ(self.points, self.starts)


def bags_of(scenes: Scenes, asked: Sequences, mapping: Mapping) -> Bags:
    """Map tuples of objects, as many in each as the mapping takes."""
    span = (scenes.schema.offset(mapping.attribute.name), mapping.attribute.dim)
    rule = (mapping.rule.code, mapping.space == "circle", mapping.dim)
    return _map((scenes.rows, scenes.starts, scenes.matrix), (asked.scene, asked.objects), rule, span)


@kernel
def _map(
    scenes: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]],
    asked: tuple[NDArray[np.int64], NDArray[np.int64]],
    rule: tuple[int, bool, int],
    span: tuple[int, int],
) -> Bags:
    object_rows, scene_starts, matrix = scenes
    scene, objects = asked
    operation, circular, dim = rule
    n, arity = objects.shape
    points = np.empty((n, dim))
    starts = np.empty(n + 1, dtype=np.int64)
    bag_scenes = np.empty(n, dtype=np.int64)
    n_points, n_bags = 0, 0
    for i in range(n):
        begin = scene_starts[scene[i]]
        found = (
            row_at(object_rows, begin, objects[i, 0]),
            row_at(object_rows, begin, objects[i, 1]) if arity > 1 else -1,
            row_at(object_rows, begin, objects[i, 2]) if arity > 2 else -1,
        )
        if not map_point(operation, circular, span, matrix, found, points, n_points):
            continue
        total = 0.0
        for j in range(dim):
            total += abs(points[n_points, j])
        if total == np.inf:  # an overflow is no point either
            continue
        if n_bags == 0 or bag_scenes[n_bags - 1] != scene[i]:
            bag_scenes[n_bags], starts[n_bags] = scene[i], n_points
            n_bags += 1
        n_points += 1
    starts[n_bags] = n_points
    return Bags(points[:n_points].copy(), starts[: n_bags + 1].copy(), bag_scenes[:n_bags].copy())


@kernel
def _differ(points: NDArray[np.float64], starts: NDArray[np.int64]) -> bool:
    for bag in range(1, len(starts) - 1):
        first, other = points[: starts[1]], points[starts[bag] : starts[bag + 1]]
        if not (_within(other, first) and _within(first, other)):
            return True
    return False


@kernel
def _within(some: NDArray[np.float64], others: NDArray[np.float64]) -> bool:
    """Whether every row of `some` is a row of `others`."""
    for i in range(len(some)):
        found = False
        for j in range(len(others)):
            equal = True
            for k in range(some.shape[1]):
                equal &= some[i, k] == others[j, k]
            found |= equal
            if found:
                break
        if not found:
            return False
    return True
