from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, FancyArrowPatch, Rectangle, Wedge

from relforest.mappings import Mapping
from relforest.reports.question_panel import volume_table
from relforest.reports.question_points import QuestionPoints
from relforest.reports.volume_panel import draw_volume
from relforest.volumes import Arc, Ellipsoid
from reports.drawn_trees import BALL, DISC, NEAR, SCHEMA, texts_of

DIFFERENCE = Mapping("difference", SCHEMA["location"])
DISTANCE = Mapping("distance", SCHEMA["location"])
COLOR = Mapping("identity", SCHEMA["color"])
ORIENTATION = Mapping("identity", SCHEMA["orientation"])


@pytest.fixture
def axes() -> Axes:
    return Figure().add_axes((0.2, 0.2, 0.6, 0.6))


def points(*values: tuple[float, ...]) -> QuestionPoints:
    return QuestionPoints(np.array(values, dtype=float), np.arange(len(values)) % 2 == 0)


def test_an_ellipse_has_the_shape_of_its_volume(axes: Axes) -> None:
    # V = R diag(4, 1) R' with R a turn by 30 degrees; radius 0.5 gives semi-axes 1 and 0.5.
    turn = np.array([[math.sqrt(3) / 2, -0.5], [0.5, math.sqrt(3) / 2]])
    volume = Ellipsoid(np.array([3.0, 4.0]), turn @ np.diag([4.0, 1.0]) @ turn.T, 0.5, 5, 0.1)
    draw_volume(axes, DIFFERENCE, volume)
    ellipse = next(patch for patch in axes.patches if isinstance(patch, Ellipse))

    assert tuple(ellipse.center) == (3.0, 4.0)
    assert [ellipse.width, ellipse.height] == pytest.approx([2.0, 1.0])
    assert ellipse.angle % 180 == pytest.approx(30.0)
    assert len([patch for patch in axes.patches if isinstance(patch, FancyArrowPatch)]) == 2


def test_both_axes_have_the_same_scale_and_show_the_whole_ellipse(axes: Axes) -> None:
    draw_volume(axes, DIFFERENCE, DISC, points((1, 0), (1.2, 0.1), (0.9, 0)))
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    room = axes.get_window_extent()

    assert (right - left) / room.width == pytest.approx((high - low) / room.height)
    # The ellipse reaches from 0 to 2 and from -0.5 to 0.5.
    assert left < 0.0
    assert right > 2.0
    assert low < -0.5
    assert high > 0.5


def test_far_points_do_not_make_a_small_volume_invisible(axes: Axes) -> None:
    draw_volume(axes, DIFFERENCE, DISC, points((1000, 0), (-1000, 0), (0, 1000), (0, -1000)))

    assert axes.get_xlim()[1] - axes.get_xlim()[0] < 10


def test_of_a_huge_volume_only_the_part_with_points_is_shown(axes: Axes) -> None:
    huge = Ellipsoid(np.array([1000.0, 0.0]), np.eye(2), 1000.5, 5, 0.1)
    draw_volume(axes, DIFFERENCE, huge, points((0, 0), (1, 1), (-1, 1)))

    assert axes.get_xlim()[1] < 10


def test_a_single_point_can_be_shown(axes: Axes) -> None:
    draw_volume(axes, DISTANCE, Ellipsoid(np.array([2.0]), np.eye(1), 0.0, 1, 0.1), points((2.0,)))

    assert axes.get_xlim() == (1.5, 2.5)


def test_an_interval_reaches_one_extent_to_either_side(axes: Axes) -> None:
    draw_volume(axes, DISTANCE, Ellipsoid(np.array([3.0]), np.array([[4.0]]), 0.5, 5, 0.1))
    (interval,) = (patch for patch in axes.patches if isinstance(patch, Rectangle))

    assert (interval.get_x(), interval.get_width()) == (2.0, 2.0)
    assert axes.get_xlabel() == "distance(location)"


def test_histograms_show_shares_of_either_class(axes: Axes) -> None:
    draw_volume(axes, DISTANCE, NEAR, points((0.0,), (1.0,), (0.1,), (1.1,), (0.2,)))
    heights = np.array([patch.get_height() for patch in axes.patches if isinstance(patch, Rectangle)][1:])

    assert heights[heights > 0].sum() == pytest.approx(1.0)
    assert heights[heights < 0].sum() == pytest.approx(-1.0)


def test_beyond_two_dimensions_the_distance_in_radii_is_shown(axes: Axes) -> None:
    draw_volume(axes, COLOR, BALL, points((0, 0, 0), (2, 0, 0)), np.array([0.5, 0.0, 0.0]))
    interval = next(patch for patch in axes.patches if isinstance(patch, Rectangle))

    assert (interval.get_x(), interval.get_width()) == (0.0, 1.0)
    assert axes.get_xlabel() == "Mahalanobis distance / radius"
    assert axes.get_xlim()[0] == 0.0
    assert axes.lines[-1].get_xdata()[0] == 0.5  # type: ignore[index]  # an array, whatever its declaration


def test_an_arc_is_a_wedge_around_its_mean(axes: Axes) -> None:
    draw_volume(
        axes, ORIENTATION, Arc(math.pi / 2, math.pi / 4, 1.0), points((1.0,), (3.0,)), np.array([1.5])
    )
    (wedge,) = (patch for patch in axes.patches if isinstance(patch, Wedge))

    assert [wedge.theta1, wedge.theta2] == pytest.approx([45.0, 135.0])
    assert {"0", "π/2", "π", "-π/2"} <= set(texts_of(axes.figure.get_figure(root=True)))


def test_an_arc_of_more_than_a_turn_is_the_whole_circle(axes: Axes) -> None:
    draw_volume(axes, ORIENTATION, Arc(1.0, 4.0, 1.0))
    (wedge,) = (patch for patch in axes.patches if isinstance(patch, Wedge))

    assert (wedge.theta1, wedge.theta2) == (0, 360)


def test_frames_name_their_axes(axes: Axes) -> None:
    draw_volume(axes, Mapping("reframe", SCHEMA["location"]), DISC)

    assert (axes.get_xlabel(), axes.get_ylabel()) == ("along", "across")


def test_tables_of_volumes() -> None:
    assert volume_table(NEAR) == (("mean", "0"), ("extent", "2"))
    assert volume_table(Arc(1.0, 0.25, 3.0)) == (("mean", "1 rad"), ("radius", "0.25 rad"), ("kappa", "3"))
    assert [name for name, _ in volume_table(BALL)] == ["mean", "extent 1", "extent 2", "extent 3"]
    wide = Ellipsoid(np.zeros(6), np.diag([36.0, 25.0, 16.0, 9.0, 4.0, 1.0]), 1.0, 5, 0.1)
    assert volume_table(wide)[0] == ("mean", "(0, 0, 0, 0, …)")
    assert volume_table(wide)[-1] == ("", "and 3 shorter ones")
