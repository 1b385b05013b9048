"""What pictures consist of: circles, polygons, lines and texts, in the units of the world, y upwards.

A color is the name of a role, such as ``"ink"``, whose light and dark shades a `Stage` knows, or
``"#rrggbb"``, or ``"#rrggbbaa"`` with an opacity. An empty one leaves out what it would color.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, NamedTuple, TypeAlias, final

Point: TypeAlias = tuple[float, float]

ROLES: Final[Mapping[str, tuple[str, str]]] = MappingProxyType(
    {
        "paper": ("#faf9f6", "#17191a"),
        "card": ("#ffffff", "#1f2223"),
        "ink": ("#262626", "#e8e6e1"),
        "grey": ("#63635f", "#a09e98"),
        "line": ("#deddd6", "#373a3b"),
        "track": ("#e6e5df", "#34383a"),
        "choice": ("#a8306f", "#f288bd"),
        "mark": ("#1f7a5c", "#6fd0ad"),
        "doubt": ("#b4540a", "#f0a060"),
    }
)
"""The colors of every stage: role -> its shade on light paper, and on dark paper."""


@final
@dataclass(frozen=True, slots=True)
class Circle:
    """A disc, or with ``edge`` a circle of this line width."""

    centre: Point
    radius: float
    fill: str = ""
    edge: str = ""
    width: float = 0.0


@final
@dataclass(frozen=True, slots=True)
class Polygon:
    """A polygon; its edge is centred on the outline."""

    corners: tuple[Point, ...]
    fill: str = ""
    edge: str = ""
    width: float = 0.0
    dashed: bool = False


@final
@dataclass(frozen=True, slots=True)
class Line:
    """Straight lines from point to point with round ends, or with the head of an arrow at the last one."""

    points: tuple[Point, ...]
    color: str
    width: float
    dashed: bool = False
    arrow: bool = False


@final
@dataclass(frozen=True, slots=True)
class Text:
    """A line of text, always upright and large enough to be read.

    Parameters
    ----------
    words : str
    at : (float, float)
    size : float
        Font size.
    color : str
    halo : str
        Color of an outline that sets it off from what lies behind.
    side : float
        0: centred at the point; -1: begins there; 1: ends there.
    bold : bool
    """

    words: str
    at: Point
    size: float
    color: str = "ink"
    halo: str = ""
    side: float = 0.0
    bold: bool = False


Shape: TypeAlias = Circle | Polygon | Line | Text


class Chip(NamedTuple):
    """The name of an object within a text, on its color."""

    label: str
    color: str


Words: TypeAlias = Sequence[str | Chip]
"""A text that names objects."""


def plain(words: Words) -> str:
    """Return a text without its colors."""
    return "".join(part if isinstance(part, str) else part.label for part in words)


def box(left: float, right: float, low: float, high: float) -> tuple[Point, ...]:
    """Return the corners of an upright rectangle."""
    return (left, low), (right, low), (right, high), (left, high)
