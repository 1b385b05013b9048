"""Weights of bags: what is accepted, and that they count."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from relforest.mil.bag_weights import bag_weights
from relforest.support.errors import InputError

CODES = np.array([0, 1, 1, 0])
CLASSES = np.array(["far", "near"])


@pytest.mark.parametrize("scale", [1.0, 1e-300, 1e300])
def test_only_their_ratios_matter_and_bags_without_weight_are_left_out(scale: float) -> None:
    weights, kept = bag_weights(scale * np.array([1.0, 0.0, 3.0, 2.0]), CODES, CLASSES)

    assert weights == pytest.approx([0.5, 0.0, 1.5, 1.0])
    assert kept.tolist() == [0, 2, 3]


def test_none_stands_for_equal_ones() -> None:
    for given in (None, [7, 7, 7, 7], np.array([True] * 4)):
        weights, kept = bag_weights(given, CODES, CLASSES)

        assert weights.tolist() == [1.0] * 4
        assert kept.tolist() == [0, 1, 2, 3]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ([1.0, 1.0], "got 2 weights for 4 bags: give one weight for each"),
        (np.ones((4, 1)), r"must be 1-D, one weight for each bag, got the shape \(4, 1\)"),
        (2.0, "must be 1-D"),
        ([1.0, -1.0, 1.0, 1.0], "sample_weight of bag 1 is -1.0: weights are finite and at least 0"),
        ([1.0, 1.0, np.nan, 1.0], "sample_weight of bag 2 is nan"),
        ([1.0, 1.0, 1.0, np.inf], "sample_weight of bag 3 is inf"),
        (["heavy", 1, 1, 1], "sample_weight must contain numbers"),
        ([1.0, 0.0, 0.0, 1.0], "all bags of class 'near' have zero weight"),
        ([0.0, 0.0, 0.0, 0.0], "all bags of class 'far' have zero weight"),
    ],
)
def test_other_things_are_refused(given: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        bag_weights(given, CODES, CLASSES)
