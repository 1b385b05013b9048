"""One box of the engine, with its state as memory that Box2D keeps up to date.

Box2D hands out references to pairs of numbers inside a body or a spring, not copies. Read and written as
memory they take a tenth of the time of a call. A reference is good as long as the body or the spring exists.
"""

from __future__ import annotations

import ctypes
from typing import Any, NamedTuple


class Box(NamedTuple):
    """A box and its state."""

    body: Any  # of Box2D
    half_extents: tuple[float, float]
    center: memoryview[float]  # x, y
    velocity: memoryview[float]  # x, y; per second of the physics
    rotation: memoryview[float]  # sine and cosine of the angle

    def bounds(self) -> tuple[float, float, float, float]:
        """Return the smallest and largest x, and the smallest and largest y."""
        width, height = self.half_extents
        sine, cosine = abs(self.rotation[0]), abs(self.rotation[1])
        across, up = cosine * width + sine * height, sine * width + cosine * height
        x, y = self.center
        return x - across, x + across, y - up, y + up

    def is_moving(self, speed: float, spin: float) -> bool:
        """Tell whether the box is not slower than both."""
        x, y = self.velocity
        return x * x + y * y >= speed * speed or bool(abs(self.body.angularVelocity) >= spin)


def box_of(body: Any, half_extents: tuple[float, float]) -> Box:  # noqa: ANN401 - Box2D ships no types
    """Return the box that a body is."""
    rotation = body.transform.q
    return Box(
        body,
        half_extents,
        shared_pair(body.position, *body.position),
        shared_pair(body.linearVelocity, *body.linearVelocity),
        shared_pair(rotation, rotation.s, rotation.c),
    )


def shared_pair(reference: Any, first: float, second: float) -> memoryview[float]:  # noqa: ANN401 - as above
    """Return the two numbers that a reference of Box2D stands for as memory, to read and to write.

    Parameters
    ----------
    reference : b2Vec2 or b2Rot
        Inside a body or a joint.
    first, second : float
        What the two numbers are now.

    Raises
    ------
    RuntimeError
        If they are something else: this build of Box2D keeps them in another way.
    """
    pair: memoryview[Any] = memoryview((ctypes.c_float * 2).from_address(int(reference.this)))
    pair = pair.cast("B").cast("f")
    if tuple(pair) != (first, second):
        raise RuntimeError(
            f"{type(reference).__name__} of Box2D is not kept as {(first, second)} in memory but as "
            f"{tuple(pair)}; install Box2D 2.3.10"
        )
    return pair
