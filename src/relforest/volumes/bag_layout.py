"""Bags rearranged so that the nearest instance of every bag is found by vectorised minima."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray


class SlotMajor(NamedTuple):
    """Instances ordered by their slot (first instance of every bag, then second, ...).

    Bags are sorted by descending size, so slot j holds one instance of each of the first bags, and
    the minimum over a bag becomes an elementwise minimum of slices.
    """

    points: NDArray[np.float64]  # (d, n_points), instance j of bag i in column offsets[j] + i
    offsets: NDArray[np.int64]  # (n_slots + 1,), slot j ends where slot j + 1 begins
    weights: NDArray[np.int64]  # (n_bags,) 2**32 for positive bags, 1 for negative ones


def slot_major(
    points: NDArray[np.float64], starts: NDArray[np.int64], labels: NDArray[np.bool_]
) -> tuple[SlotMajor, NDArray[np.int64]]:
    """Rearrange instances (n_points, d), grouped by bag from `starts` (n_bags + 1,).

    Returns the layout and its numbers of the positive bags, in the caller's order.
    """
    bag_sizes = np.diff(starts)
    order = np.argsort(-bag_sizes, kind="stable")
    descending = bag_sizes[order]
    slot_sizes = np.searchsorted(-descending, -np.arange(descending[0]), side="left")
    offsets = np.zeros(len(slot_sizes) + 1, dtype=np.int64)
    np.cumsum(slot_sizes, out=offsets[1:])
    arranged = np.empty((points.shape[1], len(points)))
    _arrange(points, starts[order], offsets, arranged)
    layout = SlotMajor(arranged, offsets, np.where(labels[order], 2**32, 1))
    return layout, np.argsort(order)[labels]


@kernel
def _arrange(
    points: NDArray[np.float64],
    first: NDArray[np.int64],
    offsets: NDArray[np.int64],
    arranged: NDArray[np.float64],
) -> None:
    for slot in range(len(offsets) - 1):
        for bag in range(offsets[slot + 1] - offsets[slot]):
            for i in range(points.shape[1]):
                arranged[i, offsets[slot] + bag] = points[first[bag] + slot, i]
