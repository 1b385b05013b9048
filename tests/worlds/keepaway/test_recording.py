from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from relforest.support.errors import InputError
from worlds.keepaway.recorded_games import recording


def test_a_recording_counts_its_cycles_and_players() -> None:
    game = recording(keepers=4, takers=3, cycles=30)

    assert (game.duration, game.keepers, game.takers) == (30, 4, 3)
    assert len(game.players) == len(game.ball) == 31


def test_a_trail_ends_at_the_present() -> None:
    game = recording(cycles=30)
    trail = game.trail(20, cycles=4)

    assert trail.shape == (5, 6, 2)
    assert trail[-1, :5].tolist() == game.players[20, :, :2].tolist()
    assert trail[0, 5].tolist() == game.ball[16, :2].tolist()
    assert len(game.trail(2, cycles=4)) == 3
    assert len(game.trail(0)) == 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"players": np.zeros((41, 5, 4))}, r"players must have the shape \(41, 5, 5\), got \(41, 5, 4\)"),
        ({"ball": np.zeros((40, 4))}, r"ball must have the shape \(41, 4\), got \(40, 4\)"),
        ({"commands": np.zeros((41, 5, 3), dtype=np.int64)}, r"commands must have the shape \(40, 5, 3\)"),
        ({"keepers": 4}, "4 keepers among 5 players do not agree with decisions of 3 keepers"),
        ({"end": 4}, "end must be a code from 0 to 3, got 4"),
    ],
)
def test_shapes_and_codes_are_checked(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        replace(recording(), **change)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["actors", "actions", "orders", "values"])
def test_the_columns_of_decisions_are_equally_long(name: str) -> None:
    decisions = recording().decisions
    assert len(decisions) > 0

    with pytest.raises(InputError, match=f"{name} must have the shape"):
        replace(decisions, **{name: getattr(decisions, name)[1:]})
