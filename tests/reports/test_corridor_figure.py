from __future__ import annotations

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from relforest.reports.corridor_figure import BellmanErrors, LeafBand, corridor_figure
from relforest.support.errors import InputError
from reports.drawn_trees import texts_of

X = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
Q = np.array([[3.0, 2.0, 2.0, 1.0, 1.0], [1.0, 1.0, 1.0, 2.0, 3.0]])
ERRORS = BellmanErrors(np.array([0.1, 0.2, 0.9]), np.array([0, 0, 1]), np.array([1.0, 0.0, 0.25]))
BANDS = [LeafBand(0, np.array([0, 0, 1, 1, 0])), LeafBand(1, np.array([2, 2, 2, 2, 2]))]


def draw(bands: list[LeafBand] = BANDS, errors: BellmanErrors = ERRORS) -> Figure:
    return corridor_figure(X, Q, ["left", "right"], errors, bands, title="after iteration 1")


def ordinates(line: Line2D) -> list[float]:
    return [float(value) for value in np.asarray(line.get_ydata())]


def means_of(axes: Axes) -> list[float]:
    return [ordinates(line)[0] for line in axes.lines if line.get_linestyle() == ":"]


def bars_of(axes: Axes) -> list[tuple[float, float]]:
    return [(bar.get_x(), bar.get_width()) for bar in axes.patches if isinstance(bar, Rectangle)]


def test_values_errors_and_their_means_are_drawn() -> None:
    top, _ = draw().axes
    curves = [ordinates(line) for line in top.lines if len(ordinates(line)) == len(X)]

    assert curves == Q.tolist()
    # Errors of left: 1 and 0, mean 0.5; of right: 0.25.
    assert means_of(top) == [0.5, 0.25]
    assert [np.asarray(points.get_offsets()).tolist() for points in top.collections] == [
        [[0.1, 1.0], [0.2, 0.0]],
        [[0.9, 0.25]],
    ]


def test_the_ground_is_colored_by_the_best_action() -> None:
    top, _ = draw().axes
    # Left is best up to x = 0.5, right from 0.75 on; they meet half-way.
    assert bars_of(top) == [(0.0, 0.625), (0.625, 0.375)]


def test_bars_change_where_the_leaf_does() -> None:
    _, bottom = draw().axes
    colors = [bar.get_facecolor() for bar in bottom.patches]

    assert bars_of(bottom) == [(0.0, 0.375), (0.375, 0.5), (0.875, 0.125), (0.0, 1.0)]
    assert colors[0] == colors[2] != colors[1]


def test_everything_is_named() -> None:
    texts = set(texts_of(draw()))

    assert {"Q(left)", "Q(right)", "Bellman error", "its mean", "after iteration 1", "left", "right"} <= texts


def test_without_trees_or_errors_the_picture_says_so() -> None:
    none = BellmanErrors(np.empty(0), np.empty(0, dtype=np.int64), np.empty(0))
    figure = draw([], none)

    assert "no trees" in texts_of(figure)
    assert len(figure.axes[0].collections) == 0


def test_many_trees_need_no_more_than_the_height_of_the_curves() -> None:
    assert draw(BANDS * 50).get_figheight() == draw(BANDS * 500).get_figheight()
    assert "left" not in texts_of(draw(BANDS * 50))


def test_many_errors_are_thinned_but_their_mean_is_not() -> None:
    errors = BellmanErrors(
        np.linspace(0, 1, 4000), np.zeros(4000, dtype=np.int64), np.r_[np.zeros(3999), 4000.0]
    )
    top, _ = draw(errors=errors).axes

    assert len(np.asarray(top.collections[0].get_offsets())) == 1500
    assert means_of(top) == [1.0]


def test_shapes_must_agree() -> None:
    with pytest.raises(InputError, match=r"q_values must have the shape \(actions, x\) = \(3, 5\)"):
        corridor_figure(X, Q, ["left", "right", "stay"], ERRORS, [])
    with pytest.raises(InputError, match="at least 2 values"):
        corridor_figure(X[:1], Q[:, :1], ["left", "right"], ERRORS, [])
    with pytest.raises(InputError, match="one leaf per x and one of 2 actions"):
        corridor_figure(X, Q, ["left", "right"], ERRORS, [LeafBand(0, np.array([1, 2]))])
    with pytest.raises(InputError, match="one of 2 actions"):
        corridor_figure(X, Q, ["left", "right"], ERRORS, [LeafBand(2, np.array([1, 2, 1, 1, 1]))])
