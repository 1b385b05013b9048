"""Which bounds of a decision volume the training points needed, for sentences without the others."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, final

import numpy as np

from relforest.volumes import Arc, Slab

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.volumes import Ellipsoid, Volume

# More bounds than this are no easier to read than the volume.
_MOST: Final = 3


@final
@dataclass(frozen=True, slots=True)
class Bounds:
    """An interval of one coordinate; an end that is infinite says nothing."""

    axis: int  # the coordinate, from 0
    low: float
    high: float
    """In the units of the mapping, rounded as they should be said."""


def needed_bounds(volume: Volume, points: NDArray[np.float64]) -> tuple[Bounds, ...]:
    """Return bounds of coordinates that divide the points like the volume, if a part of it divides none.

    The points (n, d) are those that a question was asked about when it was learned.

    There are at most three ends in all and fewer than the volume has, by coordinate; none if there are no
    such bounds: then the whole volume counts. So it does on the circle, where both ends bound the same gap.
    """
    if isinstance(volume, Arc):
        return ()
    inside = volume.contains(points)
    if inside.all() or not inside.any():
        return ()
    kept, cut = points[inside], points[~inside]
    axes = np.array([volume.axis]) if isinstance(volume, Slab) else np.arange(volume.dim)
    # Every lower end as an upper end of the negative coordinate.
    kept, cut = (np.hstack([-rows[:, axes], rows[:, axes]]) for rows in (kept, cut))
    beyond = cut > kept.max(axis=0)
    chosen = _fewest(beyond)
    if not 0 < len(chosen) < 2 * len(axes):
        return ()
    ends = _box(volume)[:, axes].ravel()
    low, high = np.full(volume.dim, -np.inf), np.full(volume.dim, np.inf)
    for column in chosen:
        others = [other for other in chosen if other != column]
        nearest = cut[~beyond[:, others].any(axis=1), column].min()
        farthest, end = kept[:, column].max(), ends[column]
        end = _rounded(end if end < nearest else (farthest + nearest) / 2, farthest, nearest)
        axis = axes[column % len(axes)]
        if column < len(axes):
            low[axis] = -end
        else:
            high[axis] = end
    used = np.flatnonzero((low > -np.inf) | (high < np.inf))
    return tuple(Bounds(int(axis), float(low[axis]), float(high[axis])) for axis in used)


def _fewest(beyond: NDArray[np.bool_]) -> list[int]:
    """Return few columns of which every row (n, k) has one; empty if it takes too many."""
    chosen: list[int] = []
    left = beyond
    while len(left):
        best = int(left.sum(axis=0).argmax())
        if len(chosen) == _MOST or not left[:, best].any():
            return []
        chosen.append(best)
        left = left[~left[:, best]]
    for column in chosen[:]:
        others = [other for other in chosen if other != column]
        if beyond[:, others].any(axis=1).all():
            chosen = others
    return chosen


def _rounded(value: float, low: float, high: float) -> float:
    """Return `value` with three digits, or as many as it takes to stay from `low` to below `high`."""
    for digits in range(3, 17):
        short = float(f"{value:.{digits}g}")
        if low <= short < high:
            return short
    return value


def _box(volume: Ellipsoid | Slab) -> NDArray[np.float64]:
    """Return minus the lower and the upper end of each coordinate of a volume, (2, d)."""
    interval = volume.interval if isinstance(volume, Slab) else volume
    half = interval.radius * np.sqrt(np.diag(interval.covariance))
    return np.vstack([half - volume.mean, half + volume.mean])
