"""Pictures of a keepaway game, drawn with NumPy so that recording an episode costs little.

As on the monitor of the RoboCup 2-D server, y points down. Distances are to scale, players and ball are drawn
larger than they are.
"""

from __future__ import annotations

import math
from typing import Final, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from relforest.support.errors import InputError
from relforest.support.lettering import write
from relforest.support.painting import Canvas, Color, Point, paint_ring, paint_stroke, paint_trail
from relforest.worlds.keepaway.variables import by_distance

LONGEST: Final = 560
"""Pixels of the longer side of the field."""

_PAPER: Final[Color] = (250, 249, 246)
_GRASS: Final[Color] = (217, 229, 212)
_STRIPE: Final[Color] = (211, 224, 206)
_CHALK: Final[Color] = (255, 255, 255)
_INK: Final[Color] = (38, 38, 38)
_GREY: Final[Color] = (115, 115, 115)
_TRACK: Final[Color] = (226, 226, 222)
_KEEPER: Final[Color] = (240, 180, 20)
_TAKER: Final[Color] = (86, 180, 233)
_CHOICE: Final[Color] = (178, 60, 120)

_MARGIN: Final = 32.0
_SHORTEST: Final = 160.0
_RADIUS: Final = 11.0
_BALL: Final = 5.0
_KICKABLE: Final = 1.085
_NARROWEST: Final = 140.0
_ROW: Final = 40
_GAP: Final = 24.0


