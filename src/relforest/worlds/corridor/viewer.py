"""Pictures of the corridor, drawn with NumPy alone so that recording an episode costs little."""

from __future__ import annotations

from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.worlds.corridor.reward import reward
from relforest.worlds.corridor.state import CorridorState

HEIGHT: Final = 144
WIDTH: Final = 576

_Color = tuple[int, int, int]

_PAPER: Final[_Color] = (250, 249, 246)
_FLOOR: Final[_Color] = (225, 229, 235)
_WINDOW: Final[_Color] = (178, 223, 200)
_WINDOW_LIT: Final[_Color] = (88, 190, 140)
_LINE: Final[_Color] = (166, 174, 187)
_AGENT: Final[_Color] = (38, 84, 150)
_RIM: Final[_Color] = (255, 255, 255)
_CLOCK: Final[_Color] = (214, 150, 58)

_LEFT, _RIGHT, _TOP, _BOTTOM = 40.0, 536.0, 54.0, 104.0
_CLOCK_TOP, _CLOCK_BOTTOM = 24.0, 30.0
_TICK_TOP, _TICK_BOTTOM = 112.0, 118.0
_RADIUS: Final = 17.0
# The floor reaches beyond the ends of the corridor so that the agent stands on it at an edge.
_FLOOR_LEFT, _FLOOR_RIGHT = _LEFT - 24.0, _RIGHT + 24.0


@final
class CorridorViewer:
    """Draws states of a corridor: the floor, the rewarded windows, the agent and, above, the elapsed time.

    Parameters
    ----------
    window : float
        Width of each rewarded zone, in corridor lengths; a window lights up while the agent stands in it.
    max_steps : int
        Steps of an episode: the full length of the time bar.
    """

    def __init__(self, *, window: float, max_steps: int) -> None:
        self._window = window
        self._max_steps = max_steps
        self._background = self._draw_background()

    def draw(self, state: CorridorState) -> NDArray[np.uint8]:
        """Return the picture of a state, (`HEIGHT`, `WIDTH`, 3) uint8 RGB."""
        canvas = self._background.copy()
        if reward(state.x, window=self._window):
            self._paint_window(canvas, _WINDOW_LIT, left=state.x <= self._window)
        used = _LEFT + (_RIGHT - _LEFT) * min(state.steps / self._max_steps, 1.0)
        if state.steps:
            _paint_bar(canvas, _CLOCK, (_LEFT, used, _CLOCK_TOP, _CLOCK_BOTTOM), radius=3.0)
        column, row = _column(state.x), (_TOP + _BOTTOM) / 2
        _paint_disc(canvas, _RIM, (column, row), _RADIUS + 2.5)
        _paint_disc(canvas, _AGENT, (column, row), _RADIUS)
        return canvas

    def _draw_background(self) -> NDArray[np.uint8]:
        canvas = np.empty((HEIGHT, WIDTH, 3), dtype=np.uint8)
        canvas[:] = _PAPER
        _paint_bar(canvas, _FLOOR, (_FLOOR_LEFT, _FLOOR_RIGHT, _TOP, _BOTTOM), radius=25.0)
        self._paint_window(canvas, _WINDOW, left=True)
        self._paint_window(canvas, _WINDOW, left=False)
        for top in np.arange(_TOP + 3, _BOTTOM - 3, 9.0):
            _paint_bar(canvas, _LINE, (_column(0.5) - 1, _column(0.5) + 1, top, top + 5), radius=1.0)
        _paint_bar(canvas, _FLOOR, (_LEFT, _RIGHT, _CLOCK_TOP, _CLOCK_BOTTOM), radius=3.0)
        for tenth in range(11):
            tall = 4.0 if tenth in (0, 5, 10) else 0.0
            column = _column(tenth / 10)
            _paint_bar(canvas, _LINE, (column - 1, column + 1, _TICK_TOP, _TICK_BOTTOM + tall), radius=1.0)
        return canvas

    def _paint_window(self, canvas: NDArray[np.uint8], color: _Color, *, left: bool) -> None:
        inner = _column(self._window if left else 1.0 - self._window)
        # A bar round at both ends, cut where the window begins.
        if left:
            _paint_bar(
                canvas,
                color,
                (_FLOOR_LEFT, inner + 50, _TOP, _BOTTOM),
                radius=25.0,
                columns=(0, round(inner)),
            )
        else:
            _paint_bar(
                canvas,
                color,
                (inner - 50, _FLOOR_RIGHT, _TOP, _BOTTOM),
                radius=25.0,
                columns=(round(inner), WIDTH),
            )


def _column(x: float) -> float:
    """Return the pixel column of a location."""
    return _LEFT + (_RIGHT - _LEFT) * x


def _paint_disc(canvas: NDArray[np.uint8], color: _Color, center: tuple[float, float], radius: float) -> None:
    column, row = center
    box = (column - radius, column + radius, row - radius, row + radius)
    _paint_bar(canvas, color, box, radius=radius)


def _paint_bar(
    canvas: NDArray[np.uint8],
    color: _Color,
    box: tuple[float, float, float, float],
    *,
    radius: float,
    columns: tuple[int, int] = (0, WIDTH),
) -> None:
    """Paint a rectangle (left, right, top, bottom, in pixels) with round corners, within the given columns.

    A pixel is covered as far as its centre lies inside the outline, which gives a soft edge one pixel wide.
    """
    left, right, top, bottom = box
    radius = min(radius, (right - left) / 2, (bottom - top) / 2)
    first, last = max(int(left) - 1, columns[0]), min(int(right) + 2, columns[1])
    rows = np.arange(int(top) - 1, int(bottom) + 2, dtype=np.float32)[:, None] + 0.5
    across = np.abs(np.arange(first, last, dtype=np.float32)[None, :] + 0.5 - (left + right) / 2)
    across -= (right - left) / 2 - radius
    down = np.abs(rows - (top + bottom) / 2) - ((bottom - top) / 2 - radius)
    outside = np.hypot(np.maximum(across, 0), np.maximum(down, 0))
    distance = outside + np.minimum(np.maximum(across, down), 0) - radius
    cover = np.clip(0.5 - distance, 0, 1)[:, :, None]
    patch = canvas[int(top) - 1 : int(bottom) + 2, first:last]
    patch[:] = np.rint(patch + cover * (np.asarray(color, dtype=np.float32) - patch))
