from __future__ import annotations

import numpy as np

from relforest.experiments.samples import Samples
from relforest.experiments.table import Table

TABLE = Table.of(
    {"part": part, "condition": condition, "measure": measure, "value": value}
    for part, condition, measure, value in (
        ("settle", "a", "steps", 1.0),
        ("settle", "a", "steps", 5.0),
        ("settle", "b", "steps", 2.0),
        ("settle", "a", "height", 3.0),
        ("settle", "a", "height", None),
    )
)


def test_values_are_grouped_in_the_order_of_the_table() -> None:
    samples = Samples.of(TABLE, "part", "condition", "measure")

    np.testing.assert_array_equal(samples["settle", "a", "steps"], [1, 5])
    np.testing.assert_array_equal(samples["settle", "b", "steps"], [2])
    np.testing.assert_array_equal(samples["settle", "a", "height"], [3])
    assert len(samples["lift", "a", "steps"]) == 0
    assert samples.mean(("settle", "a", "steps")).value == 3.0
    assert list(samples.below("settle", "a")) == ["steps", "height"]
    assert list(samples.below("settle")) == ["a steps", "b steps", "a height"]
