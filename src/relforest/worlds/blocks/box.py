"""One box of the engine, with its state as memory that Box2D keeps up to date.

Box2D hands out references to numbers inside a body or a spring, not copies. Read and written as memory they
take a tenth of the time of a call. A reference is good as long as the body or the spring exists.
"""

from __future__ import annotations

import ctypes
from typing import Any, Final, NamedTuple

from relforest.support.errors import RelforestError

_PROBE: Final = (1.0, 2.0, 3.0)


class Box(NamedTuple):
    """A box and its state."""

    body: Any  # of Box2D
    half_extents: tuple[float, float]
    centre: memoryview[float]  # x, y
    velocity: memoryview[float]  # x, y and spin, per second of the physics
    rotation: memoryview[float]  # sine and cosine of the angle

    def bounds(self) -> tuple[float, float, float, float]:
        """Return the smallest and largest x, and the smallest and largest y."""
        width, height = self.half_extents
        sine, cosine = abs(self.rotation[0]), abs(self.rotation[1])
        across, up = cosine * width + sine * height, sine * width + cosine * height
        x, y = self.centre
        return x - across, x + across, y - up, y + up

    def is_moving(self, speed: float, spin: float) -> bool:
        """Return whether the box exceeds either."""
        x, y, turn = self.velocity
        return x * x + y * y >= speed * speed or abs(turn) >= spin


def box_of(body: Any, half_extents: tuple[float, float]) -> Box:  # noqa: ANN401 - Box2D ships no types
    """Return the box of a body at rest."""
    rotation = body.transform.q
    # Memory is full of zeros: to find the velocity, give the body one for a moment.
    body.linearVelocity, body.angularVelocity = _PROBE[:2], _PROBE[2]
    velocity = shared(body.linearVelocity, *_PROBE)
    body.linearVelocity, body.angularVelocity = (0.0, 0.0), 0.0
    return Box(
        body,
        half_extents,
        shared(body.position, *body.position),
        velocity,
        shared(rotation, rotation.s, rotation.c),
    )


def shared(reference: Any, *numbers: float) -> memoryview[float]:  # noqa: ANN401 - as above
    """Return numbers of Box2D (a b2Vec2 or b2Rot inside a body or a joint) as memory, to read and to write.

    Raises
    ------
    RelforestError
        If they are not ``numbers`` now: this build of Box2D keeps them in another way.
    """
    there: memoryview[Any] = memoryview((ctypes.c_float * len(numbers)).from_address(int(reference.this)))
    there = there.cast("B").cast("f")
    if tuple(there) != numbers:
        raise RelforestError(
            f"{type(reference).__name__} of Box2D is not kept as {numbers} in memory but as {tuple(there)}; "
            "install Box2D 2.3.10"
        )
    return there
