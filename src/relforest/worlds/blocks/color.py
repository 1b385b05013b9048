"""How different two colors look: the CIEDE2000 color difference.

References
----------
Sharma, Wu, and Dalal (2005), "The CIEDE2000 color-difference formula: implementation
notes, supplementary test data, and mathematical observations". Palmer (2015), section 7.4.2.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

_CHROMA_KNEE: Final = 25.0**7

_Floats = NDArray[np.float64]


def ciede2000(one: ArrayLike, other: ArrayLike) -> _Floats:
    """Return the CIEDE2000 difference of colors given as CIE Lab, with all weights 1.

    Lab coordinates are (..., 3), and their leading dimensions are broadcast.

    The difference is at least 0; 1 is about what can just be seen. It is symmetric but not a metric.

    References
    ----------
    Sharma, Wu, and Dalal (2005), eqs. 2 to 22; the names are theirs.
    """
    lab1, lab2 = np.asarray(one, dtype=np.float64), np.asarray(other, dtype=np.float64)
    L1, L2 = lab1[..., 0], lab2[..., 0]
    C1, C2, h1, h2 = _chroma_and_hue(lab1[..., 1:], lab2[..., 1:])
    product = C1 * C2
    is_grey = product == 0.0
    dh, mean_h = _hue_difference(h1, h2, is_grey), _mean_hue(h1, h2, is_grey)
    from_middle, mean_C = ((L1 + L2) / 2.0 - 50.0) ** 2, (C1 + C2) / 2.0
    T = (
        1.0
        - 0.17 * np.cos(mean_h - math.radians(30.0))
        + 0.24 * np.cos(2.0 * mean_h)
        + 0.32 * np.cos(3.0 * mean_h + math.radians(6.0))
        - 0.20 * np.cos(4.0 * mean_h - math.radians(63.0))
    )
    S_L = 1.0 + 0.015 * from_middle / np.sqrt(20.0 + from_middle)
    lightness = (L2 - L1) / S_L
    chroma = (C2 - C1) / (1.0 + 0.045 * mean_C)
    hue = 2.0 * np.sqrt(product) * np.sin(dh / 2.0) / (1.0 + 0.015 * mean_C * T)
    turn = math.radians(60.0) * np.exp(-(((np.degrees(mean_h) - 275.0) / 25.0) ** 2))
    rotation = -np.sin(turn) * 2.0 * _strength(mean_C)
    squared = lightness**2 + chroma**2 + hue**2 + rotation * chroma * hue
    # Rounding may take the difference of equal colors below 0.
    difference: _Floats = np.sqrt(np.maximum(squared, 0.0))
    return difference


def _strength(chroma: _Floats) -> _Floats:
    """Return how colorful a chroma is, from 0 for grey to 1."""
    power = chroma**7
    share: _Floats = np.sqrt(power / (power + _CHROMA_KNEE))
    return share


def _chroma_and_hue(ab1: _Floats, ab2: _Floats) -> tuple[_Floats, _Floats, _Floats, _Floats]:
    """Return the chromas C1', C2' and the hues h1', h2' in [0, 2 pi) after the correction near grey."""
    mean_C = (np.hypot(ab1[..., 0], ab1[..., 1]) + np.hypot(ab2[..., 0], ab2[..., 1])) / 2.0
    stretch = 1.5 - 0.5 * _strength(mean_C)
    a1, a2, b1, b2 = stretch * ab1[..., 0], stretch * ab2[..., 0], ab1[..., 1], ab2[..., 1]
    h1, h2 = np.arctan2(b1, a1) % (2.0 * np.pi), np.arctan2(b2, a2) % (2.0 * np.pi)
    return np.hypot(a1, b1), np.hypot(a2, b2), h1, h2


def _hue_difference(h1: _Floats, h2: _Floats, is_grey: NDArray[np.bool_]) -> _Floats:
    difference = h2 - h1
    difference = difference - 2.0 * np.pi * (difference > np.pi) + 2.0 * np.pi * (difference < -np.pi)
    return np.where(is_grey, 0.0, difference)


def _mean_hue(h1: _Floats, h2: _Floats, is_grey: NDArray[np.bool_]) -> _Floats:
    total = h1 + h2
    is_split = np.abs(h1 - h2) > np.pi
    turn = 2.0 * np.pi * np.where(total < 2.0 * np.pi, 1.0, -1.0)
    return np.where(is_grey, total, (total + turn * is_split) / 2.0)
