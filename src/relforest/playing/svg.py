"""A frame as a vector picture within a page, light and dark."""

from __future__ import annotations

import html
import math
from collections.abc import Iterator, Sequence
from typing import Final, final

from relforest.playing.frames import Frame, Stage, Thing
from relforest.playing.shapes import ROLES, Circle, Line, Point, Polygon, Shape, Text

_BARB: Final = 2.6
_HALO: Final = 0.28


def svg(stage: Stage, frame: Frame, *, label: str, underlay: str = "", on_paper: bool = False) -> str:
    """Return a frame as an ``svg`` element, as wide as its place in the page allows.

    Colors of roles are variables of the page's style (``--ink``), so that it decides about light and dark.
    Each thing is a group with its key as ``data-key``.

    Parameters
    ----------
    stage : Stage
    frame : Frame
    label : str
        What is seen, for those who cannot see it.
    underlay : str
        SVG elements between backdrop and things.
    on_paper : bool
        Whether colors are those on light paper, for places without such a style.

    Raises
    ------
    InputError
        If a color is unknown.
    """
    left, right, low, high = stage.framed(frame.things)
    pen = _Pen(stage, stage.pixels / max(right - left, high - low), (left, high), on_paper=on_paper)
    width, height = pen.scale * (right - left), pen.scale * (high - low)
    nowhere = Thing("", (), 0.0, 0.0)
    parts = [
        *pen.drawn(stage.backdrop, nowhere),
        underlay,
        *(
            f'<g data-key="{html.escape(thing.key)}">{"".join(pen.drawn(thing.shapes, thing))}</g>'
            for thing in frame.things
        ),
        *pen.drawn(frame.notes, nowhere),
    ]
    size = f"0 0 {width:.0f} {height:.0f}"
    return f'<svg viewBox="{size}" role="img" aria-label="{html.escape(label)}">{"".join(parts)}</svg>'


@final
class _Pen:
    """Writes shapes as elements, in pixels."""

    def __init__(self, stage: Stage, scale: float, corner: Point, *, on_paper: bool) -> None:
        self.scale, self._stage, self._on_paper = scale, stage, on_paper
        self._left, self._high = corner

    def drawn(self, shapes: Sequence[Shape], thing: Thing) -> Iterator[str]:
        """Yield elements for shapes in the coordinates of a thing."""
        for shape in shapes:
            match shape:
                case Circle():
                    x, y = self._pixel(shape.centre, thing)
                    look = self._look(shape.fill, shape.edge, shape.width)
                    yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{self.scale * shape.radius:.1f}"{look}/>'
                case Polygon():
                    look = self._look(shape.fill, shape.edge, shape.width, dashed=shape.dashed)
                    yield f'<polygon points="{self._points(shape.corners, thing)}"{look}/>'
                case Line():
                    look = self._look("", shape.color, shape.width, dashed=shape.dashed)
                    yield f'<polyline points="{self._points(shape.points, thing)}"{look}/>'
                    if shape.arrow:
                        head = self._look("", shape.color, shape.width)
                        yield f'<polyline points="{self._head(shape, thing)}"{head}/>'
                case Text():
                    yield self._text(shape, thing)

    def _text(self, shape: Text, thing: Thing) -> str:
        x, y = self._pixel(shape.at, thing)
        size = self.scale * shape.size
        anchor = ("start", "middle", "end")[round(shape.side) + 1]
        halo = ""
        if shape.halo:
            halo = (
                f";stroke:{self._color(shape.halo)};stroke-width:{_HALO * size:.1f}px;paint-order:stroke;"
                "stroke-linejoin:round"
            )
        weight = ";font-weight:650" if shape.bold else ""
        return (
            f'<text x="{x:.1f}" y="{y:.1f}" dy=".35em" text-anchor="{anchor}" '
            f'style="font-size:{size:.1f}px;fill:{self._color(shape.color)}{halo}{weight}">'
            f"{html.escape(shape.words)}</text>"
        )

    def _look(self, fill: str, edge: str, width: float, *, dashed: bool = False) -> str:
        thick = max(self.scale * width, 1.0)
        line = f";stroke:{self._color(edge)};stroke-width:{thick:.1f}px;stroke-linejoin:round" if edge else ""
        dashes = f";stroke-dasharray:{3 * thick:.1f} {3 * thick:.1f}" if dashed else ""
        return f' style="fill:{self._color(fill) if fill else "none"}{line}{dashes}"'

    def _color(self, color: str) -> str:
        shade = self._stage.shade(color)
        is_role = color in ROLES or color in self._stage.colors
        return f"var(--{color})" if is_role and not self._on_paper else shade

    def _head(self, shape: Line, thing: Thing) -> str:
        (x, y), (tip_x, tip_y) = (self._pixel(point, thing) for point in shape.points[-2:])
        along = math.atan2(tip_y - y, tip_x - x)
        long = min(5 * self.scale * shape.width, math.hypot(tip_x - x, tip_y - y) / 2)
        barbs = [
            (tip_x + long * math.cos(along + turn), tip_y + long * math.sin(along + turn))
            for turn in (-_BARB, _BARB)
        ]
        return " ".join(f"{x:.1f},{y:.1f}" for x, y in (barbs[0], (tip_x, tip_y), barbs[1]))

    def _points(self, points: Sequence[Point], thing: Thing) -> str:
        return " ".join(f"{x:.1f},{y:.1f}" for x, y in (self._pixel(point, thing) for point in points))

    def _pixel(self, point: Point, thing: Thing) -> Point:
        along, across = math.cos(thing.angle), math.sin(thing.angle)
        x = thing.x + along * point[0] - across * point[1]
        y = thing.y + across * point[0] + along * point[1]
        return self.scale * (x - self._left), self.scale * (self._high - y)
