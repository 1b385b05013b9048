"""One seed per run, and any number of independent random streams derived from it, each named by integers.

relforest never uses global random state. A run has one `numpy.random.SeedSequence`, from which `stream`
derives children by name without changing it. What one part of a run draws therefore does not depend on what
another part drew before, on the number of workers, or on where an interrupted run was resumed.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.random import RandomState as LegacyGenerator

from relforest.support.errors import InputError

RandomState: TypeAlias = int | np.random.SeedSequence | np.random.Generator | LegacyGenerator | None

# SeedSequence cuts integers into 32-bit words, so (2**32,) and (0, 1) would name the same stream.
_WORD = 2**32


def seed_sequence(random_state: RandomState) -> np.random.SeedSequence:
    """Convert a user's ``random_state`` to the seed of a run.

    Parameters
    ----------
    random_state : int, SeedSequence, Generator, RandomState or None
        A non-negative integer gives the same run every time; a SeedSequence is used as is; a Generator or
        RandomState is asked for 128 bits, so that successive calls differ; None uses fresh entropy from the
        operating system.

    Raises
    ------
    InputError
        If ``random_state`` is negative or of another type.
    """
    if random_state is None:
        return np.random.SeedSequence()
    if isinstance(random_state, np.random.SeedSequence):
        return random_state
    if isinstance(random_state, np.random.Generator):
        words = random_state.integers(0, _WORD, size=4, dtype=np.int64)
        return np.random.SeedSequence(words.tolist())
    if isinstance(random_state, LegacyGenerator):
        words = random_state.randint(0, _WORD, size=4, dtype=np.int64)
        return np.random.SeedSequence(words.tolist())
    is_integer = isinstance(random_state, (int, np.integer)) and not isinstance(random_state, bool)
    if not is_integer or random_state < 0:
        raise InputError(
            "random_state must be an integer of at least 0, a NumPy Generator, RandomState or SeedSequence, "
            f"or None, got {random_state!r}"
        )
    return np.random.SeedSequence(int(random_state))


def stream(seed: np.random.SeedSequence, *key: int) -> np.random.SeedSequence:
    """Return the child of ``seed`` named by ``key``, integers from 0 to 2**32 - 1; ``seed`` does not change.

    It is statistically independent of its parent and of children with other names. ``stream(seed, 3, 1)`` is
    ``stream(stream(seed, 3), 1)``.

    Raises
    ------
    InputError
        If a part of ``key`` is outside this range.
    """
    for part in key:
        if not 0 <= part < _WORD:
            raise InputError(f"a part of a stream's key must be from 0 to 2**32 - 1, got {part!r} in {key!r}")
    words = tuple(int(part) for part in key)
    return np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, *words), pool_size=seed.pool_size)


def generator(seed: np.random.SeedSequence) -> np.random.Generator:
    """Return a new PCG64 generator at the start of the stream named by ``seed``."""
    return np.random.Generator(np.random.PCG64(seed))
