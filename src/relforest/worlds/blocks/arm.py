"""The stages of the options: grasp, lift, carry sideways, lower, drop.

Every stage is cut off after 500 steps, and the next one continues from wherever the block is. Failure is not
signalled: if the grasp never succeeds, or the block falls off the table, the stages that carry it end at
once. A stage sets its goal when it begins, from the state at that time and with an error of its own. All
numbers are those of the author's simulator.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

from relforest.worlds.blocks.handling import Handling, spread
from relforest.worlds.blocks.overlap import overlapping
from relforest.worlds.blocks.simulation import MAX_STAGE_STEPS, STEPS_PER_SECOND, BlocksSimulation

LIFT_CLEARANCE: Final = 5.0
"""A block is lifted so that its lowest point is this much above all blocks, itself included."""

DROP_CLEARANCE: Final = 2.0
"""A block is let go this much above what is below it."""

SWING_POINT: Final = 0.7
"""A block is grasped here to rotate it, in half sides from its centre."""

FARTHEST_GOAL: Final = 200.0
"""A goal farther than this from the origin, along either axis, is given up."""

MOST_TRIES: Final = 30
"""Points tried in one step to find one inside the block."""

Point = tuple[float, float]


@final
@dataclass(frozen=True, slots=True)
class OptionResult:
    """How an option went.

    Parameters
    ----------
    duration : float
        Seconds on the clock of the tasks, from the choice to the end.
    steps : int
        The same in steps of 0.01 s.
    timeouts : int
        Stages that were cut off after 500 steps.
    grasped : bool
        Whether the block was held at all; also False for an option that did not need to hold it.
    """

    duration: float
    steps: int
    timeouts: int
    grasped: bool


@final
class Arm:
    """The robot while it handles the block with this id, as precisely as `Handling` says; it changes ``sim``.

    Raises
    ------
    InputError
        If the block is not on the table.
    """

    def __init__(self, sim: BlocksSimulation, block: int, handling: Handling) -> None:
        sim.index(block)
        self._sim = sim
        self._block = block
        self._handling = handling
        self._start = sim.steps
        self._timeouts = 0
        self._grasped = False

    @property
    def x(self) -> float:
        """Where the block is now."""
        return self._sim.pose(self._block)[0]

    def grasp(self) -> None:
        """Hold the block near its centre."""
        noise, rng = self._handling.noise.grasp, self._sim.rng

        def near_centre() -> Point:
            angle = self._sim.pose(self._block)[2]
            x, y = spread(rng, noise)
            cosine, sine = math.cos(angle), math.sin(angle)
            return cosine * x + sine * y, cosine * y - sine * x

        self._grasp(near_centre)

    def grasp_to_turn(self) -> None:
        """Hold the block near an end of its more horizontal axis, so that it swings when it is lifted.

        Which axis that is depends on the angle alone: the block turns by a right angle whatever its shape.
        """

        def near_end() -> Point:
            half_width, half_height = self._half_extents()
            sign = 1.0 if self._half_turns() >= 0 else -1.0
            turned = self._is_turned()
            half = half_height if turned else half_width
            x, y = spread(self._sim.rng, self._handling.noise.rotate * half)
            if turned:
                return x, y - sign * SWING_POINT * half
            return x + sign * SWING_POINT * half, y

        self._grasp(near_end)

    def lift(self) -> None:
        """Lift the block above all blocks."""

        def above_all() -> Point:
            x, y, _ = self._sim.pose(self._block)
            bounds = self._sim.bounds.tolist()
            bottom = bounds[self._sim.index(self._block)][2]
            return x, y + max(0.0, *(top for _, _, _, top in bounds)) + LIFT_CLEARANCE - bottom

        self._carry(above_all)

    def lift_to_turn(self) -> None:
        """Lift the block high enough to swing."""

        def by_its_length() -> Point:
            x, y, _ = self._sim.pose(self._block)
            return x, y + 2 * self._half_extents()[self._is_turned()]

        self._carry(by_its_length)

    def sideways(self, x: Callable[[], float]) -> None:
        """Carry the block to an x that is computed when the stage begins."""
        self._carry(lambda: (x(), self._sim.pose(self._block)[1]))

    def lower(self, x: Callable[[], float]) -> None:
        """Lower the block until it is just above those below it, at an x that is computed now."""

        def just_above() -> Point:
            bounds, i = self._sim.bounds.tolist(), self._sim.index(self._block)
            below = overlapping(bounds, i, overlap=self._handling.overlap)
            top = max([0.0, *(bounds[other][3] for other in below)])
            distance = max(0.0, bounds[i][2] - (top + DROP_CLEARANCE))
            return x(), self._sim.pose(self._block)[1] - distance

        self._carry(just_above)

    def drop(self) -> OptionResult:
        """Let the block go, wait until all blocks are at rest, and return how the option went."""
        self._sim.let_go()
        steps = self._sim.wait_for_rest(MAX_STAGE_STEPS)
        self._timeouts += steps == MAX_STAGE_STEPS and not self._sim.at_rest
        return self.finish()

    def wait(self, steps: int) -> OptionResult:
        """Do nothing for some steps, and return how the option went."""
        self._sim.step(steps)
        return self.finish()

    def finish(self) -> OptionResult:
        """Return how the option went; detecting its end takes one more step."""
        self._sim.step(1)
        steps = self._sim.steps - self._start
        return OptionResult(steps / STEPS_PER_SECOND, steps, self._timeouts, self._grasped)

    def _grasp(self, draw: Callable[[], Point]) -> None:
        """Hold the block at the first point drawn that lies inside it."""
        for _ in range(MAX_STAGE_STEPS):
            if self._block not in self._sim:
                return
            half_width, half_height = self._half_extents()
            points = (draw() for _ in range(MOST_TRIES))
            point = next(((x, y) for x, y in points if abs(x) <= half_width and abs(y) <= half_height), None)
            if point is not None:
                self._sim.grab(self._block, point)
                self._grasped = True
            self._sim.step(1)
            if point is not None:
                return
        self._timeouts += 1

    def _carry(self, goal: Callable[[], Point]) -> None:
        """Carry the block close to a goal, which is computed only if the block is held."""
        if self._sim.held != self._block:
            return
        goal_x, goal_y = goal()
        error_x, error_y = spread(self._sim.rng, self._handling.noise.carry)
        x, y = goal_x + error_x, goal_y + error_y
        if max(abs(x), abs(y)) <= FARTHEST_GOAL:
            _, ended = self._sim.carry((x, y), MAX_STAGE_STEPS)
            self._timeouts += not ended

    def _half_extents(self) -> tuple[float, float]:
        return self._sim.blocks[self._sim.index(self._block)].half_extents

    def _half_turns(self) -> float:
        """Return the angle of the block, from -1 to 1."""
        return math.remainder(self._sim.pose(self._block)[2] / math.pi, 2.0)

    def _is_turned(self) -> bool:
        """Return whether the block's own horizontal axis is nearer the vertical."""
        return abs(abs(self._half_turns()) - 0.5) < 0.25
