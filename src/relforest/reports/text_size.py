"""The size of text, computed before drawing."""

from __future__ import annotations

from bisect import bisect_right
from functools import cache, lru_cache
from typing import Final, Literal

from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.textpath import text_to_path

Weight = Literal["normal", "bold"]

LINE_SPACING: Final = 1.25
_POINTS_PER_INCH: Final = 72.0
_FAMILY: Final = "DejaVu Sans"
_UNKNOWN: Final = "\N{REPLACEMENT CHARACTER}"
_LONGEST: Final = 1500


@lru_cache(maxsize=4096)
def text_width(text: str, size: float, weight: Weight = "normal") -> float:
    """Return the width in inches of one line of text, `size` points high."""
    font = FontProperties(family=_FAMILY, weight=weight, size=size)
    width, _, _ = text_to_path.get_text_width_height_descent(text, font, ismath=False)
    return float(width) / _POINTS_PER_INCH


def line_height(size: float) -> float:
    """Return the distance in inches from one line of text to the next."""
    return LINE_SPACING * size / _POINTS_PER_INCH


def drawable(text: str) -> str:
    """Return text with every character that is not in the font, such as a line break, replaced by a mark."""
    known = _characters()
    return "".join(letter if ord(letter) in known else _UNKNOWN for letter in text)


def wrapped(text: str, width: float, size: float) -> list[str]:
    """Break text into drawable lines of at most `width` inches; longer words are broken too.

    Very long text is cut, with an ellipsis at the end.
    """
    text = drawable(" ".join(text.split()))
    if len(text) > _LONGEST:
        text = f"{text[:_LONGEST]}…"
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if text_width(longer, size) <= width:
            lines[-1] = longer
            continue
        pieces = _pieces(word, width, size)
        lines += pieces if lines[-1] else []
        if not lines[0]:
            lines = pieces
    return lines


def shortened(text: str, width: float, size: float, weight: Weight = "normal") -> str:
    """Return drawable text that fits into `width` inches, cut and ended by an ellipsis if necessary."""
    text = drawable(text[:_LONGEST])
    if text_width(text, size, weight) <= width:
        return text
    kept = bisect_right(
        range(len(text)), width, key=lambda count: text_width(f"{text[:count]}…", size, weight)
    )
    return f"{text[: max(kept - 1, 0)].rstrip()}…"


@cache
def _characters() -> frozenset[int]:
    """Return the code points in the font."""
    return frozenset(get_font(findfont(FontProperties(family=_FAMILY))).get_charmap())


def _pieces(word: str, width: float, size: float) -> list[str]:
    pieces = [""]
    for letter in word:
        if pieces[-1] and text_width(pieces[-1] + letter, size) > width:
            pieces.append("")
        pieces[-1] += letter
    return pieces
