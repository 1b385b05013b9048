"""The engine of the blocks world, written plainly: the twin of ``relforest.worlds.blocks.engine``.

Everything is asked of Box2D by its ordinary calls, in every step: whether a box has fallen, whether all boxes
are at rest, where the springs of the box that is held must pull. The results are the same, bit for bit.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, final
from unittest import mock

import numpy as np
from numpy.typing import NDArray

from relforest.worlds.blocks import simulation
from relforest.worlds.blocks.engine import (
    ARRIVED,
    DENSITY,
    FRICTION,
    GRAVITY,
    ITERATIONS,
    LOST,
    PHYSICS_STEP,
    REST_SPEED,
    REST_SPIN,
    RESTITUTION,
    TABLE_HALF_HEIGHT,
    TABLE_HALF_WIDTH,
    Spring,
)

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)
    import Box2D


@contextmanager
def plain_engine() -> Iterator[None]:
    """Let simulations that begin an episode inside this context run on the plain engine."""
    with mock.patch.object(simulation, "Engine", PlainEngine):
        yield


@final
class PlainEngine:
    """What `relforest.worlds.blocks.Engine` does, without its economies."""

    def __init__(self, *, table_half_width: float = TABLE_HALF_WIDTH) -> None:
        self.world = Box2D.b2World(gravity=(0.0, -GRAVITY), doSleep=True)
        table = self.world.CreateStaticBody(position=(0.0, -TABLE_HALF_HEIGHT))
        table.CreatePolygonFixture(
            box=(table_half_width, TABLE_HALF_HEIGHT), friction=FRICTION, restitution=RESTITUTION
        )
        self.anchor = self.world.CreateStaticBody()
        self.bodies: dict[int, Any] = {}
        self.half_extents: list[tuple[float, float]] = []
        self.held: int | None = None
        self.joints: list[Any] = []
        self.shifts: list[tuple[float, float]] = []
        self.point = (0.0, 0.0)

    @property
    def keys(self) -> tuple[int, ...]:
        return tuple(self.bodies)

    def add_box(
        self, half_extents: tuple[float, float], position: tuple[float, float], angle: float = 0.0
    ) -> int:
        body = self.world.CreateDynamicBody(position=position, angle=angle)
        body.CreatePolygonFixture(
            box=half_extents, density=DENSITY, friction=FRICTION, restitution=RESTITUTION
        )
        key = len(self.half_extents)
        body.userData = key
        self.bodies[key] = body
        self.half_extents.append(half_extents)
        return key

    def remove(self, key: int) -> None:
        if self.held == key:
            self.let_go()
        self.world.DestroyBody(self.bodies.pop(key))

    def poses(self) -> NDArray[np.float64]:
        return np.array([self.pose(key) for key in self.bodies]).reshape(-1, 3)

    def velocities(self) -> NDArray[np.float64]:
        rows = [(*body.linearVelocity, body.angularVelocity) for body in self.bodies.values()]
        return np.array(rows).reshape(-1, 3)

    def bounds(self) -> NDArray[np.float64]:
        return np.array([self.bounds_of(key) for key in self.bodies]).reshape(-1, 4)

    def pose(self, key: int) -> tuple[float, float, float]:
        body = self.bodies[key]
        return body.position.x, body.position.y, body.angle

    def bounds_of(self, key: int) -> tuple[float, float, float, float]:
        body = self.bodies[key]
        width, height = self.half_extents[key]
        sine, cosine = abs(body.transform.q.s), abs(body.transform.q.c)
        across, up = cosine * width + sine * height, sine * width + cosine * height
        x, y = body.position
        return x - across, x + across, y - up, y + up

    def is_resting(self, *, speed: float = REST_SPEED, spin: float = REST_SPIN) -> bool:
        resting = [
            body.linearVelocity.x**2 + body.linearVelocity.y**2 < speed * speed
            and abs(body.angularVelocity) < spin
            for body in self.bodies.values()
        ]
        return all(resting)

    def step(self, n: int = 1) -> None:
        for _ in range(n):
            self.world.Step(PHYSICS_STEP, ITERATIONS, ITERATIONS)
            for key in [key for key in self.bodies if self.bounds_of(key)[3] < LOST]:
                self.remove(key)

    def settle(
        self, max_steps: int, *, speed: float = REST_SPEED, spin: float = REST_SPIN
    ) -> tuple[int, bool]:
        for taken in range(1, max_steps + 1):
            self.step()
            if self.is_resting(speed=speed, spin=spin):
                return taken, True
        return max_steps, False

    def grab(self, key: int, springs: Sequence[Spring]) -> None:
        self.let_go()
        body = self.bodies[key]
        body.awake = True
        self.joints = [
            self.world.CreateMouseJoint(
                bodyA=self.anchor,
                bodyB=body,
                target=body.GetWorldPoint(spring.point),
                maxForce=spring.max_force,
                frequencyHz=spring.frequency,
                dampingRatio=spring.damping,
            )
            for spring in springs
        ]
        x, y = self.joints[0].target
        self.shifts = [(joint.target.x - x, joint.target.y - y) for joint in self.joints]
        self.held, self.point = key, springs[0].point

    def let_go(self) -> None:
        for joint in self.joints:
            self.world.DestroyJoint(joint)
        self.held, self.joints = None, []

    def carry(self, goal: tuple[float, float], max_steps: int) -> tuple[int, bool]:
        for taken in range(max_steps):
            if self.held is None:
                return taken, True
            self.pull(self.bodies[self.held], goal)
            self.step()
            if self.held is not None and self.has_arrived(self.bodies[self.held], goal):
                return taken + 1, True
        return max_steps, self.held is None

    def pull(self, body: Any, goal: tuple[float, float]) -> None:
        rotation = body.transform.q
        x = rotation.c * self.point[0] - rotation.s * self.point[1]
        y = rotation.s * self.point[0] + rotation.c * self.point[1]
        for joint, shift in zip(self.joints, self.shifts, strict=True):
            joint.target = (goal[0] + shift[0] + x, goal[1] + shift[1] + y)

    def has_arrived(self, body: Any, goal: tuple[float, float]) -> bool:
        x, y = body.position
        square = (x - goal[0]) ** 2 + (y - goal[1]) ** 2
        velocity = body.linearVelocity
        return bool(square < ARRIVED * ARRIVED and velocity.x**2 + velocity.y**2 < REST_SPEED * REST_SPEED)

    def contacts(self) -> frozenset[tuple[int, int]]:
        keys = {
            (contact.fixtureA.body.userData, contact.fixtureB.body.userData)
            for contact in self.world.contacts
            if contact.touching
        }
        return frozenset((min(a, b), max(a, b)) for a, b in keys if a is not None and b is not None)
