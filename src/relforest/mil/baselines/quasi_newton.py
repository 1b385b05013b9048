"""Ascent on the diverse density: limited-memory BFGS on its negative logarithm, fully compiled.

A search has hundreds of starts, and an evaluation may take only microseconds; a library routine that calls
back for each value would spend nearly all of its time on the calls.

Dimensions: a hypothesis of 2 d numbers.

References
----------
Nocedal and Wright (2006), "Numerical optimization", algorithms 7.4 and 7.5; Lewis and Overton (2013),
"Nonsmooth optimization via quasi-Newton methods", algorithm 2.6, for the line search by bisection.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.mil.baselines.noisy_or import Sample, negative_log_density
from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

_MEMORY: Final = 10
_DECREASE: Final = 1e-4
_CURVATURE: Final = 0.9
_MOST_TRIALS: Final = 30


class Trail(NamedTuple):
    """State of a descent, with its most recent steps."""

    gradient: NDArray[np.float64]  # (2 d,)
    direction: NDArray[np.float64]  # (2 d,)
    origin: NDArray[np.float64]  # (2, 2 d): position and gradient before the step
    moves: NDArray[np.float64]  # (10, 2 d): changes of position
    turns: NDArray[np.float64]  # (10, 2 d): changes of the gradient
    curvatures: NDArray[np.float64]  # (10,): move times turn
    slopes: NDArray[np.float64]  # (n,): work space


@kernel
def descend(sample: Sample, hypothesis: NDArray[np.float64], max_steps: int, tolerance: float) -> float:
    """Improve a hypothesis (2, d) in place; return its negative log density.

    Stops after `max_steps` steps, after a step that gains less than `tolerance` times the value (or times 1,
    for values below 1), or when no step brings a gain.
    """
    size = hypothesis.size
    trail = Trail(
        np.empty(size),
        np.empty(size),
        np.empty((2, size)),
        np.empty((_MEMORY, size)),
        np.empty((_MEMORY, size)),
        np.empty(_MEMORY),
        np.empty(len(sample.points)),
    )
    position = hypothesis.reshape(size)
    value = _evaluate(sample, position, trail)
    stored = 0
    for _ in range(max_steps):
        _point_downhill(trail, stored)
        slope = _dot(trail.direction, trail.gradient)
        if stored and not slope < 0.0:
            stored = 0
            _point_downhill(trail, stored)
            slope = _dot(trail.direction, trail.gradient)
        if not slope < 0.0:
            break
        reached = _search_line(sample, position, trail, value, slope)
        if not reached < value:
            break
        stored = _remember(position, trail, stored)
        gain, value = value - reached, reached
        if gain <= tolerance * max(1.0, value):
            break
    return value


@kernel
def _evaluate(sample: Sample, position: NDArray[np.float64], trail: Trail) -> float:
    shape = (2, len(position) // 2)
    return negative_log_density(sample, position.reshape(shape), trail.gradient.reshape(shape), trail.slopes)


@kernel
def _point_downhill(trail: Trail, stored: int) -> None:
    """Two-loop recursion: minus the gradient times the inverse Hessian, estimated from recent steps."""
    direction = trail.direction
    direction[:] = -trail.gradient
    if stored == 0:
        # A first step of at most 1, the width of a feature.
        direction /= max(1.0, np.sqrt(_dot(direction, direction)))
        return
    known = min(stored, _MEMORY)
    weights = np.empty(_MEMORY)
    for back in range(known):
        i = (stored - 1 - back) % _MEMORY
        weights[i] = _dot(trail.moves[i], direction) / trail.curvatures[i]
        direction -= weights[i] * trail.turns[i]
    last = (stored - 1) % _MEMORY
    direction *= trail.curvatures[last] / _dot(trail.turns[last], trail.turns[last])
    for forth in range(known):
        i = (stored - known + forth) % _MEMORY
        direction += (weights[i] - _dot(trail.turns[i], direction) / trail.curvatures[i]) * trail.moves[i]


@kernel
def _search_line(
    sample: Sample, position: NDArray[np.float64], trail: Trail, value: float, slope: float
) -> float:
    """Move along the direction to a point that satisfies the weak Wolfe conditions; return its value.

    After 30 trials without such a point, a sufficient decrease is enough.
    """
    trail.origin[0] = position
    trail.origin[1] = trail.gradient
    low, high, length = 0.0, np.inf, 1.0
    for _ in range(_MOST_TRIALS):
        position[:] = trail.origin[0] + length * trail.direction
        reached = _evaluate(sample, position, trail)
        # The negated test also catches NaN.
        if not reached <= value + _DECREASE * length * slope:
            high = length
        elif _dot(trail.direction, trail.gradient) < _CURVATURE * slope:
            low = length
        else:
            return reached
        length = 0.5 * (low + high) if high < np.inf else 2.0 * length
    # The farthest point with a sufficient decrease, or the origin.
    position[:] = trail.origin[0] + low * trail.direction
    return _evaluate(sample, position, trail)


@kernel
def _remember(position: NDArray[np.float64], trail: Trail, stored: int) -> int:
    """Store the last step if the function curves upwards along it; return the number of stored steps."""
    i = stored % _MEMORY
    trail.moves[i] = position - trail.origin[0]
    trail.turns[i] = trail.gradient - trail.origin[1]
    trail.curvatures[i] = _dot(trail.moves[i], trail.turns[i])
    if trail.curvatures[i] > 1e-12 * _dot(trail.turns[i], trail.turns[i]):
        return stored + 1
    return stored


@kernel
def _dot(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Inner product of two vectors.

    A library routine would start threads for vectors of length ten thousand, which costs more than it saves,
    and its rounding depends on the machine. Four sums can be computed in parallel.
    """
    first, second, third, fourth = 0.0, 0.0, 0.0, 0.0
    whole = len(a) - len(a) % 4
    for i in range(0, whole, 4):
        first += a[i] * b[i]
        second += a[i + 1] * b[i + 1]
        third += a[i + 2] * b[i + 2]
        fourth += a[i + 3] * b[i + 3]
    for i in range(whole, len(a)):
        first += a[i] * b[i]
    return first + second + third + fourth
