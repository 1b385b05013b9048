"""Four small bags that stand in `tests/data` in every format that can be read."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from relforest.datasets import BagSet

DATA = Path(__file__).parents[1] / "data"
BAGS = [
    [[42, -198.5], [40, -191]],
    [[46, -194]],
    [[41, -188], [47, 150], [3, 0.25]],
    [[-5, 7]],
]
LABELS = [True, True, False, False]
IDS = ["MUSK-jf1", "MUSK-jf2", "NON-MUSK-1", "NON-MUSK-2"]


def assert_few_molecules(found: BagSet) -> None:
    assert [bag.tolist() for bag in found.bags] == BAGS
    assert found.labels.tolist() == LABELS
    assert found.bag_ids.tolist() == IDS


def assert_same_bags(found: BagSet, expected: BagSet) -> None:
    assert found.labels.tolist() == expected.labels.tolist()
    assert found.bag_ids.tolist() == expected.bag_ids.tolist()
    for left, right in zip(found.bags, expected.bags, strict=True):
        np.testing.assert_array_equal(left, right)
