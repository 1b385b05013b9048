"""The scores of the tasks with shaping rewards: mean height, and how well groups match in color.

References
----------
Palmer (2015), sections 7.4.1 and 7.4.2.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes.color import srgb_to_lab
from relforest.support.options import one_of
from relforest.worlds.blocks.color import ciede2000
from relforest.worlds.blocks.stacks import stacks
from relforest.worlds.blocks.state import BlocksState

_Floats = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class ColorDistance:
    """A way to compare colors, with the thresholds of the score."""

    coordinates: Callable[[_Floats], _Floats]  # maps RGB colors (n, 3) to the space that means are taken in
    difference: Callable[[_Floats, _Floats], _Floats]  # distances (...) between points (..., 3) of that space
    middle: float  # distance that scores 0
    most: float  # distance that scores -1, as all beyond it do


def _identity(colors: _Floats) -> _Floats:
    return colors


def _euclidean(one: _Floats, other: _Floats) -> _Floats:
    distance: _Floats = np.linalg.norm(one - other, axis=-1)
    return distance


COLOR_DISTANCES: Final[Mapping[str, ColorDistance]] = MappingProxyType(
    {
        "ciede2000": ColorDistance(srgb_to_lab, ciede2000, 30.0, 120.0),
        # The source gives no upper threshold for RGB; this is the largest distance, black to white.
        "rgb": ColorDistance(_identity, _euclidean, 0.5, math.sqrt(3.0)),
    }
)
"""Name of a color distance -> how it is computed and scored."""


def color_distance(name: str) -> ColorDistance:
    """Return the color distance of that name, or raise `InputError` with the known names."""
    return COLOR_DISTANCES[one_of("distance", name, tuple(COLOR_DISTANCES))]


def mean_height(state: BlocksState) -> float:
    """Return the mean height of the centres of the blocks above the table; 0 if there are none.

    A block that fell off the table does not count. This is an interpretation: the source does not mention it.
    """
    return float(state.poses[:, 1].mean()) if len(state) else 0.0


def grouping_score(state: BlocksState, distance: ColorDistance) -> float:
    """Return how well the blocks are grouped by color: the sum of the scores of all stacks.

    It is from ``1 - n`` to ``n - 1`` for n blocks; 0 if all are isolated.
    """
    labels = stacks(state.poses[:, 0], state.bounds)
    in_stacks = np.bincount(labels, minlength=len(state))[labels] > 1
    if not in_stacks.any():
        return 0.0
    points, apart = _palette(distance, state.colors.tobytes())
    members, labels, points = np.flatnonzero(in_stacks), labels[in_stacks], points[in_stacks]
    to_mean = distance.difference(points, _means(points, labels))
    # All stacks at once, because a difference costs about as much for one color as for ten.
    order = np.lexsort((to_mean, labels))
    is_first = np.append(True, labels[order][1:] != labels[order][:-1])
    prototypes = order[is_first][np.cumsum(is_first) - 1]
    scores = match_score(apart[members[order], members[prototypes]], distance)
    return float(scores[~is_first].sum())


# Colors stay the same during an episode.
@lru_cache(maxsize=4)
def _palette(distance: ColorDistance, colors: bytes) -> tuple[_Floats, _Floats]:
    """Return RGB colors, given as bytes, in the space of a distance (n, 3), and their distances (n, n)."""
    points = distance.coordinates(np.frombuffer(colors).reshape(-1, 3))
    return points, distance.difference(points[:, np.newaxis], points[np.newaxis])


def _means(points: _Floats, labels: NDArray[np.int64]) -> _Floats:
    """Return for each of points (m, 3) the mean of those with its label."""
    same = labels[:, np.newaxis] == labels
    means: _Floats = same @ points / same.sum(axis=1, keepdims=True)
    return means


def prototype(points: _Floats, difference: Callable[[_Floats, _Floats], _Floats]) -> int:
    """Return which of points (m, 3) is nearest to their mean, the first if several are."""
    return int(np.argmin(difference(points, points.mean(axis=0))))


def match_score(distances: _Floats, distance: ColorDistance) -> _Floats:
    """Return the scores of blocks at some distances (m,) from the prototype, from 1 (equal) to -1.

    References
    ----------
    Palmer (2015), section 7.4.2 (score_linear, and its sine).
    """
    middle, most = distance.middle, distance.most
    below, above = (middle - distances) / middle, (middle - distances) / (most - middle)
    linear = np.where(distances <= middle, below, np.maximum(-1.0, above))
    score: _Floats = np.sin(linear * (np.pi / 2.0))
    return score
