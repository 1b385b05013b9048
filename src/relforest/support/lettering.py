"""Lines of text on pixel images, in DejaVu Sans, the font that ships with Matplotlib."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.support.painting import Canvas, Color, Point, blend

_MOST_MASKS: Final = 4096

_MASKS: Final[dict[tuple[str, int, bool], tuple[NDArray[np.float32], int]]] = {}


def write(
    canvas: Canvas, text: str, at: Point, *, size: int, color: Color, side: float = 0.0, bold: bool = False
) -> None:
    """Write a line of text that is centred at a point, or ends (side 1) or begins (side -1) there.

    Parameters
    ----------
    canvas : (height, width, 3) uint8
        Text outside the canvas is clipped.
    text : str
    at : (float, float)
        Column and row; digits are vertically centred on this row.
    size : int
        Font size in pixels.
    color : (int, int, int)
    side : float
    bold : bool
    """
    if not text:
        return
    mask, ascent = _mask(text, size, bold=bold)
    left = round(at[0] - (1 + side) / 2 * mask.shape[1])
    # Digits of this font are 0.73 times its size high, and stand on the base line.
    top = round(at[1] + 0.365 * size) - ascent
    mask = mask[max(-top, 0) :, max(-left, 0) :]
    patch = canvas[max(top, 0) : max(top, 0) + mask.shape[0], max(left, 0) : max(left, 0) + mask.shape[1]]
    blend(patch, color, mask[: patch.shape[0], : patch.shape[1]])


def text_width(text: str, size: int, *, bold: bool = False) -> int:
    """Return the width of a line of text in pixels."""
    return _mask(text, size, bold=bold)[0].shape[1] if text else 0


def _mask(text: str, size: int, *, bold: bool) -> tuple[NDArray[np.float32], int]:
    """Return the coverage of each pixel of a line of text, and the number of rows above its base line."""
    key = (text, size, bold)
    if key not in _MASKS:
        # Matplotlib is loaded only if there is text to draw.
        from matplotlib.font_manager import FontProperties, findfont, get_font  # noqa: PLC0415

        font = get_font(findfont(FontProperties(family="DejaVu Sans", weight="bold" if bold else "normal")))
        font.set_size(size, 72)
        font.set_text(text)
        font.draw_glyphs_to_bitmap(antialiased=True)
        mask = np.asarray(font.get_image(), dtype=np.float32) / np.float32(255)
        if len(_MASKS) > _MOST_MASKS:
            _MASKS.clear()
        _MASKS[key] = mask, len(mask) - round(font.get_descent() / 64)
    return _MASKS[key]
