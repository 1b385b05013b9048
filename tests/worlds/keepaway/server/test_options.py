from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from relforest.support.errors import InputError
from relforest.worlds.keepaway.server.layout import EXACT, FULLSTATE, QUANTISED, Setup
from relforest.worlds.keepaway.server.options import KeepawayOptions


def test_the_defaults_are_the_usual_task() -> None:
    assert KeepawayOptions().setup() == Setup(
        keepers=3, takers=2, length=20.0, width=20.0, perception=QUANTISED, stuck_ball=0, max_cycles=0
    )


def test_all_options_reach_the_setup_as_plain_numbers() -> None:
    options = KeepawayOptions(
        keepers=np.int64(5),  # type: ignore[arg-type]
        takers=4,
        size=(30, np.float64(25.5)),
        perception="exact",
        stuck_ball=100,
        max_cycles=1000,
    )

    assert options.n_players == 9
    assert options.setup() == Setup(5, 4, 30.0, 25.5, EXACT, 100, 1000)
    assert [type(value) for value in options.setup()] == [int, int, float, float, int, int, int]


@pytest.mark.parametrize("size", [(20, 25), [20, 25], np.array([20.0, 25.0])])
def test_a_field_may_be_longer_than_wide(size: Any) -> None:
    assert KeepawayOptions(size=size).setup()[2:4] == (20.0, 25.0)


def test_full_state_is_an_option() -> None:
    assert KeepawayOptions(perception="fullstate").setup().perception == FULLSTATE


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"keepers": 0}, "keepers must be an integer from 2 to 32, got 0"),
        ({"keepers": 1}, "keepers must be an integer from 2 to 32, got 1"),
        ({"keepers": 33}, "keepers must be an integer from 2 to 32, got 33"),
        ({"keepers": True}, "keepers must be"),
        ({"keepers": 3.0}, "keepers must be"),
        ({"takers": 0}, "takers must be an integer from 1 to 32, got 0"),
        ({"takers": 10**30}, "takers must be an integer from 1 to 32"),
        ({"takers": False}, "takers must be"),
        ({"takers": None}, "takers must be"),
        ({"size": 7.9}, "size must be a number of at least 8 and of at most 1000, got 7.9"),
        ({"size": 1001}, "size must be"),
        ({"size": math.nan}, "size must be"),
        ({"size": math.inf}, "size must be"),
        ({"size": -20}, "size must be"),
        ({"size": "20"}, "size must be"),
        ({"size": True}, "size must be"),
        ({"size": (20, math.nan)}, "size must be"),
        ({"size": (20,)}, "a length and a width"),
        ({"size": (20, 20, 20)}, "a length and a width"),
        ({"size": ()}, "a length and a width"),
        ({"perception": "noisy"}, "perception must be one of 'exact', 'quantised', 'fullstate'"),
        ({"perception": 1}, "perception must be"),
        ({"stuck_ball": -1}, "stuck_ball must be an integer from 0 to 1000000"),
        ({"stuck_ball": True}, "stuck_ball must be"),
        ({"max_cycles": -1}, "max_cycles must be an integer from 0 to 1000000, got -1"),
        ({"max_cycles": 1_000_001}, "max_cycles must be an integer from 0 to 1000000, got 1000001"),
        ({"stuck_ball": 2**63}, "stuck_ball must be an integer from 0 to 1000000"),
        ({"max_cycles": 0.5}, "max_cycles must be"),
    ],
)
def test_bad_options_are_named(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        KeepawayOptions(**options)
