"""How a block is held: up to three springs, with strengths that depend on where it is grasped.

Near its centre a block is held by two more springs at opposite faces, which keep it from turning; near an
edge it hangs from one point and swings. The rules are those of the author's simulator.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from relforest.worlds.blocks.engine import PHYSICS_STEP, Spring

TOTAL_FORCE: Final = 2500.0
"""Largest total force of all springs, independent of the mass of the block."""

SUPPORT_SHARE: Final = 0.6
SUPPORT_POWER: Final = 5
WEAKEST_SUPPORT: Final = 0.01
"""Supports of less than this percentage of the total are left out."""

# The springs of the author's simulator (2 Hz, damping ratio sqrt(mass) / 2) belong to an engine that takes
# 1/60 s for the step whatever it really is: k = m (2 pi f)^2 and d = 4 pi m z f give the softness
# 1 / (d + h k) and the bias h k / (d + h k) / dt with h = 1/60. Box2D 2.3 has 1 / (dt (d' + dt k')) and
# dt k' / (dt (d' + dt k')); both agree for k' = k h / dt^2 and d' = d / dt. That is:
_ASSUMED_STEP = 1 / 60
FREQUENCY: Final = 2.0 * math.sqrt(_ASSUMED_STEP) / PHYSICS_STEP
DAMPING_PER_ROOT_MASS: Final = 0.5 / math.sqrt(_ASSUMED_STEP)


class Forces(NamedTuple):
    """Largest forces of the springs of one grasp."""

    main: float  # of the spring at the grasp point
    support: float  # of each of the two others; 0 = there are none


def forces(point: tuple[float, float], half_extents: tuple[float, float]) -> Forces:
    """Return how strongly a block is held at a point in its own coordinates (the origin is its centre)."""
    eccentricity = min(1.0, max(abs(point[0]) / half_extents[0], abs(point[1]) / half_extents[1]))
    support = SUPPORT_SHARE * (1 - eccentricity) ** SUPPORT_POWER
    main_percent = 100 / (1 + 2 * support)
    if main_percent * support <= WEAKEST_SUPPORT:
        return Forces(TOTAL_FORCE / 100 * main_percent, 0.0)
    return Forces(TOTAL_FORCE / 100 * main_percent, TOTAL_FORCE / 100 * main_percent * support)


def springs(point: tuple[float, float], half_extents: tuple[float, float]) -> tuple[Spring, ...]:
    """Return the springs that hold a block at a point (see `forces`), the main one first.

    The supports stand at the two faces across the thinner side of the block, level with the grasp point.
    """
    half_width, half_height = half_extents
    mass = 4 * half_width * half_height
    damping = DAMPING_PER_ROOT_MASS * math.sqrt(mass)
    strength = forces(point, half_extents)
    main = Spring(point, strength.main, FREQUENCY, damping)
    if not strength.support:
        return (main,)
    if half_width < half_height:
        faces = ((-half_width, point[1]), (half_width, point[1]))
    else:
        faces = ((point[0], -half_height), (point[0], half_height))
    return (main, *(Spring(face, strength.support, FREQUENCY, damping) for face in faces))
