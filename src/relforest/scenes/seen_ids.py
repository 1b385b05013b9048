"""The ids of scenes that have ended, to notice one that comes back."""

from __future__ import annotations

from typing import final

import numpy as np
import pyarrow as pa

from relforest.scenes.arrays import IntArray
from relforest.scenes.arrow import ArrowArray


@final
class SeenIds:
    """A growing set of ids that takes 8 bytes for each.

    Strings are represented by hashes of 64 bits: among ten million of them, one in four hundred thousand
    runs takes two for the same.
    """

    def __init__(self) -> None:
        # Sorted arrays, each less than half as long as the one before, so that few are merged and searched.
        self._parts: list[IntArray] = []

    def add(self, ids: ArrowArray) -> int | None:
        """Add ids, none of them null; return the position of one that was there, or comes twice, or None."""
        numbers = ids.to_numpy() if pa.types.is_integer(ids.type) else _hashes(ids)
        order = np.argsort(numbers, kind="stable")
        added = numbers[order]
        again = np.zeros(len(added), dtype=np.bool_)
        again[1:] = added[1:] == added[:-1]
        for part in self._parts:
            nearest = np.minimum(np.searchsorted(part, added), len(part) - 1)
            again |= part[nearest] == added
        if again.any():
            return int(order[again].min())
        while self._parts and len(self._parts[-1]) < 2 * len(added):
            added = np.sort(np.concatenate([self._parts.pop(), added]), kind="stable")
        if len(added):
            self._parts.append(added)
        return None


def _hashes(texts: ArrowArray) -> IntArray:
    return np.fromiter(map(hash, texts.to_pylist()), dtype=np.int64, count=len(texts))
