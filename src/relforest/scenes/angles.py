"""Angles in radians on the half-open turn (-pi, pi]."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

TURN = 2.0 * np.pi


def wrap(angles: ArrayLike) -> NDArray[np.float64]:
    """Map angles (radians, any shape) to (-pi, pi]; values already there and NaN come back unchanged."""
    theta = np.asarray(angles, dtype=np.float64)
    inside = (theta > -np.pi) & (theta <= np.pi)
    if inside.all():
        return theta.copy()
    turned = theta - TURN * np.ceil((theta - np.pi) / TURN)
    # Rounding may leave a result a unit in the last place outside the interval.
    turned = np.where(turned <= -np.pi, np.pi, np.minimum(turned, np.pi))
    return np.where(inside, theta, turned)
