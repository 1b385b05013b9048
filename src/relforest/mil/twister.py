"""The Mersenne twister MT19937 for kernels, with an explicit state.

A state is an array of 624 words and, last, the position of the next word.

References
----------
Matsumoto and Nishimura (1998), "Mersenne twister: a 623-dimensionally equidistributed uniform pseudorandom
number generator", ACM TOMACS 8; Lemire (2019), "Fast random integer generation in an interval", ACM TOMACS
29.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["next_below", "next_word", "seeded"]

_SIZE: Final = 624
_MIDDLE: Final = 397
_WORD: Final = 0xFFFFFFFF


@kernel
def seeded(seed: int) -> NDArray[np.int64]:
    """Return the state for a seed of 32 bits."""
    state = np.empty(_SIZE + 1, dtype=np.int64)
    state[0] = seed & _WORD
    for i in range(1, _SIZE):
        mixed = state[i - 1] ^ (state[i - 1] >> 30)
        # In halves, since a product of 32-bit words may exceed a signed 64-bit number.
        state[i] = ((((mixed >> 16) * 1812433253 & _WORD) << 16) + (mixed & 0xFFFF) * 1812433253 + i) & _WORD
    state[_SIZE] = _SIZE
    return state


@kernel
def next_word(state: NDArray[np.int64]) -> int:
    """Return the next 32 random bits."""
    if state[_SIZE] == _SIZE:
        _twist(state)
    word = state[state[_SIZE]]
    state[_SIZE] += 1
    word ^= word >> 11
    word ^= (word << 7) & 0x9D2C5680
    word ^= (word << 15) & 0xEFC60000
    return int(word ^ (word >> 18))


@kernel
def _twist(state: NDArray[np.int64]) -> None:
    for i in range(_SIZE):
        joined = (state[i] & 0x80000000) | (state[(i + 1) % _SIZE] & 0x7FFFFFFF)
        odd = 0x9908B0DF if joined & 1 else 0
        state[i] = state[(i + _MIDDLE) % _SIZE] ^ (joined >> 1) ^ odd
    state[_SIZE] = 0


@kernel
def next_below(state: NDArray[np.int64], n: int) -> int:
    """Return a uniform random integer from 0 to n - 1, for n below 2**31."""
    product = next_word(state) * n
    if product & _WORD < n:
        least = (_WORD + 1 - n) % n
        while product & _WORD < least:
            product = next_word(state) * n
    return product >> 32
