"""Pictures of blocks on a table, drawn with NumPy so that recording an episode costs little."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from relforest.support.errors import InputError
from relforest.support.lettering import text_width, write
from relforest.support.options import in_range
from relforest.support.painting import Canvas, Color, Point, paint_box, paint_ring, paint_stroke

HEIGHT: Final = 512
WIDTH: Final = 720

_PAPER: Final[Color] = (250, 249, 246)
_INK: Final[Color] = (38, 38, 38)
_GREY: Final[Color] = (115, 115, 115)
_LINE: Final[Color] = (233, 231, 224)
_WOOD: Final[Color] = (214, 200, 178)
_EDGE: Final[Color] = (154, 134, 104)
_WHITE: Final[Color] = (255, 255, 255)
_TOOL: Final[Color] = (178, 60, 120)

_HEADER: Final = 44.0
_FOOTER: Final = 22.0
_MARGIN: Final = 20.0
_THICKNESS: Final = 3.0
# Half the width that is always in view: blocks are dropped up to 30 from the middle and reach 7 farther.
_SIDE: Final = 40.0
_ROOM: Final = 2.0
_RIM: Final = 1.75
_LINES: Final = 10.0
_LABELS: Final = (15, 13, 11, 9)


@final
@dataclass(frozen=True, slots=True)
class _Camera:
    """From world units to pixels: ``scale`` pixels per unit, the table's top in row ``ground``."""

    scale: float
    middle: float
    ground: float

    def pixel(self, x: float, y: float) -> Point:
        return WIDTH / 2 + self.scale * (x - self.middle), self.ground - self.scale * y


@final
class BlocksViewer:
    """Draws states of a blocks world from the side: the table, the blocks in their colours, and the tool.

    All blocks are always in view: the picture shows at least 40 units to both sides of the middle of the
    table, and more, at a smaller scale, while a block is farther away or higher than there is room for. Faint
    lines mark heights, ten units apart.

    Parameters
    ----------
    table : float
        Half the width of the table.

    Attributes
    ----------
    shape : tuple of int
        Height and width of every picture in pixels, both even.
    """

    def __init__(self, *, table: float = 100.0) -> None:
        self._table = in_range("table", table, 0.0, 1e6, open_low=True)
        self.shape = (HEIGHT, WIDTH)

    def draw(
        self,
        half_extents: ArrayLike,
        poses: ArrayLike,
        colors: ArrayLike,
        *,
        ids: Sequence[object] | NDArray[np.int64] | None = None,
        caption: str = "",
        tool: ArrayLike | None = None,
        time: float | None = None,
        score: str = "",
    ) -> NDArray[np.uint8]:
        """Return the picture of a state.

        Parameters
        ----------
        half_extents : (n, 2) float64
            Half sides of the blocks along their own x and y.
        poses : (n, 3) float64
            x, y of the centre, and the angle in radians, counter-clockwise.
        colors : (n, 3) float64
            Red, green and blue, from 0 to 1.
        ids : sequence of n, optional
            What to write on the blocks.
        caption : str
            What is going on, such as the option: at the top left.
        tool : (2,) float64, optional
            x and y of the point where the robot holds a block, or let go of one.
        time : float, optional
            Seconds since the episode began: at the top right.
        score : str
            How good the state is: below the caption.

        Returns
        -------
        (height, width, 3) uint8
            Red, green and blue.

        Raises
        ------
        InputError
            If an array has the wrong shape or numbers that are not finite.
        """
        sides, places, shades = self._checked(half_extents, poses, colors)
        if ids is not None and len(ids) != len(sides):
            raise InputError(f"ids must name all {len(sides)} blocks, got {len(ids)}")
        held = None if tool is None else np.asarray(tool, dtype=np.float64)
        if held is not None and (held.shape != (2,) or not np.isfinite(held).all()):
            raise InputError(f"tool must be two finite numbers, got {tool!r}")
        camera = self._camera(sides, places)
        canvas = np.empty((*self.shape, 3), dtype=np.uint8)
        canvas[:] = _PAPER
        self._draw_table(canvas, camera)
        for block, place in enumerate(places):
            _draw_block(canvas, camera, sides[block], place, shades[block])
        if held is not None:
            _draw_tool(canvas, camera.pixel(float(held[0]), float(held[1])))
        for block, name in enumerate(() if ids is None else ids):
            _draw_label(canvas, camera, sides[block], places[block], shades[block], str(name))
        write(canvas, caption, (_MARGIN, _MARGIN), size=15, side=-1.0, bold=True, color=_INK)
        # Without a caption the score takes its line.
        row = 1.95 * _MARGIN if caption else _MARGIN
        write(canvas, score, (_MARGIN, row), size=13, side=-1.0, color=_GREY)
        if time is not None:
            write(canvas, f"{time:.1f} s", (WIDTH - _MARGIN, _MARGIN), size=13, side=1.0, color=_GREY)
        return canvas

    def _checked(self, *arrays: ArrayLike) -> tuple[NDArray[np.float64], ...]:
        checked: list[NDArray[np.float64]] = []
        names, columns = ("half_extents", "poses", "colors"), (2, 3, 3)
        for name, wanted, values in zip(names, columns, arrays, strict=True):
            array = np.asarray(values, dtype=np.float64)
            if array.size == 0:
                array = array.reshape(0, wanted)
            shape = (len(checked[0]) if checked else len(array), wanted)
            if array.shape != shape or not np.isfinite(array).all():
                raise InputError(f"{name} must contain finite numbers in shape {shape}, got {array.shape}")
            checked.append(array)
        return tuple(checked)

    def _camera(self, sides: NDArray[np.float64], places: NDArray[np.float64]) -> _Camera:
        """Return a camera that moves smoothly with the blocks and shows all that are not lost."""
        reach = np.hypot(*sides.T) + _ROOM
        lost = self._table + 2 * _SIDE
        left = max(min(-_SIDE, *(places[:, 0] - reach), 0.0), -lost)
        right = min(max(_SIDE, *(places[:, 0] + reach), 0.0), lost)
        ground = HEIGHT - _FOOTER
        usual = WIDTH / (2 * _SIDE)
        room = ground - _HEADER - _THICKNESS * usual
        top = max(room / usual, *(places[:, 1] + reach), 0.0)
        scale = min(WIDTH / (right - left), room / min(top, 4 * _SIDE))
        return _Camera(scale, (left + right) / 2, ground - _THICKNESS * usual)

    def _draw_table(self, canvas: Canvas, camera: _Camera) -> None:
        height = _LINES
        while (row := camera.pixel(0.0, height)[1]) > _HEADER:
            paint_stroke(canvas, _LINE, (_MARGIN + 20, row), (WIDTH - _MARGIN, row), 0.5)
            write(canvas, f"{height:g}", (_MARGIN + 12, row), size=10, side=1.0, color=_GREY)
            height += _LINES
        ends = [camera.pixel(side * self._table, 0.0)[0] for side in (-1.0, 1.0)]
        left, right = (min(max(end, -_MARGIN), WIDTH + _MARGIN) for end in ends)
        row = camera.ground
        deep = camera.scale * _THICKNESS / 2
        paint_box(canvas, _WOOD, ((left + right) / 2, row + deep), ((right - left) / 2, deep), 0.0)
        paint_box(canvas, _EDGE, ((left + right) / 2, row + 1.0), ((right - left) / 2, 1.0), 0.0)


