"""Colors as they look: sRGB to CIE Lab, in which distances are about what people see.

References
----------
IEC 61966-2-1 (sRGB). CIE 15 (Lab). Palmer (2015), section 7.4.2.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from relforest.scenes.arrays import FloatArray

_XYZ_OF_RGB: Final = np.array(
    [[0.412453, 0.357580, 0.180423], [0.212671, 0.715160, 0.072169], [0.019334, 0.119193, 0.950227]]
)
# Daylight D65 seen by the 2 degree observer.
_WHITE: Final = np.array([0.95047, 1.0, 1.08883])


def srgb_to_lab(colors: ArrayLike) -> FloatArray:
    """Return the CIE Lab coordinates of sRGB colors under daylight (D65, 2 degree observer).

    Parameters
    ----------
    colors : (..., 3) array
        Red, green and blue from 0 to 1, with the transfer curve of sRGB, as pictures hold them.

    Returns
    -------
    (..., 3) float64
        L from 0 to 100, a and b about -128 to 128.
    """
    rgb = np.asarray(colors, dtype=np.float64)
    linear = np.where(rgb > 0.04045, ((rgb + 0.055) / 1.055) ** 2.4, rgb / 12.92)
    relative = linear @ _XYZ_OF_RGB.T / _WHITE
    f = np.where(relative > (6 / 29) ** 3, np.cbrt(relative), relative * (29 / 6) ** 2 / 3 + 4 / 29)
    x, y, z = f[..., 0], f[..., 1], f[..., 2]
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], axis=-1)
