from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from relforest.experiments.learning.figures import SOURCE, figures
from relforest.experiments.learning.settings import LEARNERS, SETTINGS
from relforest.experiments.table import Row, Table


def rows(
    played: str, condition: str, rewards: dict[int, list[float]], leaves: int | None = None
) -> list[Row]:
    return [
        {"played": played, "condition": condition, "episodes": episodes, "reward": reward, "leaves": leaves}
        for episodes, values in rewards.items()
        for reward in values
    ]


def labels(figure: Figure) -> list[str]:
    (axes,) = figure.axes
    return [str(line.get_label()) for line in axes.get_lines() if not str(line.get_label()).startswith("_")]


def test_learners_have_curves_and_policies_lines() -> None:
    table = Table.of(
        [
            *rows("keepaway", "hand", {0: [160.0, 170.0]}),
            *rows("keepaway", "smrf-q", {0: [50.0], 100: [140.0, 150.0]}),
            *rows("keepaway", "smrf-q, 5 questions", {100: [90.0]}),
        ]
    )
    found = figures("keepaway", table)
    assert list(found) == ["learning.png"]
    (axes,) = found["learning.png"].axes
    curve, line = axes.get_lines()
    np.testing.assert_array_equal(curve.get_xydata(), [[0.0, 50.0], [100.0, 145.0]])
    np.testing.assert_array_equal(line.get_ydata(), 165.0)


def test_the_sources_figures_show_its_conditions_alone() -> None:
    few = rows("keepaway", "smrf-rpi-50", {50: [100.0]}, leaves=30)
    shared = rows("keepaway", "cmac-sarsa-shared-50", {50: [70.0]}, leaves=0)
    others = [*rows("keepaway", "linear-q", {100: [130.0]}), *rows("keepaway", "cmac-sarsa", {1000: [90.0]})]
    found = figures("keepaway", Table.of([*few, *shared, *others]))
    assert {name: labels(figure) for name, figure in found.items()} == {
        "learning.png": ["linear-q", "cmac-sarsa"],
        "figure-7.21.png": ["smrf-rpi-50", "cmac-sarsa-shared-50"],
        "figure-7.23.png": ["cmac-sarsa"],
        "figure-7.25.png": ["smrf-rpi-50"],
        "figure-7.26.png": ["smrf-rpi-50"],
    }


def test_batches_of_different_sizes_are_compared_by_their_number() -> None:
    few = rows("keepaway", "smrf-rpi-50", {0: [50.0], 50: [60.0], 100: [70.0]})
    many = rows("keepaway", "smrf-rpi-500-single", {0: [50.0], 500: [80.0]})
    found = figures("keepaway", Table.of([*few, *many]))
    (by_batch,), (by_episode,) = (found[name].axes for name in ("figure-7.25.png", "figure-7.21.png"))
    numbers = [np.asarray(line.get_xdata()).tolist() for line in by_batch.lines]
    assert numbers == [[0, 1], [0, 1, 2]]
    assert by_batch.get_xlabel().startswith("batches of training episodes")
    np.testing.assert_array_equal(by_episode.lines[0].get_xdata(), [0, 50, 100])


def test_policies_without_learners_are_no_figure() -> None:
    assert figures("high-towers", Table.of(rows("high-towers", "large-first", {0: [8.0]}))) == {}


@pytest.mark.parametrize("task", SETTINGS)
def test_figures_are_about_settings_that_exist(task: str) -> None:
    there = {(setting.task, setting.condition) for setting in SETTINGS[task]}
    # Two are drawn where they were not learned.
    there |= {("keepaway-4v3", setting.condition) for setting in SETTINGS[task] if setting.others}
    for _, curves in SOURCE[task].values():
        assert set(curves) <= there
        assert any(condition in LEARNERS for _, condition in curves)
