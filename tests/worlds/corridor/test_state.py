from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from relforest.support.errors import InputError
from relforest.worlds.corridor.state import CorridorState, initial_state


@pytest.mark.parametrize("x", [-1e-9, 1.0 + 1e-9, math.nan, math.inf])
def test_the_agent_is_inside_the_corridor(x: float) -> None:
    with pytest.raises(InputError, match="x must be a number of at least 0 and of at most 1"):
        CorridorState(x)


def test_steps_are_not_negative() -> None:
    with pytest.raises(InputError, match="steps must be an integer of at least 0, got -1"):
        CorridorState(0.5, -1)


def test_states_are_values() -> None:
    assert CorridorState(0.5, 1) == CorridorState(0.5, 1)
    assert len({CorridorState(0.0), CorridorState(0.0), CorridorState(1.0)}) == 2


def test_episodes_begin_uniformly_over_the_corridor() -> None:
    rng = np.random.default_rng(0)
    states = [initial_state(rng) for _ in range(4000)]
    counts, _ = np.histogram([state.x for state in states], bins=4, range=(0.0, 1.0))
    # Each quarter holds Binomial(4000, 1/4): mean 1000, standard deviation sqrt(750) = 27.4; 4 of them = 110.
    assert np.abs(counts - 1000).max() < 110
    assert {state.steps for state in states} == {0}


@pytest.mark.parametrize(("x", "steps"), [("0.5", 0), (True, 0), (None, 0), (0.5, 1.0), (0.5, "1")])
def test_states_hold_numbers(x: Any, steps: Any) -> None:
    with pytest.raises(InputError, match=r"x must be a number|steps must be an integer"):
        CorridorState(x, steps)


def test_numbers_of_other_kinds_become_plain_ones() -> None:
    x, steps = np.float32(0.5), np.int64(3)
    state = CorridorState(x, steps)  # type: ignore[arg-type]
    assert (type(state.x), type(state.steps)) == (float, int)
