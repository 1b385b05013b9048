from __future__ import annotations

import numpy as np
import pytest

from relforest.experiments.blocks.samples import Mean, Samples
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
    samples = Samples.of(TABLE)

    np.testing.assert_array_equal(samples["settle", "a", "steps"], [1, 5])
    np.testing.assert_array_equal(samples["settle", "b", "steps"], [2])
    np.testing.assert_array_equal(samples["settle", "a", "height"], [3])
    assert len(samples["lift", "a", "steps"]) == 0
    assert samples.measured("settle", ("b", "c", "a"), "steps") == ["b", "a"]


def test_a_mean_has_its_interval() -> None:
    # The deviation of 1 and 5 is sqrt(8); 1.96 * sqrt(8) / sqrt(2) = 3.92.
    found = Samples.of(TABLE).mean(("settle", "a", "steps"))

    assert found.value == 3.0
    assert found.error == pytest.approx(3.92)
    assert found.text() == "3.00 +- 3.92"
    assert found.text(0) == "3 +- 4"


def test_too_few_values_have_no_interval() -> None:
    assert np.isnan(Mean.of(np.array([2.0])).error)
    assert np.isnan(Mean.of(np.empty(0)).value)
    assert Mean.of(np.empty(0)).text() == "-"


def test_intervals_of_differences_add_as_squares() -> None:
    difference = Mean(5.0, 3.0).minus(Mean(1.0, 4.0))

    assert (difference.value, difference.error) == (4.0, 5.0)
