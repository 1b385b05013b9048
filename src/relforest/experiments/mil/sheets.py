"""A table of results as text and as Markdown, and numbers as its cells."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, final

from relforest.experiments.mil.published import Published
from relforest.experiments.table import aligned
from relforest.metrics import Moments

_ABORTED: Final = "-"
_MOST_DECIMALS: Final = 4


@final
@dataclass(frozen=True, slots=True)
class Sheet:
    """A table with a caption.

    Parameters
    ----------
    caption : str
    header : tuple of str
    rows : tuple of tuple of str
        As many cells each as the header; the plus-minus sign is written in ASCII as text.
    """

    caption: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def to_text(self) -> str:
        """Return the caption and aligned columns."""
        rows = [[cell.replace("\u00b1", "+-") for cell in row] for row in self.rows]
        return f"{self.caption}\n{aligned(self.header, rows)}"

    def to_markdown(self) -> str:
        """Return a Markdown table below its caption."""
        lines = [self.header, ("---", *("---:" for _ in self.header[1:])), *self.rows]
        # A mark at the beginning of a cell is no quotation, but some renderers read HTML.
        table = "\n".join(f"| {' | '.join(line)} |" for line in lines).replace("<", "&lt;")
        return f"{self.caption}\n\n{table}"


def score_text(moments: Moments | None, sign: str = "") -> str:
    """Return a mean score with its 95 % interval, as the source prints it."""
    return _text(moments, sign, 2)


def time_text(moments: Moments | None, sign: str = "") -> str:
    """Return mean CPU seconds with their 95 % interval, as the source prints them."""
    return _text(moments, sign, 2 if moments is None else time_decimals(moments.mean))


def published_score(cell: Published | None) -> str:
    """Return a score of the source as it prints it; nothing if there is none."""
    return "" if cell is None else _published(cell, 2)


def published_time(cell: Published | None) -> str:
    """Return a time of the source as it prints it; nothing if there is none."""
    return "" if cell is None else _published(cell, time_decimals(cell.mean or 0.0))


def time_decimals(seconds: float) -> int:
    """Return how many decimals to print: three digits of what is above a second, two of what is below."""
    if seconds <= 0:
        return 2
    power = math.floor(math.log10(seconds))
    return max(2 - power, 0) if power >= 0 else min(1 - power, _MOST_DECIMALS)


def _text(moments: Moments | None, sign: str, decimals: int) -> str:
    if moments is None:
        return _ABORTED
    half_width = moments.interval().half_width
    return _joined(sign, moments.mean, half_width if half_width > 0 else None, decimals)


def _published(cell: Published, decimals: int) -> str:
    return _ABORTED if cell.mean is None else _joined(cell.mark, cell.mean, cell.half_width, decimals)


def _joined(sign: str, mean: float, half_width: float | None, decimals: int) -> str:
    # Adding zero makes a zero of a negative one.
    number = f"{round(mean, decimals) + 0.0:.{decimals}f}"
    bounds = "" if half_width is None else f" \u00b1 {half_width:.{decimals}f}"
    return f"{sign} {number}{bounds}".lstrip()
