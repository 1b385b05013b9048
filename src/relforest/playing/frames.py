"""What a world gives to be looked at: a stage, and frames of what stands on it as time passes."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final, NamedTuple, Protocol, TypeAlias, final, runtime_checkable

from relforest.playing.shapes import ROLES, Shape, Words
from relforest.support.errors import InputError

View: TypeAlias = tuple[float, float, float, float]
"""Left, right, low, high."""

_ROLE: Final = re.compile(r"[a-z]+")
_COLOR: Final = re.compile(r"#[0-9a-f]{6}([0-9a-f]{2})?")


class Thing(NamedTuple):
    """Shapes that move together, such as a player."""

    key: str
    """Tells things apart, the same in all frames."""
    shapes: tuple[Shape, ...]
    """In the thing's own coordinates. Frames had better share these tuples."""
    x: float
    y: float
    angle: float = 0.0
    """Radians, counter-clockwise."""
    trail: str = ""
    """Color of the trail that shows where it was, if any."""


class Frame(NamedTuple):
    """A world at one moment."""

    time: float
    """Seconds since the episode began."""
    things: tuple[Thing, ...]
    """From the back to the front."""
    notes: tuple[Shape, ...] = ()
    """What lies before all things and does not move, such as a line to a target."""
    caption: str = ""
    """What is going on."""
    score: float | None = None
    """How good the state is, if that is known."""
    band: str = ""
    """Color of this moment in the band over the slider."""
    details: tuple[Words, ...] = ()
    """Lines about this moment for those who want to know everything."""


@final
@dataclass(frozen=True, slots=True)
class Stage:
    """What all frames of a world have in common.

    Parameters
    ----------
    view : (float, float, float, float)
        Left, right, low and high: what is always in the picture.
    backdrop : tuple of Shape
        What lies behind all things and never moves.
    colors : mapping
        The world's own roles -> their shades on light and on dark paper, beside those of `ROLES`.
    widest : (float, float, float, float), optional
        The picture shows more than the view while a thing is elsewhere, but no more than this.
    room : float
        How far things reach from where they are.
    pixels : int
        The longer side of a picture.
    rate : float
        Frames a second of a page.
    score_name : str
        What the scores of frames are.
    legend : str
        What the signs in the pictures mean.

    Raises
    ------
    InputError
        If a view is empty, or a color is none.
    """

    view: View
    backdrop: tuple[Shape, ...] = ()
    colors: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    widest: View | None = None
    room: float = 0.0
    pixels: int = 720
    rate: float = 10.0
    score_name: str = ""
    legend: str = ""

    def __post_init__(self) -> None:
        for left, right, low, high in (self.view, self.widest or self.view):
            if not (left < right and low < high):
                raise InputError(f"a view is left < right and low < high, got {self.view} and {self.widest}")
        for role, shades in self.colors.items():
            if not _ROLE.fullmatch(role) or not all(_COLOR.fullmatch(shade) for shade in shades):
                raise InputError(f"a color is a word and two shades like '#a0b1c2', got {role!r}: {shades}")

    @property
    def shades(self) -> dict[str, tuple[str, str]]:
        """All roles -> their shades on light and on dark paper."""
        return {**ROLES, **self.colors}

    def shade(self, color: str) -> str:
        """Return a color as it is on light paper, ``"#rrggbb"`` or ``"#rrggbbaa"``.

        Raises
        ------
        InputError
            If it is neither a role nor a color.
        """
        if _COLOR.fullmatch(color):
            return color
        shades = self.colors.get(color) or ROLES.get(color)
        if shades is None:
            raise InputError(f"{color!r} is no color: write '#rrggbb', or one of {', '.join(self.shades)}")
        return shades[0]

    def framed(self, things: tuple[Thing, ...]) -> View:
        """Return the view that contains these things as far as `widest` allows."""
        left, right, low, high = self.view
        if self.widest is None:
            return self.view
        least_left, most_right, least_low, most_high = self.widest
        for thing in things:
            left, right = min(left, thing.x - self.room), max(right, thing.x + self.room)
            low, high = min(low, thing.y - self.room), max(high, thing.y + self.room)
        return max(left, least_left), min(right, most_right), max(low, least_low), min(high, most_high)


@runtime_checkable
class Shown(Protocol):
    """A world that can be looked at."""

    @property
    def stage(self) -> Stage:
        """What all frames have in common."""
        ...

    def watch(self, see: Callable[[Frame], None] | None) -> None:
        """Pass `see` a frame after each reset and step, and in between if it likes, until it is None."""
        ...

    def say(self, position: int) -> Words:
        """Return the available action at a position of the present decision in words."""
        ...


@runtime_checkable
class Naming(Protocol):
    """A world that also knows which things are the objects of a decision."""

    def named(self, position: int) -> tuple[str, Words] | None:
        """Return the key of the thing that an object of the present decision is, and its name; None: none."""
        ...
