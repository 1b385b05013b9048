"""tipsLeft: weights stand on a beam that lies on a post, and one of its ends goes down."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes import Scenes
from relforest.worlds.blocks.engine import REST_SPEED, Engine
from relforest.worlds.blocks.outcomes import Trial, checked_range, decided_scenes, random_colors
from relforest.worlds.blocks.scene import describe

TABLE: Final = 20.0
"""Half the width of the table."""
POST: Final = (1.0, 5.0)
BEAM: Final = (10.0, 0.25)
WEIGHT: Final = 2.0
"""Half sizes of the post, the beam and the (square) weights."""

_BEAM_TOP: Final = 2 * POST[1] + 2 * BEAM[1]
_REACH: Final = 0.95 * BEAM[0]
_JITTER: Final = 0.2

# A tilt of 0.05 half turns is a decision.
_TILT: Final = 0.05 * math.pi
_FIRST_LOOK: Final = 40
_LAST_LOOK: Final = 540


def balance_scale_scenes(
    rng: np.random.Generator, n: int, n_weights: Sequence[int] = (1, 4)
) -> tuple[Scenes, NDArray[np.bool_]]:
    """Draw scenes of weights on a beam, labelled with whether its left end goes down.

    Parameters
    ----------
    rng : numpy.random.Generator
    n : int
        Number of scenes, 1 to 100 000.
    n_weights : pair of int
        Smallest and largest number of weights, 1 to 20; the source has 1 to 4, and 5 to 6 in large scenes.

    Returns
    -------
    scenes : Scenes
        The weights, before anything moves, without arguments. Post and beam are not in the scene.
    labels : (n,) bool
        Scenes in which the beam stays level are redrawn.

    Raises
    ------
    InputError
        If ``n`` or ``n_weights`` is out of range, or ``rng`` is not a Generator.

    References
    ----------
    Palmer (2015), section 5.3.1.
    """
    return decided_scenes(rng, n, partial(balance_trial, n_weights=checked_range("n_weights", n_weights, 1)))


def balance_trial(rng: np.random.Generator, n_weights: tuple[int, int]) -> Trial:
    """Put weights on the beam and see which end goes down first; undecided if it stays level.

    Notes
    -----
    The source does not specify when a tilt counts. Here it counts when the beam has turned by 9 degrees,
    where the author's simulator stops; the beam is level if all weights come to rest before, or after 5.4 s.
    """
    smallest, largest = n_weights
    positions = place_weights(rng, int(rng.integers(smallest, largest + 1)))
    # Shuffled, so that the order does not reveal what stands on what.
    rng.shuffle(positions)
    half_extents = np.full_like(positions, WEIGHT)
    colors = random_colors(rng, len(positions))
    angles = np.zeros((len(positions), 1))
    objects = describe(half_extents, np.hstack([positions, angles]), colors)
    return Trial(objects, (), tips_left(positions))


def place_weights(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    """Return the centres of ``n`` weights: each somewhere on the beam, or on the stack at that place."""
    bases: list[float] = []
    levels: list[int] = []
    positions = np.empty((n, 2))
    for place in positions:
        x = rng.uniform(-_REACH, _REACH)
        stack = next((i for i, base in enumerate(bases) if abs(base - x) <= 2 * WEIGHT), None)
        if stack is None:
            stack = len(bases)
            bases.append(x)
            levels.append(0)
        else:
            x = bases[stack] + _shift(rng)
        place[:] = x, _BEAM_TOP + WEIGHT * (1 + 2 * levels[stack])
        levels[stack] += 1
    return positions


def _shift(rng: np.random.Generator) -> float:
    """Return how far from the middle of its stack a weight is put, less than half its width."""
    while True:
        shift = rng.normal(0.0, _JITTER)
        if abs(shift) <= WEIGHT:
            return float(shift)


def tips_left(positions: NDArray[np.float64]) -> bool | None:
    """Return whether the left end of a beam with weights centred at (n, 2) positions goes down.

    Returns None if the beam stays level.
    """
    engine = Engine(table_half_width=TABLE)
    engine.add_box(POST, (0.0, POST[1]))
    beam = engine.add_box(BEAM, (0.0, 2 * POST[1] + BEAM[1]))
    for x, y in positions:
        engine.add_box((WEIGHT, WEIGHT), (x, y))
    engine.step(_FIRST_LOOK)
    for _ in range(_FIRST_LOOK, _LAST_LOOK):
        angle = engine.pose(beam)[2]
        if abs(angle) >= _TILT:
            # Counter-clockwise: the left end goes down.
            return angle > 0
        _, _, *weights = engine.velocities()
        if all(np.hypot(x, y) < REST_SPEED for x, y, _ in weights):
            return None
        engine.step()
    return None
