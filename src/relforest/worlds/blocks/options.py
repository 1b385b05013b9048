"""The robot's options: put, rotate, isolate, move and done, each run from its beginning to its end.

They are described in Palmer (2015), sections 7.4.1 to 7.4.3; the numbers are those of the author's simulator.
An option always ends, after 5 stages of 5 s at the latest, and blocks that fall off the table are gone; `arm`
describes what the stages do when something goes wrong.

All change the simulation that they are given, name blocks by their ids, and take how the robot handles them.
They raise InputError if a block is not on the table or another argument is impossible, before anything moves.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from relforest.support.errors import InputError
from relforest.support.options import in_range
from relforest.worlds.blocks.arm import Arm, OptionResult
from relforest.worlds.blocks.handling import Handling
from relforest.worlds.blocks.overlap import overlapping, widest_gap
from relforest.worlds.blocks.simulation import STEPS_PER_SECOND, BlocksSimulation

GAP_BUFFER: Final = 2.0
"""Room on both sides of a block that is isolated between others."""

SIDE_BUFFER: Final = 4.0
"""Room towards the others for a block that is isolated beyond all of them."""

WAIT_MEAN: Final = 1.0
WAIT_DEVIATION: Final = 0.2
SHORTEST_WAIT: Final = 0.5
"""Options without physical effect take a Gaussian time in seconds, redrawn if shorter than this."""

_HANDLING = Handling()


def put(sim: BlocksSimulation, a: int, b: int, *, handling: Handling = _HANDLING) -> OptionResult:
    """Lift block a, carry it above block b, lower it and let it go.

    Blocks on top of a are carried along or thrown off, and a comes down on whatever lies on b. If b falls off
    the table in the meantime, a is lowered where it is. Both blocks must be on the table, and differ.
    """
    sim.index(b)
    if a == b:
        raise InputError(f"a block cannot be put on itself, got {a!r} twice: name two blocks")
    arm = Arm(sim, a, handling)

    def above_b() -> float:
        return sim.pose(b)[0] if b in sim else arm.x

    return _carried(arm, above_b)


def move(sim: BlocksSimulation, a: int, x: float, *, handling: Handling = _HANDLING) -> OptionResult:
    """Lift block a, carry it to x, lower it and let it go: `put` with a place instead of a block.

    Parameters
    ----------
    x : float
        Any finite number. Beyond the table, the block falls off and is gone; more than 200 from the middle,
        the robot gives up and drops the block where it was lifted.
    """
    target = in_range("x", x, -math.inf, math.inf, open_low=True, open_high=True)
    return _carried(Arm(sim, a, handling), lambda: target)


def rotate(sim: BlocksSimulation, a: int, *, handling: Handling = _HANDLING) -> OptionResult:
    """Lift block a by one end, so that it swings by a right angle, lower it and let it go.

    Which end depends on the angle of the block, not on its shape: upright blocks are laid down in the same
    way.
    """
    arm = Arm(sim, a, handling)
    arm.grasp_to_turn()
    arm.lift_to_turn()
    arm.lower(lambda: arm.x)
    return arm.drop()


def isolate(sim: BlocksSimulation, a: int, *, handling: Handling = _HANDLING) -> OptionResult:
    """Carry block a to where no other block is above or below it; if it already is there, only wait.

    It goes to the middle of the widest gap between the others if that leaves 2 units on both sides, and
    otherwise beyond all of them, on the side where the outermost block is closer to the middle of the table.
    """
    arm = Arm(sim, a, handling)
    if not overlapping(sim.bounds.tolist(), sim.index(a), overlap=handling.overlap):
        return arm.wait(_waiting_steps(sim.rng))
    arm.grasp()
    arm.lift()
    arm.sideways(lambda: _free_place(sim, a))
    arm.lower(lambda: arm.x)
    return arm.drop()


def done(sim: BlocksSimulation) -> OptionResult:
    """Wait for about a second, as the author's simulator does when the robot says that it is done.

    Only time passes; the task decides what ``done`` means.
    """
    start = sim.steps
    sim.step(_waiting_steps(sim.rng) + 1)
    steps = sim.steps - start
    return OptionResult(steps / STEPS_PER_SECOND, steps, 0, grasped=False)


def _carried(arm: Arm, x: Callable[[], float]) -> OptionResult:
    arm.grasp()
    arm.lift()
    arm.sideways(x)
    arm.lower(x)
    return arm.drop()


def _waiting_steps(rng: np.random.Generator) -> int:
    seconds = 0.0
    while seconds < SHORTEST_WAIT:
        seconds = rng.normal(WAIT_MEAN, WAIT_DEVIATION)
    return math.ceil(seconds * STEPS_PER_SECOND)


def _free_place(sim: BlocksSimulation, a: int) -> float:
    """Return where block a can be set down without blocks above or below it."""
    others: list[tuple[float, float]] = [(left, right) for left, right, _, _ in sim.bounds.tolist()]
    own_left, own_right = others.pop(sim.index(a))
    if not others:
        return sim.pose(a)[0]
    width = own_right - own_left
    begin, end = widest_gap(others)
    if end - begin >= width + 2 * GAP_BUFFER:
        return (begin + end) / 2
    left, right = min(left for left, _ in others), max(right for _, right in others)
    if abs(left) < abs(right):
        return left - SIDE_BUFFER - width / 2
    return right + SIDE_BUFFER + width / 2
