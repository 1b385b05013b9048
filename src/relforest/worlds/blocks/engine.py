"""Rigid boxes on a table: the only module that knows Box2D.

A step is 0.01 s on the clock of the tasks, while the physics advances by `PHYSICS_STEP`: the author's
simulator runs twice as fast as its clock, and all constants here are its constants. Speeds in this module
refer to physics time.

The loops below cost little more than the steps of Box2D, because they test only what is necessary after each
step: the box that was last seen moving is tested for rest first, and falling boxes are looked for only when
one could have reached the edge of the table.
"""

from __future__ import annotations

import math
import warnings
from array import array
from collections.abc import Callable, Sequence
from functools import wraps
from typing import Any, Concatenate, Final, NamedTuple, ParamSpec, TypeAlias, TypeVar, final

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.support.options import in_range
from relforest.worlds.blocks.box import Box, box_of, shared

with warnings.catch_warnings():
    # Its wrapper emits a warning on import, and breaks if a filter turns the warning into an error.
    warnings.simplefilter("ignore", DeprecationWarning)
    import Box2D

PHYSICS_STEP: Final = 0.02
"""Seconds by which the physics advances in one step."""

ITERATIONS: Final = 10
GRAVITY: Final = 10.0
DENSITY: Final = 1.0
FRICTION: Final = 0.5
RESTITUTION: Final = 0.025

TABLE_HALF_WIDTH: Final = 100.0
TABLE_HALF_HEIGHT: Final = 1.5

LOST: Final = -5.0
"""A box that is entirely below this y is lost and removed; the top of the table is at 0."""

HALF_SIDES: Final = (0.01, 100.0)
"""Bounds of half the side of a box: the smallest is the distance at which Box2D considers boxes to touch."""

FARTHEST: Final = 1000.0
"""Boxes may be placed and carried up to this far from the origin, along each axis."""

REST_SPEED: Final = 0.005
REST_SPIN: Final = 0.01 * math.pi
"""A box is at rest below both: units and radians per second of the physics."""

ARRIVED: Final = 0.01
"""A carried box has arrived when its centre is closer to the goal than this, and slower than `REST_SPEED`."""

# Box2D does not move a box farther in one step, except to push overlapping boxes apart.
_LONGEST_MOVE = 2.0


class Spring(NamedTuple):
    """One of the springs that hold a box."""

    point: tuple[float, float]  # where it is attached, in the box's own coordinates
    max_force: float
    frequency: float  # Hz
    damping: float  # damping ratio


class _Grip(NamedTuple):
    """What holds a box."""

    key: int
    point: tuple[float, float]  # where the main spring is attached, in the box's own coordinates
    joints: tuple[Any, ...]  # of Box2D
    main: memoryview[float]  # x, y of the place that the main spring pulls its point to
    supports: tuple[tuple[memoryview[float], float, float], ...]  # of two more, and their x, y from there


_Call: TypeAlias = tuple[str, tuple[Any, ...], dict[str, Any]]
_Calls: TypeAlias = tuple[_Call, ...]
_P = ParamSpec("_P")
_R = TypeVar("_R")


@final
class History:
    """The calls that made an engine what it is, from the outside; ``is_open`` during one of them."""

    def __init__(self) -> None:
        self.calls: list[_Call] = []
        self.is_open = False


def _remembered(
    method: Callable[Concatenate[Engine, _P], _R],
) -> Callable[Concatenate[Engine, _P], _R]:
    """Let an engine remember the calls of a method from outside, so that it can be copied."""

    @wraps(method)
    def called(engine: Engine, /, *arguments: _P.args, **options: _P.kwargs) -> _R:
        if engine.history.is_open:
            return method(engine, *arguments, **options)
        engine.history.is_open = True
        try:
            result = method(engine, *arguments, **options)
        finally:
            engine.history.is_open = False
        engine.history.calls.append((method.__name__, arguments, options))
        return result

    return called


def _replayed(half_width: float, calls: _Calls) -> Engine:
    """Return an engine for which everything has been done again."""
    engine = Engine(table_half_width=half_width)
    for name, arguments, options in calls:
        getattr(engine, name)(*arguments, **options)
    return engine


