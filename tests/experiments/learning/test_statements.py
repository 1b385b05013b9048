from __future__ import annotations

import numpy as np
import pytest

from relforest.experiments.learning.settings import LEARNERS, SETTINGS
from relforest.experiments.learning.statements import END, STATEMENTS, measured, training_and_test
from relforest.experiments.statements import statements_sheet
from relforest.experiments.table import Row, Table


def rows(
    played: str, condition: str, rewards: dict[int, list[float]], **others: list[float | None]
) -> list[Row]:
    return [
        {
            "played": played,
            "condition": condition,
            "episodes": episodes,
            "run": run,
            "reward": reward,
            "train": others.get("train", [None] * len(rewards))[place],
            "leaves": others.get("leaves", [None] * len(rewards))[place],
            "paid": 0.2 * run,
        }
        for place, (episodes, values) in enumerate(rewards.items())
        for run, reward in enumerate(values)
    ]


def verdicts(task: str, *parts: list[Row]) -> dict[str, str]:
    table = Table.of(row for part in parts for row in part)
    lines = statements_sheet(STATEMENTS[task], table).lines()[1:]
    return {line[0]: line[-1] for line in lines if line[-1] != "not run"}


def test_numbers_are_taken_after_some_episodes_or_in_the_end() -> None:
    table = Table.of(rows("arch", "smrf-rpi-500", {0: [1.0], 500: [2.0, 3.0]}, leaves=[None, 4.0]))
    assert measured(table, "arch", "smrf-rpi-500", 0).tolist() == [1.0]
    assert measured(table, "arch", "smrf-rpi-500", END).tolist() == [2.0, 3.0]
    assert measured(table, "arch", "smrf-rpi-500", END, "leaves").tolist() == [4.0, 4.0]
    assert not len(measured(table, "arch", "smrf-rpi-500", 0, "leaves"))
    assert not len(measured(table, "arch", "smrf-q", END))


def test_training_is_compared_with_the_test_before_it() -> None:
    table = Table.of(
        [
            *rows("keepaway", "a", {0: [50.0], 500: [60.0], 1000: [90.0]}, train=[None, 51.0, 61.0]),
            *rows("keepaway", "a", {0: [52.0], 500: [64.0], 1000: [70.0]}, train=[None, 52.0, 63.0]),
        ]
    )
    # Tests 60 and 64 after one batch, and 61 and 63 in the second, each without its mean.
    train, test = training_and_test(table, "keepaway", "a")
    np.testing.assert_array_equal(train, [-1.0, 1.0])
    np.testing.assert_array_equal(test, [-2.0, 2.0])
    assert not len(training_and_test(table, "keepaway", "b")[0])


def test_towers_are_judged() -> None:
    learned = rows("high-towers", "smrf-rpi-500", {0: [1.0, 1.1, 1.2], 5000: [4.0, 4.2, 5.4]})
    small = rows("high-towers", "small-first", {0: [5.2, 5.3, 5.4]})
    assert verdicts("high-towers", learned, small) == {
        "7.4.1 SMRF-RPI improves on random play": "holds",
        "7.4.1 small-first is above SMRF-RPI": "does not hold",
        "7.4.1 the best run of SMRF-RPI reaches the mean of small-first": "holds",
    }


def test_colors_and_arches_are_judged() -> None:
    lab = rows("color-grouping", "smrf-rpi-500", {500: [0.3, 0.4]}, leaves=[90.0])
    rgb = rows("color-grouping-rgb", "smrf-rpi-500-rgb", {500: [0.3, 0.4]}, leaves=[40.0])
    manual = rows("color-grouping-rgb", "manual", {0: [1.5, 1.6]})
    assert verdicts("color-grouping", lab, rgb, manual) == {
        "7.4.2 RGB: the hand-made policy is above SMRF-RPI": "holds",
        "7.4.2 more leaves with CIEDE2000 than with RGB": "holds",
    }
    arch = rows("arch-done", "smrf-rpi-500", {1500: [9.0, 9.5, 9.2], 2000: [12.0, 12.5, 12.2]})
    assert verdicts("arch", arch) == {
        "7.4.3 SMRF-RPI is better after four batches than after three": "holds",
        # 0, .2 and .4 of the episodes.
        "7.4.3 share of test episodes that end with an arch, best run in the end": "does not hold",
    }


def test_the_larger_game_is_judged_where_it_was_played() -> None:
    there = rows("keepaway-4v3", "smrf-rpi-500-once", {500: [60.0, 61.0, 62.0]})
    scratch = rows("keepaway-4v3", "cmac-sarsa-shared-4v3", {0: [40.0] * 3, 500: [45.0, 46.0, 47.0]})
    words = "7.5.2 4 against 3, one batch: SMRF-RPI of 3 against 2 is above CMAC Sarsa"
    assert verdicts("keepaway", there, scratch) == {words: "holds"}


@pytest.mark.parametrize("task", SETTINGS)
def test_everything_can_be_judged_by_the_whole_study(task: str) -> None:
    """All conditions with their iterations, in rows that grow with every batch."""
    found: list[Row] = []
    for setting in SETTINGS[task]:
        values = {setting.episodes * batch: [1.0 + batch] for batch in range(setting.iterations + 1)}
        others: dict[str, list[float | None]] = {
            "train": [0.1 * setting.run + 0.01 * batch for batch in range(len(values))],
            "leaves": [float(setting.run + batch) for batch in range(len(values))],
        }
        for played in dict.fromkeys((setting.task, *(("keepaway-4v3",) if setting.others else ()))):
            part = rows(played, setting.condition, values, **others)
            found += [dict(row, run=setting.run, reward=1.0 + 0.1 * setting.run) for row in part]
    assert len(verdicts(task, found)) == len(STATEMENTS[task])


def test_a_shorter_study_keeps_conditions_that_mean_a_number_of_batches() -> None:
    by_condition = {setting.condition: setting for setting in SETTINGS["keepaway"]}
    for condition, expected in (
        ("smrf-rpi-500", 2),
        ("smrf-rpi-500-once", 1),
        ("cmac-sarsa", 4),
        ("hand", 0),
    ):
        (setting,) = by_condition[condition].longer(4)
        assert setting.iterations == expected
    assert [setting.episodes for setting in by_condition["hand"].larger(7)] == [0]
    assert [setting.episodes for setting in by_condition["smrf-q"].larger(7)] == [7]
    assert {"smrf-rpi-500", "smrf-rpi-500-once"} < set(LEARNERS)
