from __future__ import annotations

import math

import numpy as np
import pytest

from relforest.support.errors import InputError
from relforest.support.options import at_least, between, in_range, one_of


@pytest.mark.parametrize("value", [3, np.int32(3), np.uint8(3)])
def test_at_least_returns_a_plain_integer(value: object) -> None:
    result = at_least("episodes", value, 1)

    assert type(result) is int
    assert result == 3


@pytest.mark.parametrize("value", [0, -1, 2.0, np.float64(2), "2", None, True, np.True_])
def test_at_least_refuses_what_is_too_small_or_no_integer(value: object) -> None:
    with pytest.raises(InputError, match=r"episodes must be an integer of at least 1, got "):
        at_least("episodes", value, 1)


def test_at_least_allows_the_bound_itself() -> None:
    assert at_least("depth", 0, 0) == 0


@pytest.mark.parametrize("value", [0.5, np.float32(0.5)])
def test_in_range_returns_a_plain_float(value: object) -> None:
    result = in_range("alpha", value, 0, 1)

    assert type(result) is float
    assert result == 0.5


def test_in_range_includes_its_bounds_unless_they_are_open() -> None:
    assert in_range("alpha", 0, 0, 1) == 0.0
    assert in_range("alpha", 1, 0, 1) == 1.0
    with pytest.raises(InputError, match=r"alpha must be a number above 0 and of at most 1, got 0"):
        in_range("alpha", 0, 0, 1, open_low=True)
    with pytest.raises(InputError, match=r"alpha must be a number of at least 0 and below 1, got 1"):
        in_range("alpha", 1, 0, 1, open_high=True)


@pytest.mark.parametrize("value", [math.nan, -0.1, 1.1, math.inf, True, "0.5", None, 1j])
def test_in_range_refuses_what_is_outside_or_no_number(value: object) -> None:
    with pytest.raises(InputError, match=r"alpha must be a number of at least 0 and of at most 1, got "):
        in_range("alpha", value, 0, 1)


def test_in_range_says_finite_when_only_infinity_is_excluded() -> None:
    assert in_range("weight", 1e300, 0, math.inf, open_high=True) == 1e300
    with pytest.raises(InputError, match=r"weight must be a finite number of at least 0, got inf"):
        in_range("weight", math.inf, 0, math.inf, open_high=True)
    with pytest.raises(InputError, match=r"shift must be a finite number, got inf"):
        in_range("shift", math.inf, -math.inf, math.inf, open_low=True, open_high=True)
    with pytest.raises(InputError, match=r"shift must be a number, got nan"):
        in_range("shift", math.nan, -math.inf, math.inf)


def test_one_of_lists_the_choices_when_it_refuses() -> None:
    choices = ("likelihood-ratio", "permutation")

    assert one_of("test", "permutation", choices) == "permutation"
    for value in ("chi", None, 0, ["permutation"]):
        with pytest.raises(InputError, match=r"test must be one of 'likelihood-ratio', 'permutation', got "):
            one_of("test", value, choices)


@pytest.mark.parametrize("value", [1, np.int32(3), np.uint8(5)])
def test_between_returns_a_plain_integer_and_allows_both_bounds(value: object) -> None:
    result = between("blocks", value, 1, 5)

    assert type(result) is int
    assert result == value


@pytest.mark.parametrize("value", [0, 6, 2**70, 2.0, np.float64(2), math.nan, "2", None, True, np.True_])
def test_between_refuses_what_is_outside_or_not_an_integer(value: object) -> None:
    with pytest.raises(InputError, match=r"blocks must be an integer from 1 to 5, got "):
        between("blocks", value, 1, 5)