@final
class Engine:
    """A table with boxes that fall, collide, come to rest, and can be held by springs.

    Parameters
    ----------
    table_half_width : float
        The table reaches from minus to plus this x; its top is at y = 0.

    Raises
    ------
    InputError
        If the width of the table is not finite and positive.

    Notes
    -----
    On one machine, the same calls give the same numbers, bit for bit. Boxes that fall off the table are
    removed (see `LOST`); ``keys`` lists the remaining ones.
    """

    def __init__(self, *, table_half_width: float = TABLE_HALF_WIDTH) -> None:
        half_width = in_range("table_half_width", table_half_width, 0, FARTHEST, open_low=True)
        self._edge = half_width
        self._world = Box2D.b2World(gravity=(0.0, -GRAVITY), doSleep=True)
        table = self._world.CreateStaticBody(position=(0.0, -TABLE_HALF_HEIGHT))
        table.CreatePolygonFixture(
            box=(half_width, TABLE_HALF_HEIGHT), friction=FRICTION, restitution=RESTITUTION
        )
        # Springs need a second body. Fastened to the table they would let the box pass through it.
        self._anchor = self._world.CreateStaticBody()
        self._boxes: dict[int, Box] = {}
        self._next_key = 0
        self._grip: _Grip | None = None
        self._released: tuple[float, float] | None = None
        self._sure_steps = 0
        self.history = History()
        self._step: Callable[[float, int, int], None] = self._world.Step

    def __reduce__(self) -> tuple[Callable[[float, _Calls], Engine], tuple[float, _Calls]]:
        """Copy by doing everything again: boxes are memory of Box2D, but equal calls have equal effects."""
        return _replayed, (self._edge, tuple(self.history.calls))

    @property
    def keys(self) -> tuple[int, ...]:
        """Keys of the remaining boxes, in the order in which they were added."""
        return tuple(self._boxes)

    @property
    def held(self) -> int | None:
        """Key of the box that is held, or None."""
        return None if self._grip is None else self._grip.key

    @property
    def tool(self) -> tuple[float, float] | None:
        """X and y of the point where a box is held, or was last held; None before the first grasp."""
        if self._grip is None:
            return self._released
        box, (x, y) = self._boxes[self._grip.key], self._grip.point
        sine, cosine = box.rotation
        return box.centre[0] + cosine * x - sine * y, box.centre[1] + sine * x + cosine * y

    @_remembered
    def add_box(
        self, half_extents: tuple[float, float], position: tuple[float, float], angle: float = 0.0
    ) -> int:
        """Add a box at rest and return its key; keys count from 0 and are never reused.

        Parameters
        ----------
        half_extents : tuple of float
            Half the width and half the height at angle 0.
        position : tuple of float
            Of the centre. Overlapping boxes are pushed apart over time.
        angle : float
            Radians, counter-clockwise.

        Raises
        ------
        InputError
            If a number is out of bounds.
        """
        width, height = (in_range("half extent", half, *HALF_SIDES) for half in half_extents)
        x, y = (in_range("position", along, -FARTHEST, FARTHEST) for along in position)
        body = self._world.CreateDynamicBody(
            position=(x, y), angle=in_range("angle", angle, -FARTHEST, FARTHEST)
        )
        key = self._next_key
        self._next_key += 1
        body.CreatePolygonFixture(
            box=(width, height), density=DENSITY, friction=FRICTION, restitution=RESTITUTION, userData=key
        )
        self._boxes[key] = box_of(body, (width, height))
        self._sure_steps = 0
        return key

    @_remembered
    def remove(self, key: int) -> None:
        """Take a box away, letting go of it first if it is held.

        Raises
        ------
        InputError
            If the box does not exist.
        """
        box = self._box(key)
        if self.held == key:
            self.let_go()
        del self._boxes[key]
        self._world.DestroyBody(box.body)

    def poses(self) -> NDArray[np.float64]:
        """Return (n, 3): x, y and angle of each box (radians, not wrapped), in the order of `keys`."""
        rows = [(*box.centre, box.body.angle) for box in self._boxes.values()]
        return np.array(rows, dtype=np.float64).reshape(-1, 3)

    def velocities(self) -> NDArray[np.float64]:
        """Return (n, 3): velocity x and y, and spin, of each box, per second of the physics."""
        rows = [tuple(box.velocity) for box in self._boxes.values()]
        return np.array(rows, dtype=np.float64).reshape(-1, 3)

    def bounds(self) -> NDArray[np.float64]:
        """Return (n, 4): smallest and largest x, smallest and largest y of each rotated box."""
        rows = [box.bounds() for box in self._boxes.values()]
        return np.array(rows, dtype=np.float64).reshape(-1, 4)

    def pose(self, key: int) -> tuple[float, float, float]:
        """Return x, y and angle of one box.

        Raises
        ------
        InputError
            If the box does not exist.
        """
        box = self._box(key)
        return box.centre[0], box.centre[1], box.body.angle

    def is_resting(self, *, speed: float = REST_SPEED, spin: float = REST_SPIN) -> bool:
        """Return whether all boxes are slower than both: units and radians per second of the physics."""
        return not any(box.is_moving(speed, spin) for box in self._boxes.values())

    def contacts(self) -> frozenset[tuple[int, int]]:
        """Return the pairs of boxes that touch, the smaller key first; the table is left out."""
        pairs = set()
        for contact in self._world.contacts:
            if contact.touching:
                first, second = contact.fixtureA.userData, contact.fixtureB.userData
                if first is not None and second is not None:
                    pairs.add((min(first, second), max(first, second)))
        return frozenset(pairs)

    @_remembered
    def step(self, n: int = 1) -> None:
        """Advance by n steps, removing the boxes that fall off the table."""
        step = self._step
        while n > 0:
            burst = self._burst(n)
            for _ in range(burst):
                step(PHYSICS_STEP, ITERATIONS, ITERATIONS)
            n -= burst
            self._account(burst)

    @_remembered
    def settle(
        self, max_steps: int, *, speed: float = REST_SPEED, spin: float = REST_SPIN
    ) -> tuple[int, bool]:
        """Advance until all boxes are at rest, by at least one step.

        Return the steps taken, and whether all boxes are at rest.

        Parameters
        ----------
        max_steps : int
            Stop after this many steps.
        speed, spin : float
            A box is at rest below both; ``math.inf`` to ignore one of them.
        """
        taken = 0
        while taken < max_steps:
            burst = self._burst(max_steps - taken)
            steps, resting = self._settle_burst(burst, speed, spin)
            taken += steps
            lost = self._account(steps)
            if resting or (lost and self.is_resting(speed=speed, spin=spin)):
                return taken, True
        return taken, False

    @_remembered
    def grab(self, key: int, springs: Sequence[Spring]) -> None:
        """Hold a box by springs attached at its present location, releasing any other box.

        The first spring is the main one, which moves the box.

        Raises
        ------
        InputError
            If the box does not exist, or the number of springs is not 1, 2 or 3.
        """
        box = self._box(key)
        if not 1 <= len(springs) <= 3:
            raise InputError(f"a box is held by 1 to 3 springs, got {len(springs)}")
        self.let_go()
        box.body.awake = True
        joints = tuple(self._fasten(box, spring) for spring in springs)
        main, *others = (shared(joint.target, *joint.target) for joint in joints)
        supports = [(target, target[0] - main[0], target[1] - main[1]) for target in others]
        # Springs that are missing pull at nothing, so that there are always two.
        nowhere: memoryview[Any] = memoryview(array("f", (0.0, 0.0)))
        supports += [(nowhere, 0.0, 0.0)] * (2 - len(supports))
        self._grip = _Grip(key, springs[0].point, joints, main, tuple(supports))

    @_remembered
    def let_go(self) -> None:
        """Release the box that is held, if any."""
        if self._grip is not None:
            self._released = self.tool
            for joint in self._grip.joints:
                self._world.DestroyJoint(joint)
            self._grip = None

    @_remembered
    def carry(self, goal: tuple[float, float], max_steps: int) -> tuple[int, bool]:
        """Pull the held box until its centre has arrived at the goal or the box is lost.

        In each step the springs aim at where their points would be if the centre were at the goal and the box
        kept its angle.

        Return the steps taken (0 if nothing is held), and whether the end came before ``max_steps`` ran out.

        Parameters
        ----------
        goal : tuple of float
            Target of the centre.
        max_steps : int
            Stop after this many steps.

        Raises
        ------
        InputError
            If the goal is not finite, or too far away.
        """
        x, y = (in_range("goal", along, -FARTHEST, FARTHEST) for along in goal)
        taken = 0
        while taken < max_steps and self._grip is not None:
            steps, arrived = self._carry_burst(self._grip, x, y, self._burst(max_steps - taken))
            taken += steps
            self._account(steps)
            if arrived:
                return taken, True
        return taken, self._grip is None

    def _settle_burst(self, steps: int, speed: float, spin: float) -> tuple[int, bool]:
        step, boxes = self._step, list(self._boxes.values())
        square = speed * speed
        # The box that was last seen moving is probably still moving.
        last = boxes[-1] if boxes else None
        for taken in range(1, steps + 1):
            step(PHYSICS_STEP, ITERATIONS, ITERATIONS)
            if last is not None:
                x, y, turn = last.velocity
                if x * x + y * y >= square or abs(turn) >= spin:
                    continue
            last = next((box for box in boxes if box.is_moving(speed, spin)), None)
            if last is None:
                return taken, True
        return steps, False

    def _carry_burst(self, grip: _Grip, x: float, y: float, steps: int) -> tuple[int, bool]:
        step, box = self._step, self._boxes[grip.key]
        centre, velocity, rotation = box.centre, box.velocity, box.rotation
        (point_x, point_y), main = grip.point, grip.main
        (left, left_x, left_y), (right, right_x, right_y) = grip.supports
        left_x, left_y, right_x, right_y = x + left_x, y + left_y, x + right_x, y + right_y
        dt, iterations, low, high = PHYSICS_STEP, ITERATIONS, x - ARRIVED, x + ARRIVED
        for taken in range(1, steps + 1):
            sine, cosine = rotation
            turned_x = cosine * point_x - sine * point_y
            turned_y = sine * point_x + cosine * point_y
            if not velocity[0] and not velocity[1]:
                # It may be asleep; setting a target wakes it.
                grip.joints[0].target = (x + turned_x, y + turned_y)
            main[0] = x + turned_x
            main[1] = y + turned_y
            left[0] = left_x + turned_x
            left[1] = left_y + turned_y
            right[0] = right_x + turned_x
            right[1] = right_y + turned_y
            step(dt, iterations, iterations)
            if low < centre[0] < high:
                miss_x, miss_y = centre[0] - x, centre[1] - y
                speed_x, speed_y = velocity[0], velocity[1]
                if (
                    miss_x * miss_x + miss_y * miss_y < ARRIVED * ARRIVED
                    and speed_x * speed_x + speed_y * speed_y < REST_SPEED * REST_SPEED
                ):
                    return taken, True
        return steps, False

    def _burst(self, steps: int) -> int:
        """Return how many of the steps can be taken before the next search for falling boxes."""
        if self._sure_steps < 1:
            self._look_for_falling()
        return min(steps, self._sure_steps)

    def _account(self, steps: int) -> bool:
        """Remove the boxes that were lost in these steps; return whether any were."""
        before = len(self._boxes)
        self._sure_steps -= steps
        if self._sure_steps < 1:
            self._look_for_falling()
        return len(self._boxes) < before

    def _look_for_falling(self) -> None:
        """Remove the boxes that are lost, and compute for how many steps no other box can be lost."""
        room = self._edge
        for key, box in tuple(self._boxes.items()):
            x, y = box.centre
            if y > 0:
                # Above the table a box stays above it until its centre has passed the edge.
                if abs(x) > self._edge - room:
                    room = self._edge - abs(x)
            elif y >= LOST or box.bounds()[3] >= LOST:
                room = 0.0
            else:
                self.remove(key)
        self._sure_steps = max(1, int(room / _LONGEST_MOVE))

    def _fasten(self, box: Box, spring: Spring) -> Any:  # noqa: ANN401 - Box2D ships no types
        return self._world.CreateMouseJoint(
            bodyA=self._anchor,
            bodyB=box.body,
            target=box.body.GetWorldPoint(spring.point),
            maxForce=spring.max_force,
            frequencyHz=spring.frequency,
            dampingRatio=spring.damping,
        )

    def _box(self, key: int) -> Box:
        if key not in self._boxes:
            raise InputError(f"box {key!r} does not exist: it fell off the table, or was never added")
        return self._boxes[key]
