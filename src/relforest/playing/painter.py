"""A frame as a picture: Pillow draws it enlarged, and the reduction makes edges soft."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Final, final

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from relforest.playing.frames import Frame, Stage, Thing
from relforest.playing.shapes import Circle, Line, Point, Polygon, Shape, Text

_FINE: Final = 2
_SMALLEST: Final = 9.0
_CAPTION: Final = 15.0
_SMALL: Final = 13.0
_MARGIN: Final = 14.0
_HEADER: Final = 32
_DASH: Final = 3.0
_HALO: Final = 2.0


def picture_shape(stage: Stage) -> tuple[int, int]:
    """Return the height and width in pixels of all pictures of a stage; both are even, as for videos.

    Above the view is a header for texts.
    """
    left, right, low, high = stage.view
    scale = stage.pixels / max(right - left, high - low)
    height, width = (2 * max(round(scale * side / 2), 1) for side in (high - low, right - left))
    return height + _HEADER, width


def paint(stage: Stage, frame: Frame) -> NDArray[np.uint8]:
    """Return the picture of a frame, uint8 (height, width, 3) RGB, see `picture_shape`.

    Raises
    ------
    InputError
        If a color is unknown.
    """
    height, width = picture_shape(stage)
    image = Image.new("RGB", (width * _FINE, height * _FINE), stage.shade("paper"))
    brush = _Brush(image, stage, frame.things)
    brush.draw(stage.backdrop, Thing("", (), 0.0, 0.0))
    for thing in frame.things:
        brush.draw(thing.shapes, thing)
    brush.draw(frame.notes, Thing("", (), 0.0, 0.0))
    brush.cover_header()
    words = f"{frame.time:.1f} s"
    if frame.score is not None:
        words = f"{stage.score_name} {frame.score:.2f}, ".replace("-", "\N{MINUS SIGN}") + words
    brush.write(words, (width - _MARGIN, _HEADER / 2), _SMALL, "grey", side=1.0)
    brush.write(frame.caption, (_MARGIN, _HEADER / 2), _CAPTION, "ink", side=-1.0, bold=True)
    return np.asarray(image.reduce(_FINE))


@final
class _Brush:
    """Draws shapes of a world on an enlarged image; sizes of texts and places in `write` are final pixels."""

    def __init__(self, image: Image.Image, stage: Stage, things: tuple[Thing, ...]) -> None:
        self._draw, self._glaze = ImageDraw.Draw(image), ImageDraw.Draw(image, "RGBA")
        self._stage, self._width = stage, image.width
        left, right, low, high = stage.framed(things)
        room = image.height - _HEADER * _FINE
        self._scale = min(image.width / (right - left), room / (high - low))
        self._column = image.width / 2 - self._scale * (left + right) / 2
        # What stands on the ground stays there while the picture zooms out.
        spare = 0.0 if stage.widest else (room - self._scale * (high - low)) / 2
        self._row = image.height - spare + self._scale * low

    def draw(self, shapes: Sequence[Shape], thing: Thing) -> None:
        """Draw shapes that are given in the coordinates of a thing."""
        for shape in shapes:
            match shape:
                case Circle():
                    self._circle(shape, self._pixel(shape.centre, thing))
                case Polygon():
                    corners = [self._pixel(corner, thing) for corner in shape.corners]
                    if shape.fill:
                        self._fill(corners, self._stage.shade(shape.fill))
                    if shape.edge:
                        self._stroke([*corners, corners[0]], shape.edge, shape.width, dashed=shape.dashed)
                case Line():
                    points = [self._pixel(point, thing) for point in shape.points]
                    self._stroke(points, shape.color, shape.width, dashed=shape.dashed)
                    if shape.arrow:
                        self._arrow(points, shape)
                case Text():
                    column, row = self._pixel(shape.at, thing)
                    size = max(self._scale * shape.size / _FINE, _SMALLEST)
                    place = (column / _FINE, row / _FINE)
                    words, color, bold = shape.words, shape.color, shape.bold
                    self.write(words, place, size, color, side=shape.side, halo=shape.halo, bold=bold)

    def cover_header(self) -> None:
        """Hide what reaches into the header."""
        self._draw.rectangle((0, 0, self._width, _HEADER * _FINE - 1), self._stage.shade("paper"))

    def write(
        self,
        words: str,
        at: Point,
        size: float,
        color: str,
        *,
        side: float,
        halo: str = "",
        bold: bool = False,
    ) -> None:
        """Write a line of text, centred on a row of final pixels."""
        self._draw.text(
            (at[0] * _FINE, at[1] * _FINE),
            words,
            self._stage.shade(color),
            _font(round(size * _FINE), bold=bold),
            anchor=("lm", "mm", "rm")[round(side) + 1],
            stroke_width=_HALO * _FINE if halo else 0,
            stroke_fill=self._stage.shade(halo) if halo else None,
        )

    def _pixel(self, point: Point, thing: Thing) -> Point:
        along, across = math.cos(thing.angle), math.sin(thing.angle)
        x = thing.x + along * point[0] - across * point[1]
        y = thing.y + across * point[0] + along * point[1]
        return self._column + self._scale * x, self._row - self._scale * y

    def _fill(self, corners: list[Point], shade: str) -> None:
        # To blend colors takes ten times as long.
        (self._draw if len(shade) == len("#rrggbb") else self._glaze).polygon(corners, shade)

    def _circle(self, shape: Circle, at: Point) -> None:
        half = self._scale * shape.width / 2 if shape.edge else 0.0
        radius = self._scale * shape.radius + half
        around = (at[0] - radius, at[1] - radius, at[0] + radius, at[1] + radius)
        fill = self._stage.shade(shape.fill) if shape.fill else None
        edge = self._stage.shade(shape.edge) if shape.edge else None
        self._draw.ellipse(around, fill, edge, max(round(2 * half), _FINE) if edge else 0)

    def _stroke(self, points: list[Point], color: str, width: float, *, dashed: bool) -> None:
        thick, shade = max(round(self._scale * width), _FINE), self._stage.shade(color)
        if dashed:
            for begin, end in pairwise(points):
                for dash in _dashes(begin, end, _DASH * thick):
                    self._draw.line(dash, shade, thick)
            return
        self._draw.line(points, shade, thick, joint="curve")
        for column, row in (points[0], points[-1]):
            half = thick / 2
            self._draw.ellipse((column - half, row - half, column + half, row + half), shade)

    def _arrow(self, points: list[Point], shape: Line) -> None:
        (column, row), tip = points[-2], points[-1]
        along = math.atan2(tip[1] - row, tip[0] - column)
        long = 5 * self._scale * shape.width
        for turn in (-2.6, 2.6):
            barb = (tip[0] + long * math.cos(along + turn), tip[1] + long * math.sin(along + turn))
            self._stroke([tip, barb], shape.color, shape.width, dashed=False)


def _dashes(begin: Point, end: Point, long: float) -> list[tuple[Point, Point]]:
    """Return the drawn parts of a line, as long as the gaps between them."""
    count = max(int(math.dist(begin, end) / (2 * long)), 1)
    ends = np.linspace(begin, end, 2 * count).tolist()
    return [(tuple(first), tuple(last)) for first, last in zip(ends[::2], ends[1::2], strict=True)]


@lru_cache(maxsize=64)
def _font(size: int, *, bold: bool) -> ImageFont.FreeTypeFont:
    # DejaVu Sans ships with Matplotlib, which is loaded only if there is text to draw.
    import matplotlib as mpl  # noqa: PLC0415

    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    return ImageFont.truetype(Path(mpl.get_data_path(), "fonts", "ttf", name), size)