@final
class KeepawayViewer:
    """Draws states of a game: the field, the players with their body directions, the ball, and a decision.

    Keepers are yellow with numbers from 1, takers are blue. A ring around the keeper that must decide
    shows how far it can kick; an arrow shows a pass it has chosen. Below the field are the time and, if
    given, the values of its actions as bars.

    Parameters
    ----------
    keepers, takers : int
        Numbers of players.
    length, width : float
        Sides of the field in x and y, in metres.

    Attributes
    ----------
    shape : tuple of int
        Height and width of every picture in pixels, both even.
    """

    def __init__(self, *, keepers: int, takers: int, length: float, width: float) -> None:
        self._keepers, self._takers = keepers, takers
        self._scale = LONGEST / max(length, width)
        self._middle = (
            _MARGIN + max(self._scale * length, _SHORTEST) / 2,
            _MARGIN + max(self._scale * width, _SHORTEST) / 2,
        )
        self._panel = int(2 * self._middle[1])
        self._columns = min(keepers, max(1, int(2 * (self._middle[0] - _MARGIN) / _NARROWEST)))
        rows = -(-keepers // self._columns)
        self.shape = (_even(self._panel + _ROW * rows + 8), _even(2 * self._middle[0]))
        self._background = self._draw_background(length, width)

    def draw(
        self,
        players: ArrayLike,
        ball: ArrayLike,
        *,
        actor: int = -1,
        action: int = -1,
        values: ArrayLike | None = None,
        receivers: ArrayLike | None = None,
        trail: ArrayLike | None = None,
        time: int | None = None,
    ) -> NDArray[np.uint8]:
        """Return the picture of a state.

        Parameters
        ----------
        players : (n, 5) float64
            x, y, vx, vy in metres and metres per cycle, body direction in degrees; keepers first.
        ball : (4,) float64
            x, y, vx, vy.
        actor : int
            The keeper that must decide, -1 = none.
        action : int
            What it has chosen: 0 = hold, k = pass to ``receivers[k - 1]``, -1 = nothing yet.
        values : (keepers,) float64, optional
            The values of its actions.
        receivers : (keepers - 1,) int, optional
            Its teammates in the order of its actions; default: by distance, as they stand.
        trail : (t, n + 1, 2) float64, optional
            Earlier locations of the players and, last, of the ball, oldest first.
        time : int, optional
            Cycles since the episode began; a cycle is a tenth of a second.

        Returns
        -------
        (height, width, 3) uint8
            Red, green and blue.

        Raises
        ------
        InputError
            If an array has the wrong shape, or actor or action is out of range.
        """
        players, ball = self._checked("players", players, 5), self._checked("ball", ball, 4)
        if not -1 <= actor < self._keepers or not -1 <= action < self._keepers:
            raise InputError(
                f"actor and action must be from -1 to {self._keepers - 1}, got {actor} and {action}"
            )
        canvas = self._background.copy()
        if trail is not None:
            self._draw_trails(canvas, np.asarray(trail, dtype=np.float64))
        if actor >= 0:
            order = [actor, *self._receivers(players, actor, receivers)]
            self._draw_choice(canvas, players, actor, order[action] if action > 0 else -1)
            self._draw_actions(canvas, order, action, values)
        for player in range(len(players)):
            self._draw_player(canvas, player, players[player])
        spot = self._pixel(ball)
        paint_stroke(canvas, _INK, spot, spot, _BALL + 1.5)
        paint_stroke(canvas, _CHALK, spot, spot, _BALL)
        if time is not None:
            at = (self.shape[1] - _MARGIN, _MARGIN / 2)
            write(canvas, f"{time / 10:.1f} s", at, size=13, side=1.0, color=_GREY)
        return canvas

    def _checked(self, name: str, values: ArrayLike, columns: int) -> NDArray[np.float64]:
        array = np.asarray(values, dtype=np.float64)
        shape = (columns,) if name == "ball" else (self._keepers + self._takers, columns)
        if array.shape != shape or not np.isfinite(array).all():
            raise InputError(f"{name} must contain finite numbers in shape {shape}, got {array.shape}")
        return array

    def _receivers(self, players: NDArray[np.float64], actor: int, receivers: ArrayLike | None) -> list[int]:
        if receivers is None:
            mates = np.empty(self._keepers - 1, dtype=np.int64)
            by_distance(players, actor, 0, mates)
        else:
            mates = np.asarray(receivers, dtype=np.int64)
        others = sorted({*range(self._keepers)} - {actor})
        if sorted(mates.tolist()) != others:
            raise InputError(f"receivers must be the teammates {others} of {actor}, got {mates.tolist()}")
        return mates.tolist()

    def _pixel(self, location: NDArray[np.float64]) -> Point:
        """Return column and row of a location; what is far outside is drawn at the edge of the picture."""
        column = self._middle[0] + self._scale * float(location[0])
        row = self._middle[1] + self._scale * float(location[1])
        lowest = self._panel - _RADIUS
        return min(max(column, _RADIUS), self.shape[1] - _RADIUS), min(max(row, _RADIUS), lowest)

    def _draw_background(self, length: float, width: float) -> NDArray[np.uint8]:
        canvas = np.empty((*self.shape, 3), dtype=np.uint8)
        canvas[:] = _PAPER
        halves = (self._scale * length / 2, self._scale * width / 2)
        left, right = round(self._middle[0] - halves[0]), round(self._middle[0] + halves[0])
        top, bottom = round(self._middle[1] - halves[1]), round(self._middle[1] + halves[1])
        field = canvas[top:bottom, left:right]
        field[:] = _GRASS
        stripes = (np.arange(right - left) * 10 // max(right - left, 1)) % 2 == 1
        field[:, stripes] = _STRIPE
        corners = [(left, top), (right, top), (right, bottom), (left, bottom)]
        for begin, end in zip(corners, corners[1:] + corners[:1], strict=True):
            paint_stroke(canvas, _CHALK, begin, end, 2.5)
        return canvas

    def _draw_trails(self, canvas: Canvas, trail: NDArray[np.float64]) -> None:
        n = self._keepers + self._takers
        if trail.ndim != 3 or trail.shape[1:] != (n + 1, 2):
            raise InputError(f"trail must have the shape (times, {n + 1}, 2), got {trail.shape}")
        if len(trail) < 2:
            return
        pixels = np.asarray(self._middle) + self._scale * trail
        for thing in range(n + 1):
            color = _CHALK if thing == n else _KEEPER if thing < self._keepers else _TAKER
            paint_trail(canvas[: self._panel], color, pixels[:, thing], longest=2.0 * LONGEST)

    def _draw_choice(self, canvas: Canvas, players: NDArray[np.float64], actor: int, receiver: int) -> None:
        begin = self._pixel(players[actor])
        paint_ring(canvas, _CHOICE, begin, max(_KICKABLE * self._scale, _RADIUS + 6.0), 1.0)
        if receiver < 0:
            return
        end = self._pixel(players[receiver])
        span = math.dist(begin, end)
        if span < 4 * _RADIUS:
            return
        along = ((end[0] - begin[0]) / span, (end[1] - begin[1]) / span)
        tip = (end[0] - (_RADIUS + 6) * along[0], end[1] - (_RADIUS + 6) * along[1])
        paint_stroke(canvas, _CHOICE, begin, tip, 1.5)
        for side in (-1.0, 1.0):
            barb = (-along[0] * 10 - side * along[1] * 6, -along[1] * 10 + side * along[0] * 6)
            paint_stroke(canvas, _CHOICE, tip, (tip[0] + barb[0], tip[1] + barb[1]), 1.5)

    def _draw_player(self, canvas: Canvas, player: int, state: NDArray[np.float64]) -> None:
        keeper = player < self._keepers
        spot, body = self._pixel(state), math.radians(float(state[4]))
        along = (math.cos(body), math.sin(body))
        nose = (spot[0] + (_RADIUS + 5) * along[0], spot[1] + (_RADIUS + 5) * along[1])
        paint_stroke(canvas, _INK, spot, nose, 2.0)
        paint_stroke(canvas, _INK, spot, spot, _RADIUS)
        paint_stroke(canvas, _KEEPER if keeper else _TAKER, spot, spot, _RADIUS - 1.5)
        if keeper:
            write(canvas, str(player + 1), spot, size=12, bold=True, color=_INK)

    def _draw_actions(self, canvas: Canvas, order: list[int], action: int, values: ArrayLike | None) -> None:
        numbers = None if values is None else np.asarray(values, dtype=np.float64)
        if numbers is not None and numbers.shape != (self._keepers,):
            raise InputError(f"values must have the shape ({self._keepers},), got {numbers.shape}")
        shares = np.zeros(self._keepers) if numbers is None else _shares(numbers)
        # The last bar ends where the field does.
        span = (self.shape[1] - 2 * _MARGIN + _GAP) / self._columns
        for choice, player in enumerate(order):
            left = _MARGIN + span * (choice % self._columns)
            row = self._panel + _ROW * (choice // self._columns) + 8.0
            color = _CHOICE if choice == action else _GREY
            name = "hold" if choice == 0 else f"pass to {player + 1}"
            write(canvas, name, (left, row), size=12, side=-1.0, color=color, bold=choice == action)
            if numbers is None:
                continue
            right = left + span - _GAP
            write(canvas, _brief(float(numbers[choice])), (right, row), size=12, side=1.0, color=color)
            below = row + 15
            paint_stroke(canvas, _TRACK, (left + 2, below), (right - 2, below), 2.5)
            if shares[choice] > 0:
                paint_stroke(
                    canvas,
                    color,
                    (left + 2, below),
                    (left + 2 + shares[choice] * (right - left - 4), below),
                    2.5,
                )


def _even(pixels: float) -> int:
    # Video codecs want even sides.
    return 2 * round(pixels / 2)


def _shares(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the lengths of bars: from 0 if all values are positive, else from a little below the least."""
    finite = values[np.isfinite(values)]
    if not len(finite):
        return np.zeros(len(values))
    low, high = float(finite.min()), float(finite.max())
    zero = 0.0 if low >= 0 else low - 0.1 * (high - low)
    if high <= zero:
        return np.zeros(len(values))
    return np.clip(np.nan_to_num((values - zero) / (high - zero), nan=0.0), 0.0, 1.0)


def _brief(value: float) -> str:
    return f"{value:.3g}".replace("-", "\N{MINUS SIGN}") if math.isfinite(value) else "?"
