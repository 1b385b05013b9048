"""A world of a user's own, as small as one can be: a disc that rolls right and left."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, final

import numpy as np

from relforest.playing.frames import Frame, Stage, Thing
from relforest.playing.shapes import Chip, Circle, Line, Polygon, Shape, Text, Words
from relforest.scenes import Attribute, Schema
from relforest.smdp import ActionType, Decision

DISC: tuple[Shape, ...] = (
    Circle((0.0, 0.0), 0.5, "disc", "ink", 0.1),
    Text("d", (0.0, 0.0), 0.5, halo="disc"),
)
STAGE = Stage(
    (-5.0, 5.0, -1.0, 4.0),
    (
        Line(((-5.0, -0.5), (5.0, -0.5)), "grey", 0.1),
        Polygon(((4.0, 0.0), (4.5, 0.0), (4.5, 1.0)), "#ff0000"),
    ),
    {"disc": ("#0000ff", "#8888ff")},
    rate=2.0,
    score_name="place",
    legend="A disc.",
)


@final
class ToyWorld:
    """Moves by 1 in a second, and shows a frame in between."""

    schema = Schema((Attribute("location", 1),))
    action_types = (ActionType("left"), ActionType("right"))
    discount = 1.0
    stage = STAGE

    def __init__(self, length: int = 3) -> None:
        self.length = length
        self.see: Callable[[Frame], None] | None = None
        self.seed: int | None = None
        self.x, self.time = 0.0, 0

    @property
    def unwrapped(self) -> ToyWorld:
        return self

    def watch(self, see: Callable[[Frame], None] | None) -> None:
        self.see = see

    def say(self, position: int) -> Words:
        return ("roll ", Chip(("left", "right")[position], "disc"))

    def named(self, position: int) -> tuple[str, Words] | None:
        return ("disc", (Chip("d", "disc"),)) if position == 0 else None

    def decision(self) -> Decision:
        types = np.arange(2 if self.time < self.length else 0)
        return Decision(np.array([[self.x]]), types, np.empty((len(types), 0), dtype=np.int64), types)

    def frame(self, time: float, x: float) -> Frame:
        notes: tuple[Shape, ...] = (Line(((x, 1.0), (x, 2.0)), "choice", 0.1, dashed=True, arrow=True),)
        things = (Thing("disc", DISC, x, 0.0, 3.0 * x, "disc"),)
        return Frame(
            time, things, notes if x > 1 else (), f"at {x:g}", x, "disc" if x > 0 else "", ((f"x {x}",),)
        )

    def show(self, time: float, x: float) -> None:
        if self.see is not None:
            self.see(self.frame(time, x))

    def reset(self, *, seed: int | None = None) -> tuple[None, dict[str, Any]]:
        self.x, self.time, self.seed = 0.0, 0, seed
        self.show(0.0, 0.0)
        return None, {}

    def step(self, action: int, /) -> tuple[None, float, bool, bool, dict[str, Any]]:
        moved = 2 * action - 1
        self.show(self.time + 0.5, self.x + moved / 2)
        self.x, self.time = self.x + moved, self.time + 1
        self.show(self.time, self.x)
        ended = self.time >= self.length
        return None, float(moved), ended, False, {"end": "over"} if ended else {}
