from __future__ import annotations

import math
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, FancyArrowPatch, Rectangle, Wedge

from relforest.mappings import Mapping
from relforest.reports import save_figure
from relforest.reports.question_panel import volume_table
from relforest.reports.question_points import QuestionPoints
from relforest.reports.volume_panel import draw_volume
from relforest.volumes import Arc, Ellipsoid, Slab, Volume, volume_from_dict
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


def test_a_slab_is_drawn_as_the_interval_of_its_coordinate(axes: Axes) -> None:
    draw_volume(axes, DIFFERENCE, Slab(NEAR, 1, 2), points((0, 1), (9, 3)), np.array([5.0, 1.5]))

    assert axes.get_xlabel() == "location 2"
    assert axes.get_xlim()[1] < 5.0
    assert volume_table(Slab(NEAR, 1, 2)) == volume_table(NEAR)


def test_tables_of_volumes() -> None:
    assert volume_table(NEAR) == (("mean", "0"), ("extent", "2"))
    assert volume_table(Arc(1.0, 0.25, 3.0)) == (("mean", "1 rad"), ("radius", "0.25 rad"), ("kappa", "3"))
    assert [name for name, _ in volume_table(BALL)] == ["mean", "extent 1", "extent 2", "extent 3"]
    wide = Ellipsoid(np.zeros(6), np.diag([36.0, 25.0, 16.0, 9.0, 4.0, 1.0]), 1.0, 5, 0.1)
    assert volume_table(wide)[0] == ("mean", "(0, 0, 0, 0, …)")
    assert volume_table(wide)[-1] == ("", "and 3 shorter ones")


EXTREME_VOLUMES: dict[str, Volume] = {
    "far": Ellipsoid(np.array([1e40, -1e40]), np.eye(2), 1.0, 5, 0.1),
    "huge": Ellipsoid(np.zeros(2), np.diag([1e80, 1e66]), 1.0, 5, 0.1),
    "long": Ellipsoid(np.zeros(2), np.array([[1.0, 0.9], [0.9, 1.0]]) * 1e60, 1e5, 5, 0.1),
    "tiny": Ellipsoid(np.array([1.0, 2.0]), np.eye(2) * 1e-99, 0.0, 5, 0.1),
    "sharp": Ellipsoid(np.zeros(2), np.eye(2) * 1e-99, 1e89, 5, 1e15),
    "far interval": Ellipsoid(np.array([-1e40]), np.eye(1), 1e-90, 5, 0.1),
    "huge interval": Ellipsoid(np.array([3.0]), np.array([[1e80]]), 1.0, 5, 0.1),
    "huge ball": Ellipsoid(np.zeros(3), np.eye(3), 1e40, 5, 0.1),
    "point": Ellipsoid(np.ones(3) * 1e40, np.eye(3) * 1e-99, 1e-90, 5, 0.1),
    "far slab": Slab(Ellipsoid(np.array([-1e40]), np.eye(1), 1e-90, 5, 0.1), 1, 2),
    "huge slab": Slab(Ellipsoid(np.array([3.0]), np.array([[1e80]]), 1.0, 5, 0.1), 0, 3),
    "all around": Arc(1e6, 1e6, 1e12),
    "no arc": Arc(-1e6, 0.0, 0.0),
}
EXTREME_POINTS = (0.0, 1e-90, -3.5, 1e30, -1e40)


@pytest.mark.parametrize("name", EXTREME_VOLUMES)
@pytest.mark.parametrize("suffix", [".png", ".svg"])
def test_whatever_the_loader_admits_is_drawn(tmp_path: Path, name: str, suffix: str) -> None:
    volume = volume_from_dict(EXTREME_VOLUMES[name].to_dict())
    mapping = {1: DISTANCE, 2: DIFFERENCE, 3: COLOR}[volume.dim]
    seen = points(*product(EXTREME_POINTS, repeat=volume.dim))
    mapping = ORIENTATION if isinstance(volume, Arc) else mapping
    for number, witness in enumerate((0.0, 1e40, 1e300, math.nan, math.inf)):
        figure = Figure(figsize=(2, 2))
        own = figure.add_axes((0.2, 0.2, 0.6, 0.6))
        draw_volume(own, mapping, volume, seen, np.full(volume.dim, witness))
        save_figure(figure, tmp_path / f"{number}{suffix}")
    figure = Figure(figsize=(2, 2))
    draw_volume(figure.add_axes((0.2, 0.2, 0.6, 0.6)), mapping, volume)
    save_figure(figure, tmp_path / f"alone{suffix}")


def test_of_an_ellipse_without_end_the_inside_is_filled(axes: Axes) -> None:
    # All x between -1 and 1, as far as can be seen.
    strip = Ellipsoid(np.zeros(2), np.diag([1.0, 1e40]), 1.0, 5, 0.1)
    draw_volume(axes, DIFFERENCE, strip, points((-2, -2), (2, 2), (0, 1), (1, 0)))
    (image,) = axes.images
    filled = (np.asarray(image.get_array())[150] != 1.0).any(axis=1)
    x = np.linspace(*axes.get_xlim(), 300)

    assert list(axes.patches) == []
    np.testing.assert_array_equal(filled, np.abs(x) <= 1.0)
