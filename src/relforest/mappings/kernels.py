"""Compiled evaluation of mapping functions on rows of an object matrix."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from relforest.mappings.operations import DIFFERENCE, DISTANCE, IDENTITY, REFRAME
from relforest.support.jit import inlined, kernel


@inlined
def wrap_angle(angle: float) -> float:
    """`angle` (radians) moved into [-pi, pi]."""
    return float(angle - 2.0 * math.pi * np.rint(angle / (2.0 * math.pi)))


@inlined
def map_point(
    code: int,
    circular: bool,
    span: tuple[int, int],
    matrix: NDArray[np.float64],
    objects: tuple[int, int, int],
    out: NDArray[np.float64],
    place: int,
) -> bool:
    """Write the mapping's value for one tuple of objects into ``out[place]``; False if it is undefined.

    `span` is (first column, dimension) of the attribute in `matrix` (n_rows, width); `objects` are
    row numbers, -1 for "no object", and unused places are ignored.
    """
    first, dim = span
    a, b, c = objects
    if a < 0 or (code != IDENTITY and b < 0) or (code >= REFRAME and c < 0):
        return False
    # Components are summed, so that one test at the end finds NaN.
    total = 0.0
    if code == IDENTITY:
        for i in range(dim):
            out[place, i] = matrix[a, first + i]
            total += out[place, i]
    elif code == DIFFERENCE:
        for i in range(dim):
            out[place, i] = matrix[b, first + i] - matrix[a, first + i]
            total += out[place, i]
        if circular:
            out[place, 0] = wrap_angle(out[place, 0])
    elif code == DISTANCE:
        for i in range(dim):
            step = matrix[b, first + i] - matrix[a, first + i]
            total += step * step
        out[place, 0] = math.sqrt(total)
    else:
        ux = matrix[b, first] - matrix[a, first]
        uy = matrix[b, first + 1] - matrix[a, first + 1]
        wx = matrix[c, first] - matrix[a, first]
        wy = matrix[c, first + 1] - matrix[a, first + 1]
        squared = ux * ux + uy * uy
        scale = math.sqrt(squared) if code == REFRAME else squared
        # Coincident A and B define no direction; the negated test also catches NaN.
        if not squared > 0.0:
            scale = np.nan
        out[place, 0] = (ux * wx + uy * wy) / scale
        out[place, 1] = (ux * wy - uy * wx) / scale
        total = out[place, 0] + out[place, 1]
    return not math.isnan(total)


@kernel
def map_points(
    code: int,
    circular: bool,
    span: tuple[int, int],
    matrix: NDArray[np.float64],
    rows: NDArray[np.int64],
    out: NDArray[np.float64],
) -> None:
    """Apply `map_point` to every row tuple of `rows` (n, arity); undefined points become NaN."""
    arity = rows.shape[1]
    for i in range(rows.shape[0]):
        a = rows[i, 0]
        b = rows[i, 1] if arity > 1 else -1
        c = rows[i, 2] if arity > 2 else -1
        if not map_point(code, circular, span, matrix, (a, b, c), out, i):
            out[i, :] = np.nan
