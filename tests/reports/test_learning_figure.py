from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes

from relforest.reports.learning_figure import leaves_figure, mean_and_deviation, reward_figure
from relforest.support.errors import InputError
from reports.drawn_trees import texts_of


def run(*rewards: float) -> list[dict[str, Any]]:
    return [
        {"iteration": i, "test_reward": reward, "leaves": 3 * i, "train_reward": None, "trees": i}
        for i, reward in enumerate(rewards)
    ]


def curves(axes: Axes) -> list[list[float]]:
    """The ordinates of every curve whose points are marked."""
    return [np.asarray(line.get_ydata()).tolist() for line in axes.lines if line.get_linestyle() == "-"]


def test_means_and_deviations_are_across_runs() -> None:
    iterations, means, deviations = mean_and_deviation([run(1, 5), run(3, 5), run(2)], "test_reward")

    # 1, 3 and 2 have the mean 2 and the sample variance (1 + 1 + 0) / 2 = 1; the third run has no more.
    assert iterations.tolist() == [0, 1]
    assert means.tolist() == [2, 5]
    assert deviations.tolist() == [1, 0]


def test_a_single_run_has_no_deviation_and_no_bars() -> None:
    assert mean_and_deviation([run(1, 5)], "test_reward")[2].tolist() == [0, 0]

    (axes,) = reward_figure({"a": [run(1, 5)]}).axes
    assert list(axes.collections) == []


def test_every_series_is_drawn_and_named() -> None:
    figure = reward_figure(
        {"_500 $episodes$": [run(1, 8), run(3, 9)], "10 episodes": [run(1, 4)]},
        title="Corridor",
        optimum=8.69,
    )
    (axes,) = figure.axes

    assert len(axes.containers) == 2
    assert {"_500 $episodes$", "10 episodes", "Corridor", "optimum\n8.69"} <= set(texts_of(figure))
    assert "mean and standard deviation of 2 runs" in texts_of(figure)
    assert curves(axes)[0] == [2, 8.5]
    assert len(axes.collections) == 1


def test_leaves_are_drawn_too() -> None:
    (axes,) = leaves_figure({"bits": [run(1, 2, 3)]}).axes

    assert curves(axes) == [[0, 3, 6]]
    assert axes.get_ylabel() == "leaves of all trees"


def test_there_must_be_something_to_draw() -> None:
    with pytest.raises(InputError, match="pass at least one series"):
        reward_figure({})
    with pytest.raises(InputError, match="at least one run with one row"):
        reward_figure({"a": [[]]})
    with pytest.raises(InputError, match="'iteration' or 'test_reward' is missing or not a number"):
        reward_figure({"a": [[{"iteration": 0}]]})
