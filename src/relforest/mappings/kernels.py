"""Compiled evaluation of mapping functions on rows of an object matrix."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from relforest.mappings.operations import (
    BEARING,
    DIFFERENCE,
    DISTANCE,
    IDENTITY,
    REFRAME,
    SAME,
    SCALED_DISTANCE,
)
from relforest.support.jit import hold, inlined, kernel


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
    # Components are summed, so that one test at the end finds NaN.
    total = 0.0
    if a < 0 or (code != IDENTITY and b < 0) or (REFRAME <= code <= BEARING and c < 0):
        total = np.nan
    elif code == IDENTITY:
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
    elif code == SAME:
        total = matrix[b, first] - matrix[a, first]
        out[place, 0] = 1.0 if total == 0.0 else 0.0
    else:
        total = _seen_from_frame(code, span, matrix, objects, out, place)
    hold(matrix, out)
    return not math.isnan(total)


@inlined
def _seen_from_frame(
    code: int,
    span: tuple[int, int],
    matrix: NDArray[np.float64],
    objects: tuple[int, int, int],
    out: NDArray[np.float64],
    place: int,
) -> float:
    """Write what C is in the frame of A and B into ``out[place]``; return a number, NaN if undefined."""
    first, dim = span
    a, b, c = objects
    squared, reach = 0.0, 0.0
    for i in range(dim):
        squared += (matrix[b, first + i] - matrix[a, first + i]) ** 2
        reach += (matrix[c, first + i] - matrix[a, first + i]) ** 2
    # Coincident A and B define no direction; the test also fails for NaN.
    total = np.nan
    if squared > 0.0 and code == SCALED_DISTANCE:
        total = math.sqrt(reach / squared)
        out[place, 0] = total
    elif squared > 0.0:
        ux = matrix[b, first] - matrix[a, first]
        uy = matrix[b, first + 1] - matrix[a, first + 1]
        wx = matrix[c, first] - matrix[a, first]
        wy = matrix[c, first + 1] - matrix[a, first + 1]
        scale = math.sqrt(squared) if code == REFRAME else squared
        along, aside = (ux * wx + uy * wy) / scale, (ux * wy - uy * wx) / scale
        if code == BEARING:
            out[place, 0] = math.atan2(abs(aside), along)
            total = along + aside if reach > 0.0 else np.nan
        else:
            out[place, 0], out[place, 1] = along, aside
            total = along + aside
    hold(matrix, out)
    return total


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
