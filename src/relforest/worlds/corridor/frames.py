"""What there is to see of a corridor: the floor, the rewarded windows, the agent and the elapsed time."""

from __future__ import annotations

import math
from typing import Final

from relforest.playing.frames import Frame, Stage, Thing
from relforest.playing.shapes import Circle, Line, Point, Polygon, Shape
from relforest.worlds.corridor.dynamics import reward
from relforest.worlds.corridor.state import CorridorState

COLORS: Final = {
    "floor": ("#e1e5eb", "#2a2f35"),
    "window": ("#b2dfc8", "#2c5140"),
    "lit": ("#58be8c", "#3f9c70"),
    "rule": ("#a6aebb", "#69707c"),
    "agent": ("#265496", "#7fa9e8"),
    "clock": ("#d6963a", "#d6963a"),
}

_HALF: Final = 0.05
# The floor reaches beyond the ends of the corridor so that the agent stands on it at an edge.
_BEYOND: Final = 0.048
_CLOCK: Final = 0.115
_AGENT: Final[tuple[Shape, ...]] = (Circle((0.0, 0.0), 0.034, "agent", "card", 0.005),)


def corridor_stage(window: float) -> Stage:
    """Return the stage of a corridor of length 1 with rewarded windows of this width at both ends."""
    tenths = [(tenth / 10, -0.095 if tenth % 5 == 0 else -0.085) for tenth in range(11)]
    ticks = [Line(((x, -0.07), (x, low)), "rule", 0.004) for x, low in tenths]
    middle = Line(((0.5, -_HALF), (0.5, _HALF)), "rule", 0.004, dashed=True)
    floor = Polygon(_ground(-_BEYOND, 1 + _BEYOND, round_left=True, round_right=True), "floor")
    windows = [_window(window, color="window", left=left) for left in (True, False)]
    clock = Line(((0.0, _CLOCK), (1.0, _CLOCK)), "floor", 0.012)
    return Stage(
        (-0.08, 1.08, -0.13, 0.19),
        (floor, *windows, middle, *ticks, clock),
        COLORS,
        rate=2.0,
        legend="The agent is rewarded for ending a step in a green window. The bar is the elapsed time.",
    )


def corridor_frame(state: CorridorState, *, window: float, max_steps: int) -> Frame:
    """Return a state; the bar of time is full after ``max_steps``, and a window lights up while it pays."""
    used = min(state.steps / max_steps, 1.0)
    clock = (Line(((0.0, _CLOCK), (used, _CLOCK)), "clock", 0.012),) if used else ()
    pays = reward(state.x, window=window) > 0
    lit = (_window(window, color="lit", left=state.x <= window),) if pays and window else ()
    return Frame(
        time=float(state.steps),
        things=(
            Thing("light", (*clock, *lit), 0.0, 0.0),
            Thing("agent", _AGENT, state.x, 0.0),
        ),
        band="lit" if pays else "",
    )


def _window(width: float, *, color: str, left: bool) -> Polygon:
    if left:
        return Polygon(_ground(-_BEYOND, width, round_left=True), color)
    return Polygon(_ground(1 - width, 1 + _BEYOND, round_right=True), color)


def _ground(
    left: float, right: float, *, round_left: bool = False, round_right: bool = False
) -> tuple[Point, ...]:
    """Return a part of the floor, with round or straight ends."""
    return (*_end(left, 1.0, is_round=round_left), *_end(right, -1.0, is_round=round_right))


def _end(x: float, inwards: float, *, is_round: bool) -> tuple[Point, ...]:
    if not is_round:
        return (x, inwards * -_HALF), (x, inwards * _HALF)
    turns = [math.pi * step / 16 for step in range(17)]
    return tuple(
        (x + inwards * _HALF * (1 - math.sin(turn)), -inwards * _HALF * math.cos(turn)) for turn in turns
    )
