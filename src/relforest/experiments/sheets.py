"""What a study found as tables of numbers, and how they are laid out as text and as Markdown."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from relforest.metrics import NORMAL_95

_UNKNOWN: Final = "-"

Format: TypeAlias = str | Callable[[float], str]
"""How numbers are written: a format specification such as ``".2f"``, or a function from a number to one."""


@final
@dataclass(frozen=True, slots=True)
class Estimate:
    """A number, and how far it may be off."""

    value: float  # NaN where it is unknown
    spread: float | None = None
    """Half the width of its interval, or its standard deviation; None where it is unknown or there is
    none."""
    mark: str = ""  # the sign of a comparison with another one, written before it

    @classmethod
    def of(cls, values: NDArray[np.float64]) -> Estimate:
        """Return the mean of (n,) values with its 95 % interval by the normal distribution."""
        mean = float(values.mean()) if len(values) else math.nan
        return cls.normal(mean, float(values.std(ddof=1)) if len(values) > 1 else math.nan, len(values))

    @classmethod
    def normal(cls, mean: float, deviation: float, count: int) -> Estimate:
        """Return the mean of a number of values with this standard deviation, NaN if unknown; see `of`."""
        return cls(mean, None if math.isnan(deviation) else NORMAL_95 * deviation / count**0.5)

    @property
    def low(self) -> float:
        """The lower end of its interval; NaN where that is unknown."""
        return self.value - (math.nan if self.spread is None else self.spread)

    def minus(self, other: Estimate) -> Estimate:
        """Return the difference to another estimate, of values drawn independently."""
        is_known = self.spread is not None and other.spread is not None
        spread = math.hypot(self.spread or 0.0, other.spread or 0.0) if is_known else None
        return Estimate(self.value - other.value, spread)


@final
@dataclass(frozen=True, slots=True)
class Span:
    """Two numbers and what lies between them."""

    low: float
    high: float


Entry: TypeAlias = str | bool | int | float | Estimate | Span | None
"""What stands in a table: text as it is, numbers in the format of their column, nothing for None."""


@final
@dataclass(frozen=True, slots=True)
class Sheet:
    """A table with a caption.

    Examples
    --------
    >>> sheet = Sheet("Scores", {"": "", "score": ".2f"}, (("ours", Estimate(0.5, 0.02)), ("theirs", None)))
    >>> print(sheet.to_text())
    Scores
                   score
    ours    0.50 +- 0.02
    theirs
    """

    caption: str
    columns: Mapping[str, Format]
    """The headings, and how floating-point numbers below them are written; integers are written in full."""
    rows: tuple[tuple[Entry, ...], ...]  # as many entries each as there are columns

    def to_text(self) -> str:
        """Return the caption and aligned columns, the first to the left, the others to the right."""
        lines = [[cell.replace("\u00b1", "+-") for cell in line] for line in self.lines()]
        widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
        text = [self.caption]
        for first, *others in lines:
            cells = (cell.rjust(width) for cell, width in zip(others, widths[1:], strict=True))
            text.append("  ".join((first.ljust(widths[0]), *cells)).rstrip())
        return "\n".join(text)

    def to_markdown(self) -> str:
        """Return a Markdown table below its caption."""
        header, *rows = self.lines()
        lines = [header, ["---", *("---:" for _ in header[1:])], *rows]
        # A mark at the beginning of a cell is no quotation, but some renderers read HTML.
        table = "\n".join(f"| {' | '.join(line)} |" for line in lines).replace("<", "&lt;")
        return f"{self.caption}\n\n{table}"

    def lines(self) -> list[list[str]]:
        """Return the cells of the headings and of every row as text."""
        formats = self.columns.values()
        return [
            list(self.columns),
            *([_written(cell, form) for cell, form in zip(row, formats, strict=True)] for row in self.rows),
        ]


@final
@dataclass(frozen=True, slots=True)
class Passage:
    """A text with a caption, such as a tree in words."""

    caption: str
    text: str

    def to_text(self) -> str:
        """Return the caption and the text below it."""
        return f"{self.caption}\n{self.text}"

    def to_markdown(self) -> str:
        """Return the caption and the text as a block of code."""
        return f"{self.caption}\n\n```\n{self.text}\n```"


def _written(entry: Entry, form: Format) -> str:
    match entry:
        case None:
            return ""
        case str():
            return entry
        case bool():
            return "yes" if entry else "no"
        case int():
            return str(entry)
        case float():
            return _number(entry, form)
        case Span():
            return f"{_number(entry.low, form)} to {_number(entry.high, form)}"
        case Estimate():
            # Both numbers have the decimals of the first one.
            chosen = form if isinstance(form, str) else form(entry.value)
            is_known = entry.spread is not None and not math.isnan(entry.value)
            spread = f" \u00b1 {_number(entry.spread or 0.0, chosen.lstrip('+'))}" if is_known else ""
            return f"{entry.mark} {_number(entry.value, chosen)}{spread}".lstrip()


def _number(value: float, form: Format) -> str:
    if math.isnan(value):
        return _UNKNOWN
    chosen = form if isinstance(form, str) else form(value)
    # The z makes a zero of a negative one; a sign must stand before it.
    sign = "+" if chosen.startswith("+") else ""
    return format(value, f"{sign}z{chosen.removeprefix('+')}")
