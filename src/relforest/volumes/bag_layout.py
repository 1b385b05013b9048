"""Bags rearranged so that the nearest instance of every bag is found by vectorised minima."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray


NO_EVIDENCE: Final = np.empty((0, 2))
"""Of bags that are only counted."""


class SlotMajor(NamedTuple):
    """Instances ordered by their slot (first instance of every bag, then second, ...).

    Bags are sorted by descending size, so slot j holds one instance of each of the first bags, and
    the minimum over a bag becomes an elementwise minimum of slices.
    """

    points: NDArray[np.float64]  # (d, n_points), instance j of bag i in column offsets[j] + i
    offsets: NDArray[np.int64]  # (n_slots + 1,), slot j ends where slot j + 1 begins
    weights: NDArray[np.int64]  # (n_bags,) 2**32 for positive bags, 1 for negative ones
    evidence: NDArray[np.float64]  # (2, n_bags) see `aggregate`; (2, 0) if there is none


class Instances(NamedTuple):
    """Labelled bags as the caller has them."""

    points: NDArray[np.float64]  # (n_points, d) grouped by bag
    starts: NDArray[np.int64]  # (n_bags + 1,)
    labels: NDArray[np.bool_]  # (n_bags,)
    evidence: NDArray[np.float64]  # (n_bags, 2) or `NO_EVIDENCE`


@kernel
def slot_major(instances: Instances) -> tuple[SlotMajor, NDArray[np.int64]]:
    """Rearrange instances; return the layout and its numbers of the positive bags, in the caller's order."""
    points, starts, labels, evidence = instances
    n_bags, n_slots = len(labels), 0
    for bag in range(n_bags):
        n_slots = max(n_slots, starts[bag + 1] - starts[bag])
    # How many bags have more than j instances is the size of slot j, and where smaller bags come in order.
    offsets = np.zeros(n_slots + 1, dtype=np.int64)
    sizes = np.zeros(n_slots + 1, dtype=np.int64)
    for bag in range(n_bags):
        sizes[starts[bag + 1] - starts[bag] - 1] += 1
    for slot in range(n_slots - 1, -1, -1):
        sizes[slot] += sizes[slot + 1]
    for slot in range(n_slots):
        offsets[slot + 1] = offsets[slot] + sizes[slot]
    arranged = np.empty((points.shape[1], len(points)))
    weights = np.empty(n_bags, dtype=np.int64)
    positives = np.empty(np.count_nonzero(labels), dtype=np.int64)
    own_evidence = np.empty((2, len(evidence)))
    next_place = sizes[1:].copy()
    n_positive = 0
    for bag in range(n_bags):
        size = starts[bag + 1] - starts[bag]
        place = next_place[size - 1]
        next_place[size - 1] += 1
        weights[place] = 2**32 if labels[bag] else 1
        if labels[bag]:
            positives[n_positive] = place
            n_positive += 1
        for i in range(2 if len(evidence) > 0 else 0):
            own_evidence[i, place] = evidence[bag, i]
        for slot in range(size):
            for i in range(points.shape[1]):
                arranged[i, offsets[slot] + place] = points[starts[bag] + slot, i]
    return SlotMajor(arranged, offsets, weights, own_evidence), positives
