"""Compiled checks of scenes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from relforest.support.jit import kernel


@kernel
def first_misfit(
    rows: NDArray[np.int64],
    starts: NDArray[np.int64],
    counts: NDArray[np.int64],
    arguments: NDArray[np.int64],
    last_scene: NDArray[np.int64],
) -> tuple[int, int]:
    """Find the first scene that contains an object row twice or binds an argument to a row it lacks.

    Returns the scene and the row, or (-1, -1). `last_scene` (n_rows,) is work space, all -1.
    """
    for scene in range(len(starts)):
        for row in rows[starts[scene] : starts[scene] + counts[scene]]:
            if last_scene[row] == scene:
                return scene, row
            last_scene[row] = scene
        for row in arguments[scene]:
            if row >= 0 and last_scene[row] != scene:
                return scene, row
    return -1, -1
