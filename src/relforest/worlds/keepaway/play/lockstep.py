"""Episodes of keepaway that are played together, as learners use them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

import numpy as np
from numpy.typing import NDArray

from relforest.smdp import Decisions, Outcomes
from relforest.support.rng import seed_sequence
from relforest.worlds.keepaway.play.batch import GO_ON, Batch
from relforest.worlds.keepaway.server.layout import CAPPED, PLAYING, Setup


@final
class LockstepGames:
    """One episode for each seed: what `KeepawayEnv` would play after a reset with it.

    It implements `relforest.smdp.Lockstep`.

    Parameters
    ----------
    setup : Setup
        The rules.
    discount : float
        Per cycle.
    seeds : sequence of int
    """

    def __init__(self, setup: Setup, discount: float, seeds: Sequence[int]) -> None:
        self._discount, self._batch = discount, Batch(setup, len(seeds))
        self._batch.begin([seed_sequence(seed) for seed in seeds])
        self.before: NDArray[np.float64] = np.tile(self._batch.times.astype(np.float64), (2, 1))

    def decisions(self, episodes: NDArray[np.int64]) -> Decisions:
        """Return the present decisions of some episodes."""
        return self._batch.decisions(episodes)

    def step(self, episodes: NDArray[np.int64], actions: NDArray[np.int64]) -> Outcomes:
        """Play some episodes on to their next decision."""
        batch = self._batch
        codes = np.full(len(batch), GO_ON)
        codes[episodes] = actions
        batch.play(codes)
        ends, elapsed = batch.ends[episodes], batch.seen.elapsed[episodes].astype(np.float64)
        discounted = batch.discounted(self._discount)[episodes]
        is_capped = ends == CAPPED
        return Outcomes(elapsed, discounted, elapsed, (ends != PLAYING) & ~is_capped, is_capped)
