"""Squared distances between all points of two sets, by one matrix product."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def squared_distances(points: NDArray[np.float64], centres: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the squared distance of every point from every centre.

    Parameters
    ----------
    points : (n, d) float64
    centres : (k, d) float64

    Returns
    -------
    (n, k) float64
        At least 0, in spite of rounding.

    Notes
    -----
    Computed as |x|^2 + |c|^2 - 2 x.c, which is fast and exact to a few units in the last place of the largest
    |x|^2; centre the points first.
    """
    values = points @ centres.T
    values *= -2.0
    values += np.einsum("ij,ij->i", points, points)[:, np.newaxis]
    values += np.einsum("ij,ij->i", centres, centres)
    return np.maximum(values, 0.0, out=values)
