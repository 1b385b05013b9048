from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from relforest.support.errors import InputError
from relforest.worlds.blocks.recording import OptionRecord
from worlds.blocks.recorded_episodes import recording


def option(name: str, *blocks: int, target: float | None = None) -> OptionRecord:
    return OptionRecord(name, blocks, target, begin=2.5, end=11.0, reward=1.5, score=4.0)


def test_options_are_written_as_they_were_chosen() -> None:
    assert str(option("put", 3, 1)) == "put(3, 1)"
    assert str(option("rotate", 12)) == "rotate(12)"
    assert str(option("move", 2, target=-16.74)) == "move(2, x = \N{MINUS SIGN}16.7)"
    assert str(option("done")) == "done"
    assert option("done").duration == 8.5


def test_an_episode_adds_up() -> None:
    episode = recording(options=3)

    # Two seconds of falling, then three options of eight.
    assert episode.duration == 26.0
    assert episode.total_reward == pytest.approx(episode.last_score - episode.first_score)
    assert episode.last_score == pytest.approx(episode.poses[-1, :, 1].mean())


def test_an_episode_without_options_ends_as_it_began() -> None:
    episode = recording(options=0)

    assert (episode.total_reward, episode.last_score) == (0.0, episode.first_score)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"colors": np.zeros((4, 4))}, r"colors must have the shape \(4, 3\), got \(4, 4\)"),
        ({"half_extents": np.zeros((3, 2))}, r"half_extents must have the shape \(4, 2\)"),
        ({"poses": np.zeros((451, 4, 2))}, r"poses must have the shape \(451, 4, 3\)"),
        ({"held": np.zeros(3, dtype=np.int64)}, r"held must have the shape \(451,\), got \(3,\)"),
        ({"times": np.zeros(451) * np.nan}, "times must be finite and ascending"),
        ({"times": -np.arange(451.0)}, "times must be finite and ascending"),
        ({"marks": ()}, "marks must have an entry before each of 2 options and after the last, got 0"),
        ({"options": (option("put", 10, 14),) * 2}, r"put\(10, 14\) names a block .* \[10, 11, 12, 13\]"),
    ],
)
def test_what_does_not_agree_is_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        replace(recording(), **change)


def test_an_episode_has_at_least_one_moment() -> None:
    with pytest.raises(InputError, match="times must be finite and ascending"):
        replace(
            recording(),
            times=np.zeros(0),
            poses=np.zeros((0, 4, 3)),
            held=np.zeros(0, dtype=np.int64),
        )
