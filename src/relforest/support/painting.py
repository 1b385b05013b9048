"""Soft-edged strokes, rings, boxes and trails on pixel images.

A pixel is covered according to the distance of its centre from an outline, so edges are one pixel wide.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

Canvas = NDArray[np.uint8]
Color = tuple[int, int, int]
Point = tuple[float, float]
"""Column and row, in pixels; pixel (0, 0) has its centre at (0.5, 0.5)."""

_TRAIL_STEP: Final = 3.0
_TRAIL_RADIUS: Final = 2.0
_TRAIL_STRENGTH: Final = 0.75
_REACH: Final = 3


def blend(patch: Canvas, color: Color, cover: NDArray[np.floating]) -> None:
    """Blend a colour into part of an image, with the opacity ``cover``, (rows, columns) from 0 to 1."""
    covered = cover > 0
    patch[covered] = _mixed(patch[covered], color, cover[covered])


def paint_trail(canvas: Canvas, color: Color, path: NDArray[np.float64], *, longest: float) -> None:
    """Paint a path, (t, 2) pixels, that fades towards its beginning; at most its last ``longest`` pixels.

    The canvas must be a whole image, or whole rows of one.
    """
    points, strengths = _dense(path, longest)
    _paint_dots(canvas, color, points, strengths)


def _dense(path: NDArray[np.float64], longest: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return points a few pixels apart along a path, and strengths that grow towards its end."""
    lengths = np.hypot(*np.diff(path, axis=0).T)
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    total = min(float(ends[-1]), longest)
    at = np.arange(ends[-1] - total, ends[-1], _TRAIL_STEP)
    ages = np.interp(at, ends, np.linspace(0.0, 1.0, len(path)))
    points = np.stack([np.interp(at, ends, path[:, axis]) for axis in (0, 1)], axis=1)
    return points, _TRAIL_STRENGTH * ages


def _paint_dots(
    canvas: Canvas, color: Color, points: NDArray[np.float64], strengths: NDArray[np.float64]
) -> None:
    """Paint many small dots; where dots overlap, the strongest wins."""
    height, width = canvas.shape[:2]
    inside = ((points >= _REACH + 1) & (points < (width - _REACH - 1, height - _REACH - 1))).all(axis=1)
    points, strengths = points[inside], strengths[inside]
    if not len(points):
        return
    around = np.arange(-_REACH, _REACH + 1)
    columns = points[:, 0].astype(np.int64)[:, None] + around
    rows = points[:, 1].astype(np.int64)[:, None] + around
    across = (columns + 0.5 - points[:, :1])[:, None, :]
    down = (rows + 0.5 - points[:, 1:])[:, :, None]
    covers = np.clip(_TRAIL_RADIUS + 0.5 - np.hypot(across, down), 0, 1) * strengths[:, None, None]
    places = (rows[:, :, None] * width + columns[:, None, :])[covers > 0]
    cover = covers[covers > 0].astype(np.float32)
    strongest = np.empty(height * width, dtype=np.float32)
    order = np.argsort(cover)
    # Of several values assigned to one place, the last remains.
    strongest[places[order]] = cover[order]
    pixels = canvas.reshape(-1, 3)
    pixels[places] = _mixed(pixels[places], color, strongest[places])


def paint_stroke(canvas: Canvas, color: Color, begin: Point, end: Point, radius: float) -> None:
    """Paint a line with round ends, a disc if it has no length; ``radius`` is half its thickness."""
    patch, columns, rows = _patch(canvas, begin, end, radius)
    along = (end[0] - begin[0], end[1] - begin[1])
    squared = along[0] ** 2 + along[1] ** 2
    across, down = columns - begin[0], rows - begin[1]
    if squared > 0:
        share = np.clip((across * along[0] + down * along[1]) / squared, 0, 1)
        across, down = across - share * along[0], down - share * along[1]
    blend(patch, color, np.clip(radius + 0.5 - np.hypot(across, down), 0, 1))


def paint_ring(canvas: Canvas, color: Color, center: Point, radius: float, thickness: float) -> None:
    """Paint a circle whose line extends ``thickness`` to both sides."""
    patch, columns, rows = _patch(canvas, center, center, radius + thickness)
    off = np.abs(np.hypot(columns - center[0], rows - center[1]) - radius)
    blend(patch, color, np.clip(thickness + 0.5 - off, 0, 1))


def paint_box(canvas: Canvas, color: Color, center: Point, halves: Point, angle: float) -> None:
    """Paint a box with these half sides, rotated by an angle in radians from columns towards rows."""
    along, across = math.cos(angle), math.sin(angle)
    patch, columns, rows = _patch(canvas, center, center, math.hypot(*halves))
    right, down = columns - center[0], rows - center[1]
    inside_width = halves[0] + 0.5 - np.abs(right * along + down * across)
    inside_height = halves[1] + 0.5 - np.abs(down * along - right * across)
    # A box thinner than a pixel covers no pixel completely.
    cover = np.clip(inside_width, 0, min(2 * halves[0], 1)) * np.clip(inside_height, 0, min(2 * halves[1], 1))
    blend(patch, color, cover)


def _patch(
    canvas: Canvas, begin: Point, end: Point, radius: float
) -> tuple[Canvas, NDArray[np.float32], NDArray[np.float32]]:
    """Return the part of the canvas around a line and the centres of its columns and rows."""
    lows = [max(int(min(pair) - radius) - 1, 0) for pair in zip(begin, end, strict=True)]
    highs = [int(max(pair) + radius) + 2 for pair in zip(begin, end, strict=True)]
    patch = canvas[lows[1] : max(highs[1], 0), lows[0] : max(highs[0], 0)]
    columns = np.arange(patch.shape[1], dtype=np.float32)[None, :] + (lows[0] + 0.5)
    rows = np.arange(patch.shape[0], dtype=np.float32)[:, None] + (lows[1] + 0.5)
    return patch, columns, rows


def _mixed(before: Canvas, color: Color, shares: NDArray[np.floating]) -> NDArray[np.float32]:
    """Return colours, (m, 3), blended with another one of opacity ``shares``, (m,)."""
    ground = before.astype(np.float32)
    laid = np.asarray(color, dtype=np.float32) - ground
    mixed: NDArray[np.float32] = np.rint(ground + shares.astype(np.float32)[:, None] * laid)
    return mixed
