"""The compiled players perceive, remember and command what their plain twin does, from the same states."""

from __future__ import annotations

import os

import numpy as np
import pytest

from reference.keepaway_agreement import Comparison, compare_games, compare_states
from relforest.worlds.keepaway.play.advance import HAND, HOLD, RANDOM
from relforest.worlds.keepaway.server.layout import DASH, KICK, TURN, Setup
from relforest.worlds.keepaway.server.options import KeepawayOptions

# Interpreted, the twin takes 0.03 seconds for a cycle.
INTERPRETED = os.environ.get("NUMBA_DISABLE_JIT") == "1"
CYCLES = 40 if INTERPRETED else 300
STATES = 12 if INTERPRETED else 300


def setup_of(
    keepers: int, takers: int, size: float | tuple[float, float], perception: str = "quantised"
) -> Setup:
    options = KeepawayOptions(
        keepers=keepers, takers=takers, size=size, perception=perception, stuck_ball=100
    )
    return options.setup()


def disagreements(compared: list[Comparison]) -> list[str]:
    return [str(comparison) for comparison in compared if comparison.differs]


@pytest.mark.parametrize("policy", [RANDOM, HOLD, HAND])
@pytest.mark.parametrize("perception", ["quantised", "exact", "fullstate"])
def test_players_of_the_benchmark_agree(perception: str, policy: int) -> None:
    compared = compare_games(setup_of(3, 2, 20.0, perception), policy, cycles=CYCLES)

    assert len(compared) == CYCLES
    assert disagreements(compared) == []


@pytest.mark.parametrize(
    ("keepers", "takers", "size", "policy", "perception"),
    [
        (2, 1, 60.0, RANDOM, "quantised"),
        (3, 3, (90.0, 30.0), HAND, "quantised"),
        (3, 4, 15.0, HAND, "exact"),
        (4, 3, 25.0, RANDOM, "quantised"),
        (4, 3, 25.0, HAND, "quantised"),
        (6, 5, (30.0, 24.0), RANDOM, "quantised"),
        (6, 5, 30.0, HAND, "exact"),
    ],
)
def test_other_games_agree(
    keepers: int, takers: int, size: float | tuple[float, float], policy: int, perception: str
) -> None:
    setup = setup_of(keepers, takers, size, perception)

    assert disagreements(compare_games(setup, policy, cycles=CYCLES // 2, seed=1)) == []


@pytest.mark.parametrize("perception", ["quantised", "exact", "fullstate"])
@pytest.mark.parametrize(("keepers", "takers", "size"), [(3, 2, 20.0), (3, 4, 15.0), (2, 1, 60.0)])
def test_players_agree_wherever_they_are(keepers: int, takers: int, size: float, perception: str) -> None:
    compared = compare_states(setup_of(keepers, takers, size, perception), HAND, states=STATES)

    assert len(compared) == STATES
    assert disagreements(compared) == []


def test_all_kinds_of_commands_are_compared() -> None:
    compared = compare_games(setup_of(3, 2, 20.0), RANDOM, cycles=30)
    kinds = np.concatenate([comparison.commands[:, 0] for comparison in compared])

    assert set(kinds.tolist()) == {DASH, TURN, KICK}
