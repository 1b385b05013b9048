from __future__ import annotations

import math

import pytest

from experiments.mil.results import results_of, rows
from relforest.experiments.mil.data import HELD_OUT
from relforest.experiments.mil.means import means
from relforest.experiments.mil.methods import IMPROVED


def test_stopped_methods_are_compared_in_two_ways() -> None:
    results = results_of(
        rows("color", IMPROVED, pss=[0.8, 0.8]),
        rows("musk1", IMPROVED, pss=[0.4, 0.4]),
        rows("color", "dd", pss=[0.7, 0.7]),
        rows("musk1", "dd", pss=[0.9, None]),
    )
    dd = means(results, "dd")

    assert (dd.n_data_sets, dd.n_stopped) == (2, 1)
    assert dd.with_zeros == pytest.approx(0.35)
    assert dd.of_finished == pytest.approx(0.7)
    assert dd.improved_with_zeros == pytest.approx(0.6)
    assert dd.improved_on_finished == pytest.approx(0.8)
    # .8 - .7 is less than .6 - .35
    assert dd.lead == pytest.approx(0.1)


def test_the_improved_method_has_zeros_too() -> None:
    results = results_of(
        rows("color", IMPROVED, pss=[None]),
        rows("musk1", IMPROVED, pss=[0.4, 0.4]),
        rows("color", "dd", pss=[0.2, 0.2]),
        rows("musk1", "dd", pss=[0.3, 0.3]),
    )

    assert means(results, "dd").lead == pytest.approx((0.0 + 0.4 - 0.2 - 0.3) / 2)


def test_without_the_improved_method_there_is_no_lead() -> None:
    results = results_of(rows("color", "dd", pss=[0.2, 0.2]), rows("musk1", "dd", pss=[None]))

    assert math.isnan(means(results, "dd").lead)
    assert means(results, "dd").of_finished == pytest.approx(0.2)


def test_means_may_be_over_some_data_sets_only() -> None:
    results = results_of(
        rows("color", IMPROVED, pss=[0.8, 0.8]),
        rows("fox", IMPROVED, pss=[0.4, 0.4]),
        rows("color", "dd", pss=[0.2, 0.2]),
        rows("fox", "dd", pss=[0.3, 0.3]),
    )
    held_out = means(results, "dd", HELD_OUT)

    assert (held_out.n_data_sets, held_out.n_stopped) == (1, 0)
    assert (held_out.with_zeros, held_out.of_finished) == pytest.approx((0.3, 0.3))
    assert held_out.lead == pytest.approx(0.1)
    none = means(results, "dd", ["tiger"])
    assert (none.n_data_sets, none.n_stopped) == (0, 0)
    assert all(map(math.isnan, (none.with_zeros, none.of_finished, none.improved_with_zeros, none.lead)))


def test_a_method_that_never_finished_is_compared_with_zeros() -> None:
    results = results_of(rows("color", IMPROVED, pss=[0.8, 0.8]), rows("color", "dd", pss=[None]))
    dd = means(results, "dd")

    assert math.isnan(dd.of_finished)
    assert dd.lead == pytest.approx(0.8)
