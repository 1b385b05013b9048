"""dropOn(A, B): a block A falls near a support B, where others may lie, and comes to rest over B or not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes import Scenes
from relforest.worlds.blocks.engine import Engine
from relforest.worlds.blocks.outcomes import Trial, checked_range, decided_scenes, random_colors
from relforest.worlds.blocks.scene import SCHEMA, describe

TABLE: Final = 20.0
"""Half the width of the table."""
SUPPORT_LENGTH: Final = (1.5, 5.5)
"""Bounds of the support's half length; its other half side is 1, as both of the dropped (square) blocks."""
HALF_SIDE: Final = 1.0

_SUPPORT_REACH: Final = 19.0
_SPREAD: Final = 3.5
_TURN: Final = 0.5 * math.pi
_HEIGHT: Final = (9.5, 13.5)

# Physical units per physical second: half of what the author's simulator calls a speed of 0.001.
_SLOW: Final = 0.0005
_LONGEST: Final = 2000
_AFTER_REST: Final = 5


def drop_on_scenes(
    rng: np.random.Generator, n: int, n_interferers: Sequence[int] = (0, 3)
) -> tuple[Scenes, NDArray[np.bool_]]:
    """Draw scenes of a block in the air, labelled with whether it comes to rest over the support.

    Parameters
    ----------
    rng : numpy.random.Generator
    n : int
        Number of scenes, 1 to 100 000.
    n_interferers : pair of int
        Smallest and largest number of blocks dropped before, 0 to 20; the source has 0 to 3, and 4 to 5 in
        large scenes. Those that fall off the table are not in the scene.

    Returns
    -------
    scenes : Scenes
        The support, the interferers at rest, and the dropped block in the air; the arguments A and B are the
        dropped block and the support.
    labels : (n,) bool

    Raises
    ------
    InputError
        If ``n`` or ``n_interferers`` is out of range, or ``rng`` is not a Generator.

    References
    ----------
    Palmer (2015), section 5.3.1.
    """
    limits = checked_range("n_interferers", n_interferers, 0)
    return decided_scenes(rng, n, partial(drop_on_trial, n_interferers=limits), ("A", "B"))


def drop_on_trial(rng: np.random.Generator, n_interferers: tuple[int, int]) -> Trial:
    """Drop interferers one after the other, then A; undecided only if they push the support off the table.

    Notes
    -----
    The source says that A succeeds if it "comes to rest over the support, even if other blocks are stacked
    between". Here: A is still there, its centre lies between the ends of the support's bounding box and above
    the centre of the support, which may have toppled. The end is when all blocks lie still, or after 20 s.
    """
    smallest, largest = n_interferers
    engine = Engine(table_half_width=TABLE)
    length = rng.uniform(*SUPPORT_LENGTH)
    support = _place_support(rng, engine, length)
    for _ in range(int(rng.integers(smallest, largest + 1))):
        _drop(rng, engine, support)
        engine.settle(_LONGEST, speed=_SLOW, spin=math.inf)
        if support not in engine.keys:
            return Trial(np.empty((0, SCHEMA.width)), (), None)
    dropped = _drop(rng, engine, support)
    half_extents = np.full((len(engine.keys), 2), HALF_SIDE)
    half_extents[0, 0] = length
    objects = describe(half_extents, engine.poses(), random_colors(rng, len(half_extents)))
    engine.settle(_LONGEST, speed=_SLOW, spin=math.inf)
    engine.step(_AFTER_REST)
    return Trial(objects, (len(objects) - 1, 0), rests_over(engine, dropped, support))


def rests_over(engine: Engine, upper: int, lower: int) -> bool:
    """Return whether a remaining box has its centre above that of another and between its ends."""
    if upper not in engine.keys or lower not in engine.keys:
        return False
    left, right, _, _ = engine.bounds()[engine.keys.index(lower)]
    x, y, _ = engine.pose(upper)
    return bool(left <= x <= right and y > engine.pose(lower)[1])


def _place_support(rng: np.random.Generator, engine: Engine, length: float) -> int:
    """Lay the support on the table, or stand it up there, and return its key."""
    x = rng.uniform(-_SUPPORT_REACH, _SUPPORT_REACH)
    if rng.random() < 0.5:
        return engine.add_box((length, HALF_SIDE), (x, HALF_SIDE), 0.0)
    return engine.add_box((length, HALF_SIDE), (x, length), math.pi / 2)


def _drop(rng: np.random.Generator, engine: Engine, support: int) -> int:
    """Let go of a block somewhere above the support as it is now, and return its key."""
    top = engine.bounds()[engine.keys.index(support)][3]
    x = engine.pose(support)[0] + _SPREAD * rng.standard_normal()
    y = top + rng.uniform(*_HEIGHT)
    return engine.add_box((HALF_SIDE, HALF_SIDE), (x, y), _TURN * rng.standard_normal())
