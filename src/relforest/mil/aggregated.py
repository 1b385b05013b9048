"""The ellipsoid aggregated from bags of both classes, which always exists."""

from __future__ import annotations

from typing import TYPE_CHECKING

from relforest.volumes import CovAggSettings, Ellipsoid, aggregate

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["aggregated_ellipsoid"]


def aggregated_ellipsoid(
    points: NDArray[np.float64],
    starts: NDArray[np.int64],
    positive: NDArray[np.bool_],
    *,
    rng: np.random.Generator,
    settings: CovAggSettings,
) -> Ellipsoid:
    """Return the best ellipsoid of `relforest.volumes.aggregate`; both values occur in `positive` (n_bags,).

    Raises
    ------
    AssertionError
        If none is found, which would be a bug in this library.
    """
    found = aggregate(points, starts, positive, rng=rng, settings=settings)
    if found is None or not isinstance(found.volume, Ellipsoid):
        msg = "no volume was found although both classes are present; please report this"
        raise AssertionError(msg)
    return found.volume