def _draw_block(
    canvas: Canvas,
    camera: _Camera,
    half_extents: NDArray[np.float64],
    pose: NDArray[np.float64],
    color: NDArray[np.float64],
) -> None:
    center = camera.pixel(float(pose[0]), float(pose[1]))
    wide, high = (float(camera.scale * side) for side in half_extents)
    # Rows grow downwards, so what turns left in the world turns right in rows and columns.
    angle = -float(pose[2])
    paint_box(canvas, _rim(color), center, (wide, high), angle)
    if min(wide, high) > _RIM:
        paint_box(canvas, _color(color), center, (wide - _RIM, high - _RIM), angle)


def _draw_label(
    canvas: Canvas,
    camera: _Camera,
    half_extents: NDArray[np.float64],
    pose: NDArray[np.float64],
    color: NDArray[np.float64],
    label: str,
) -> None:
    """Write a block's label upright on it; where it has too little room, on a badge of the block's colour."""
    center = camera.pixel(float(pose[0]), float(pose[1]))
    wide, high = camera.scale * half_extents
    along, across = abs(math.cos(pose[2])), abs(math.sin(pose[2]))
    for size in _LABELS:
        half = text_width(label, size, bold=True) / 2 - 0.5
        tall = 0.365 * size
        if half * along + tall * across <= wide and half * across + tall * along <= high:
            break
    else:
        size, half = _LABELS[-1], text_width(label, _LABELS[-1], bold=True) / 2
        ends = (center[0] - half + 4, center[1]), (center[0] + half - 4, center[1])
        paint_stroke(canvas, _rim(color), *ends, 7.5)
        paint_stroke(canvas, _color(color), *ends, 6.5)
    write(canvas, label, center, size=size, bold=True, color=_INK if _light(color) > 0.5 else _WHITE)


def _draw_tool(canvas: Canvas, spot: Point) -> None:
    paint_ring(canvas, _WHITE, spot, 11.0, 2.5)
    paint_ring(canvas, _TOOL, spot, 11.0, 1.5)


def _light(color: NDArray[np.float64]) -> float:
    return float(np.clip(color, 0.0, 1.0) @ (0.299, 0.587, 0.114))


def _rim(color: NDArray[np.float64]) -> Color:
    """Return a darker shade, or a lighter one of what is nearly black."""
    return _color(0.55 * color + (0.2 if _light(color) < 0.25 else 0.0))


def _color(shares: NDArray[np.float64]) -> Color:
    red, green, blue = (round(255 * float(share)) for share in np.clip(shares, 0.0, 1.0))
    return red, green, blue
