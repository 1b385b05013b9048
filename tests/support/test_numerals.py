"""Rounded numbers say nothing that the exact ones do not."""

from __future__ import annotations

import math
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.support.numerals import ends, finite, number, probability, rounded, vector

# Rounding up the largest numbers would leave the range.
FINITE = st.floats(-1e308, 1e308)


@pytest.mark.parametrize(
    ("value", "step", "expected"),
    [
        (26.6309, 0.001, "26.631"),
        (26.6309, 0.0019, "26.631"),
        (26.6309, 0.0, "26.6309"),
        (123456.0, 1000.0, "123000"),
        (-0.001, 0.1, "0"),
        (-0.0, 0.1, "0"),
        (1582218195.3, 0.01, "1582218195.3"),
        (5.0, 1e300, "0"),
        (1e308, 1e-300, "1e+308"),
        (sys.float_info.max, 1e307, "1.8e+308"),
        (5e-324, 0.0, "5e-324"),
    ],
)
def test_values_are_rounded_to_a_power_of_ten_at_most_the_step(
    value: float, step: float, expected: str
) -> None:
    assert rounded(value, step) == expected


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (0.0, "0"),
        (0.0714285, "0.0714"),
        (0.00001234, "0.0000123"),
        (1000.0, "1000"),
        (123456.0, "123000"),
        (-2e7, "-20000000"),
        (1.768e200, "1.77e+200"),
        (1.2e-12, "1.2e-12"),
    ],
)
def test_three_digits_are_plain_as_long_as_that_is_short(value: float, expected: str) -> None:
    assert number(value) == expected


@given(FINITE)
def test_three_digits_are_within_half_a_percent(value: float) -> None:
    assert float(number(value)) == pytest.approx(value, rel=0.00501, abs=5e-324)


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (26.57047, 26.63093, ("26.5705", "26.6309")),
        (1582218195.1, 1582218195.5, ("1582218195.1", "1582218195.5")),
        (0.199123, 3.06871, ("0.199", "3.07")),
        # The near end of what is a half-line in effect keeps its digits.
        (3.0, 2e6, ("3", "2000000")),
        (-1e-17, 2.0, ("0", "2")),
        (1e-20, 2e-20, ("1e-20", "2e-20")),
        (0.9999999, 1.0, ("0.9999999", "1")),
        (-sys.float_info.max, sys.float_info.max, ("-1.8e+308", "1.8e+308")),
    ],
)
def test_the_ends_of_an_interval(low: float, high: float, expected: tuple[str, str]) -> None:
    assert ends(low, high) == expected


@given(FINITE, FINITE)
def test_different_ends_read_differently_and_are_nearly_right(one: float, other: float) -> None:
    low, high = sorted((one, other))
    low_read, high_read = (float(text) for text in ends(low, high))
    width = finite(high - low)

    assert (low_read < high_read) == (low < high)
    room = 0.005001 * width + 4 * math.ulp(max(abs(low), abs(high)))
    assert abs(low_read - low) <= room
    assert abs(high_read - high) <= room


def test_vectors() -> None:
    assert vector([0.498, -0.0073], 0.01) == "(0.5, -0.01)"
    assert vector([-0.001, 1.0], 0.1) == "(0, 1)"
    assert vector(range(8), 1.0) == "(0, 1, 2, 3, 4, 5, 6, 7)"
    assert vector(range(9), 1.0) == "(0, 1, 2, 3, ...)"


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (0.0, "0.00"),
        (0.5, "0.50"),
        (1.0, "1.00"),
        (0.25, "0.25"),
        (195 / 197, "0.99"),
        (249 / 250, "0.996"),
        (1 / 250, "0.004"),
        (249 / 500, "0.498"),
        (0.999999, "0.999999"),
        (math.nextafter(1.0, 0.0), "0.9999999999999999"),
        (math.nextafter(0.5, 0.0), "0.4999999999999999"),
        (1e-300, "1e-300"),
    ],
)
def test_only_certainty_reads_as_certain_and_only_a_draw_as_even(value: float, expected: str) -> None:
    assert probability(value) == expected


def test_infinite_values_become_the_largest() -> None:
    assert finite(math.inf) == sys.float_info.max
    assert finite(-math.inf) == -sys.float_info.max
    assert finite(3.0) == 3.0
