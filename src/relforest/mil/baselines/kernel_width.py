"""The width of a radial kernel from the distances between the training instances."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.spatial.distance import pdist

from relforest.support.errors import InputError
from relforest.support.options import in_range

if TYPE_CHECKING:
    from numpy.typing import NDArray

HEURISTIC: Final = "heuristic"
# 4.5 million distances, 36 MB.
MOST_POINTS: Final = 3000
_PERCENTILES: Final = (10, 90)


def kernel_gamma(points: NDArray[np.float64], gamma: object, factor: object) -> float:
    """Return the coefficient of squared distances in a radial kernel, exp(-gamma |x - y|^2).

    Parameters
    ----------
    points : (n, d) float64
        The training instances of all bags.
    gamma : "heuristic" or float
        A number, or "heuristic" for `heuristic_gamma`.
    factor : float
        Factor of gamma.

    Raises
    ------
    InputError
        If `gamma` or `factor` is invalid, or their product overflows or vanishes.
    """
    factor = in_range("gamma_factor", factor, 0.0, math.inf, open_low=True, open_high=True)
    if isinstance(gamma, str) and gamma != HEURISTIC:
        raise InputError(f"gamma must be {HEURISTIC!r} or a finite number above 0, got {gamma!r}")
    if isinstance(gamma, str):
        base = heuristic_gamma(points)
    else:
        base = in_range("gamma", gamma, 0.0, math.inf, open_low=True, open_high=True)
    product = base * factor
    if not 0.0 < product < math.inf:
        raise InputError(
            f"gamma {base:g} times gamma_factor {factor:g} is too large or too small for a floating point "
            "number: scale the features or choose another factor"
        )
    return product


def heuristic_gamma(points: NDArray[np.float64]) -> float:
    """Return 1 / (2 s^2), with s the mean of the 10th and 90th percentile of the distances between points.

    Parameters
    ----------
    points : (n, d) float64
        The training instances of all bags, at least two.

    Notes
    -----
    Of more than 3000 points, 3000 are used: they are sorted and selected at equal steps, so that the result
    depends neither on chance nor on the order of bags. If both percentiles are 0, since most points coincide,
    s is the mean distance. If all points coincide, any width is equally good and gamma is 1.

    References
    ----------
    Palmer (2015), section 3.3; Takeuchi, Le, Sears and Smola (2006), Nonparametric quantile estimation.
    """
    if len(points) > MOST_POINTS:
        rows = np.linspace(0, len(points) - 1, MOST_POINTS).round().astype(np.int64)
        points = points[np.lexsort(points.T[::-1])[rows]]
    distances = pdist(points)
    mean = float(distances.mean())
    sigma = float(np.percentile(distances, _PERCENTILES, overwrite_input=True).mean()) or mean
    if sigma == 0.0:
        return 1.0
    # Divide first, since the square of a tiny distance would underflow.
    with np.errstate(over="ignore"):
        return float(0.5 * np.square(np.float64(1.0) / sigma))
