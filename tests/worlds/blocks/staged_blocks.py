"""Scenes of blocks made by hand."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Sequence

import numpy as np

from relforest.worlds.blocks.blocks import Block, random_blocks
from relforest.worlds.blocks.options import isolate, move, put, rotate
from relforest.worlds.blocks.simulation import BlocksSimulation
from relforest.worlds.blocks.state import BlocksState, Cast

UPRIGHT = math.pi / 2
GREY = (0.5, 0.5, 0.5)

Pose = tuple[float, float, float]


def staged(
    *placed: tuple[tuple[float, float], Pose],
    colors: Sequence[tuple[float, float, float]] | None = None,
    contacts: Iterable[tuple[int, int]] = (),
) -> BlocksState:
    """Return blocks with the ids 0, 1, ..., each given by its half extents and its pose."""
    colors = colors or [GREY] * len(placed)
    blocks = [Block(i, half, color) for i, ((half, _), color) in enumerate(zip(placed, colors, strict=True))]
    return Cast.of(blocks).state(np.array([pose for _, pose in placed]).reshape(-1, 3), contacts)


def row(*x: float, colors: Sequence[tuple[float, float, float]] | None = None) -> BlocksState:
    """Return squares of side 4 standing on the table."""
    return staged(*(((2.0, 2.0), (at, 2.0, 0.0)) for at in x), colors=colors)


LONG = (4.0, 2.0)


def portal(*, tilt: float = 0.0, height: float = 10.0, contacts: bool = True) -> BlocksState:
    """Return an arch of 8 x 4 blocks: supports upright at -5 and 5 (inner edges -3 and 3), a top at x = 0."""
    return staged(
        (LONG, (-5.0, 4.0, UPRIGHT)),
        (LONG, (5.0, 4.0, UPRIGHT)),
        (LONG, (0.0, height, tilt)),
        contacts=[(0, 2), (1, 2)] if contacts else [],
    )


def reordered(state: BlocksState, order: Sequence[int]) -> BlocksState:
    """Return the same blocks in another order."""
    chosen = np.array(order)
    return BlocksState(
        np.arange(len(chosen)),
        state.half_extents[chosen],
        state.colors[chosen],
        state.poses[chosen],
        state.touching[np.ix_(chosen, chosen)],
    )


def shifted(state: BlocksState, x: float) -> BlocksState:
    """Return the same blocks farther along the table."""
    return BlocksState(
        state.ids, state.half_extents, state.colors, state.poses + np.array([x, 0.0, 0.0]), state.touching
    )


def dropped(seed: int, n: int = 5) -> BlocksSimulation:
    """Return blocks that were dropped and lie still."""
    sim = BlocksSimulation(np.random.default_rng(seed))
    sim.drop(random_blocks(sim.rng, n))
    return sim


def fingerprint(seed: int) -> str:
    """Play an episode and return what came out, to the last bit."""
    sim = dropped(seed)
    ids = [block.id for block in sim.blocks]
    put(sim, ids[0], ids[1])
    rotate(sim, ids[2])
    isolate(sim, ids[1])
    move(sim, ids[3], 10.0)
    text = [sim.poses.tobytes(), sim.bounds.tobytes(), repr((sim.steps, sorted(sim.contacts))).encode()]
    return hashlib.sha256(b"".join(text)).hexdigest()
