"""Where a block may be moved to: the continuous action space of the arch task, sampled.

There are two samplers. ``"test"`` is what an agent under test considers: between each pair of other blocks,
onto each other block, half the way towards it, and a tenth of the distance farther away from it.
``"training"`` is for training experience and learning: between each pair, and on both sides of each other
block, so that an arch may follow. A search for better targets continues with `nearby_targets`.

References
----------
Palmer (2015), sections 6.5 and 7.4.3.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from types import MappingProxyType
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.support.options import one_of
from relforest.worlds.blocks.state import BlocksState

CLOSER: Final = 0.5
"""Share of the distance by which a block closes in on another."""

FARTHER: Final = 0.1
"""Share of the distance by which it moves away; that this is a share too is a reading of "0.1 farther"."""

BESIDE: Final = 0.75
"""Distance of centres beside another block, in sums of both horizontal sizes."""

REFINED: Final = 20
"""Moves near which a search may ask for more targets in a state; beyond that, nothing is added."""

_SAME: Final = 1e-9


@final
@dataclass(frozen=True, slots=True, eq=False)
class Targets:
    """Candidate moves; their number depends only on the number of blocks."""

    slots: NDArray[np.int64]  # (k,) the block that moves, counted as at the start of the episode
    x: NDArray[np.float64]  # (k,) where to; NaN = this candidate does not exist at present

    free: int = 0  # how many slots there are, at the end, for candidates that do not exist yet

    def with_reserved(self, n: int) -> Targets:
        """Return them with slots for `n` more."""
        return Targets(np.append(self.slots, np.zeros(n, np.int64)), np.append(self.x, np.full(n, np.nan)), n)

    def also(self, slot: int, x: float, n_kept: int = 0) -> Targets:
        """Return them with one more, unless it exists already or no slot but the last `n_kept` is free."""
        if self.free <= n_kept or self.place(slot, x) is not None:
            return self
        slots, places = self.slots.copy(), self.x.copy()
        slots[-self.free], places[-self.free] = slot, x
        return Targets(slots, places, self.free - 1)

    def place(self, slot: int, x: float) -> int | None:
        """Return the number of the candidate that moves a block there; None if there is none."""
        found = np.flatnonzero((self.slots == slot) & (np.abs(self.x - x) < _SAME))
        return int(found[0]) if len(found) else None


@final
@dataclass(frozen=True, slots=True)
class Sampler:
    """A way to sample targets."""

    size: Callable[[int], int]  # number of blocks -> number of candidates
    sample: Callable[[BlocksState, NDArray[np.int64], int], Targets]  # state, slots of its blocks, all slots


def nearby_targets(target: float, others: Sequence[float]) -> list[float]:
    """Return the targets that a beam search continues with: steps towards and away from each other block.

    They are half the way from ``target`` towards each midpoint of the others, then a tenth of the distance
    farther away from each.
    """
    closer = [target + CLOSER * (other - target) for other in others]
    return closer + [target - FARTHER * (other - target) for other in others]


def n_reserved(n: int) -> int:
    """Return how many targets of n blocks can be added to a state: near `REFINED` moves, and one."""
    return 2 * REFINED * (n - 1) + 1


def _test_targets(x: list[float], width: list[float], mover: int) -> list[float]:  # noqa: ARG001 - one signature
    others = _others(x, mover)
    return [*_between(others), *others, *nearby_targets(x[mover], others)]


def _training_targets(x: list[float], width: list[float], mover: int) -> list[float]:
    beside = [BESIDE * (width[mover] + other) for other in _others(width, mover)]
    places = list(zip(_others(x, mover), beside, strict=True))
    between = _between(_others(x, mover))
    return [
        *between,
        *(at - distance for at, distance in places),
        *(at + distance for at, distance in places),
    ]


def _others(values: list[float], mover: int) -> list[float]:
    return values[:mover] + values[mover + 1 :]


def _between(others: list[float]) -> list[float]:
    return [(one + other) / 2.0 for one, other in combinations(others, 2)]


def _pairs(n: int) -> int:
    return (n - 1) * (n - 2) // 2


def _n_test(n: int) -> int:
    return n * (_pairs(n) + 3 * (n - 1))


def _n_training(n: int) -> int:
    return n * (_pairs(n) + 2 * (n - 1))


def _every_move(
    state: BlocksState,
    slots: NDArray[np.int64],
    n_slots: int,
    targets_of: Callable[[list[float], list[float], int], list[float]],
) -> Targets:
    """Return the targets of all blocks; those that depend on a block that is gone are NaN."""
    x, width = np.full(n_slots, np.nan), np.full(n_slots, np.nan)
    bounds = state.bounds
    x[slots], width[slots] = state.poses[:, 0], bounds[:, 1] - bounds[:, 0]
    places, widths = x.tolist(), width.tolist()
    targets = [_distinct(targets_of(places, widths, mover), places[mover]) for mover in range(n_slots)]
    movers = np.repeat(np.arange(n_slots), len(targets[0]))
    return Targets(movers, np.array(targets, dtype=np.float64).ravel())


def _distinct(targets: list[float], mover: float) -> list[float]:
    """Return targets, NaN for those that repeat an earlier one, and for all of a mover that is gone (NaN).

    A move to the same place as an earlier candidate of the same block is not a separate choice.
    """
    if math.isnan(mover):
        return [math.nan] * len(targets)
    return [
        math.nan if any(abs(target - earlier) < _SAME for earlier in targets[:i]) else target
        for i, target in enumerate(targets)
    ]


def _test(state: BlocksState, slots: NDArray[np.int64], n_slots: int) -> Targets:
    return _every_move(state, slots, n_slots, _test_targets)


def _training(state: BlocksState, slots: NDArray[np.int64], n_slots: int) -> Targets:
    return _every_move(state, slots, n_slots, _training_targets)


SAMPLERS: Final[Mapping[str, Sampler]] = MappingProxyType(
    {
        "test": Sampler(_n_test, _test),
        "training": Sampler(_n_training, _training),
    }
)
"""Name -> sampler of targets."""


def target_sampler(name: str) -> Sampler:
    """Return the sampler of that name, or raise `InputError` with the known names."""
    return SAMPLERS[one_of("sampler", name, tuple(SAMPLERS))]
