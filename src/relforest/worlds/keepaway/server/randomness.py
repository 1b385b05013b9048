"""Random numbers inside kernels: one stream per game, so that no game depends on what others draw.

The generator is MRG32k3a (L'Ecuyer (1999), "Good parameters and implementations for combined multiple
recursive random number generators"): two linear recurrences of order three, period about 2**191. Its state
and all intermediate products fit in signed 64-bit integers, so the same numbers come with and without
compilation.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.support.jit import kernel

_M1: Final = 4294967087
_M2: Final = 4294944443
_A12: Final = 1403580
_A13: Final = 810728
_A21: Final = 527612
_A23: Final = 1370589
_SCALE: Final = 1.0 / (_M1 + 1.0)


def stream_states(seeds: Sequence[np.random.SeedSequence]) -> NDArray[np.int64]:
    """Return each seed's first state, (G, 6): three numbers from 1 to m1 - 1, then three from 1 to m2 - 1."""
    moduli = np.array([_M1 - 1] * 3 + [_M2 - 1] * 3, dtype=np.uint64)
    states = np.empty((len(seeds), 6), dtype=np.int64)
    for row, seed in zip(states, seeds, strict=True):
        row[:] = (seed.generate_state(6, np.uint64) % moduli).astype(np.int64) + 1
    return states


@kernel
def uniform(streams: NDArray[np.int64], game: int, low: float, high: float) -> float:
    """Draw a number between ``low`` and ``high``, both excluded but for rounding; advances the stream."""
    first = (_A12 * streams[game, 1] - _A13 * streams[game, 0]) % _M1
    streams[game, 0] = streams[game, 1]
    streams[game, 1] = streams[game, 2]
    streams[game, 2] = first
    second = (_A21 * streams[game, 5] - _A23 * streams[game, 3]) % _M2
    streams[game, 3] = streams[game, 4]
    streams[game, 4] = streams[game, 5]
    streams[game, 5] = second
    difference = first - second
    if difference <= 0:
        difference += _M1
    return float(low + (high - low) * (difference * _SCALE))


@kernel
def below(streams: NDArray[np.int64], game: int, count: int) -> int:
    """Draw an integer from 0 to ``count`` - 1."""
    return min(int(uniform(streams, game, 0.0, float(count))), count - 1)
