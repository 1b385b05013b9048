"""The volume aggregated from bags of both classes, which always exists."""

from __future__ import annotations

from typing import TYPE_CHECKING

from relforest.volumes import Arc, CovAggSettings, Ellipsoid, Slab, aggregate

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["aggregated_volume"]


def aggregated_volume(
    points: NDArray[np.float64],
    starts: NDArray[np.int64],
    positive: NDArray[np.bool_],
    *,
    rng: np.random.Generator,
    settings: CovAggSettings,
) -> Ellipsoid | Slab:
    """Return the best volume of `relforest.volumes.aggregate`; both values occur in `positive` (n_bags,).

    Raises
    ------
    AssertionError
        If none is found, which would be a bug in this library.
    """
    found = aggregate(points, starts, positive, rng=rng, settings=settings)
    if found is None or isinstance(found.volume, Arc):
        msg = "no volume was found although both classes are present; please report this"
        raise AssertionError(msg)
    return found.volume
