from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from relforest.experiments.blocks.run import compute
from relforest.experiments.blocks.settings import (
    ARCH_BLOCKS,
    ARCHES,
    BALANCE,
    BLOCK_COLORS,
    CAREFUL,
    COLOR_REFERENCE,
    COLORS,
    DROP_ON_LARGE,
    GROUPS,
    LIFT,
    OUTCOMES,
    POLICIES,
    RANDOM,
    RANDOM_RGB,
    SETTINGS,
    SETTLE,
    SPEED,
    TOWERS,
    UNIFORM_RGB,
    BlocksSetting,
)
from relforest.experiments.study import Context


def measured(part: str, condition: str, count: int = 1, *, seed: int = 0) -> dict[str, list[float]]:
    found: dict[str, list[float]] = {}
    for row in compute(BlocksSetting(part, condition, count), Context(seed, 0, Path())):
        assert (row["part"], row["condition"], row["chunk"]) == (part, condition, 0)
        found.setdefault(str(row["measure"]), []).append(float(row["value"] or 0))
    return found


def test_drops_are_followed_until_all_lie_still() -> None:
    found = measured(SETTLE, ARCH_BLOCKS, 4)

    assert len(found["steps"]) == len(found["height"]) == 4
    # Lying blocks have their centres at 2, upright ones at 4.
    assert all(10 <= steps < 2000 for steps in found["steps"])
    assert all(1.9 < height < 12 for height in found["height"])


def test_a_lift_takes_as_many_steps_as_in_the_authors_simulator() -> None:
    assert measured(LIFT, "2.75 x 2.75") == {"steps": [245.0]}


@pytest.mark.parametrize(
    ("part", "condition", "names"),
    [
        (TOWERS, RANDOM, {"score_before", "episode_steps", "total"}),
        (GROUPS, RANDOM_RGB, {"total"}),
        (ARCHES, CAREFUL, {"total", "stands"}),
    ],
)
def test_what_references_tell_of_is_kept(part: str, condition: str, names: set[str]) -> None:
    found = measured(part, condition, 2)

    assert set(found) >= names
    assert {len(found[name]) for name in names} == {2}
    options = {name for name in found if name.endswith(("duration", "success"))}
    assert bool(options) == (part == TOWERS)
    assert set(found) - names == options


def test_an_episode_of_random_play_has_five_options() -> None:
    found = measured(TOWERS, RANDOM, 3)
    durations = found["put_duration"] + found.get("rotate_duration", [])

    assert len(durations) == 15
    assert all(0 < duration < 26 for duration in durations)
    assert set(found["put_success"]) <= {0.0, 1.0}
    # A step of 0.01 s; the drop comes first.
    assert sum(found["episode_steps"]) > 100 * sum(durations)


@pytest.mark.parametrize("sampling", [UNIFORM_RGB, BLOCK_COLORS])
def test_distances_of_colors_are_those_expected(sampling: str) -> None:
    found = {name: values[0] for name, values in measured(COLORS, sampling, 20_000).items()}

    for name, expected in COLOR_REFERENCE[sampling].items():
        if name != "lab_max":
            assert found[name] == pytest.approx(expected, rel=0.04)
    assert 100 < found["lab_max"] < 120


def test_only_decided_scenes_have_labels() -> None:
    balance, drop = measured(OUTCOMES, BALANCE, 20), measured(OUTCOMES, DROP_ON_LARGE, 3)

    assert len(balance["decided"]) == 20
    assert len(balance["label"]) == sum(balance["decided"]) < 20
    assert len(drop["label"]) == 3


def test_speed_is_measured_after_a_first_episode() -> None:
    found = measured(SPEED, RANDOM, 1)

    assert len(found["milliseconds"]) == len(found["steps"]) == 1
    assert found["milliseconds"][0] > 0


def test_equal_seeds_give_equal_numbers() -> None:
    one, other, third = (measured(TOWERS, RANDOM, 2, seed=seed) for seed in (1, 1, 2))

    assert one == other
    assert one != third


def test_the_whole_study_plays_every_policy_a_thousand_times_at_least() -> None:
    for part, policies in POLICIES.items():
        for policy in policies:
            counts = [s.count for s in SETTINGS if (s.part, s.condition) == (part, policy)]
            assert np.sum(counts) >= 1000
