from __future__ import annotations

import numpy as np
import pytest

from relforest.support.painting import Canvas, blend, paint_box, paint_ring, paint_stroke, paint_trail

RED = (255, 0, 0)


def blank() -> Canvas:
    return np.zeros((40, 60, 3), dtype=np.uint8)


def red(canvas: Canvas) -> float:
    """Return how many pixels are covered, parts of pixels included."""
    return float(canvas[:, :, 0].sum() / 255)


def test_a_stroke_without_length_is_a_disc() -> None:
    canvas = blank()
    paint_stroke(canvas, RED, (30.0, 20.0), (30.0, 20.0), 8.0)

    assert red(canvas) == pytest.approx(np.pi * 8.0**2, rel=0.01)
    assert canvas[20, 30].tolist() == [255, 0, 0]
    assert canvas[20, 39].tolist() == [0, 0, 0]


def test_a_stroke_covers_a_bar_with_round_ends() -> None:
    canvas = blank()
    paint_stroke(canvas, RED, (20.0, 10.0), (40.0, 25.0), 3.0)

    # 25 pixels long, 6 wide, and two half discs.
    assert red(canvas) == pytest.approx(25.0 * 6.0 + np.pi * 3.0**2, rel=0.01)


def test_a_ring_covers_a_band() -> None:
    canvas = blank()
    paint_ring(canvas, RED, (30.0, 20.0), 12.0, 1.5)

    assert red(canvas) == pytest.approx(2 * np.pi * 12.0 * 3.0, rel=0.01)
    assert canvas[20, 30].tolist() == [0, 0, 0]


@pytest.mark.parametrize("angle", [0.0, 0.3, -1.2, 2.5])
def test_a_box_covers_its_area_however_it_is_turned(angle: float) -> None:
    canvas = blank()
    paint_box(canvas, RED, (30.0, 20.0), (15.0, 4.0), angle)

    assert red(canvas) == pytest.approx(30.0 * 8.0, rel=0.02)
    assert canvas[20, 30].tolist() == [255, 0, 0]


def test_a_box_turns_from_columns_towards_rows() -> None:
    canvas = blank()
    paint_box(canvas, RED, (30.0, 20.0), (15.0, 2.0), np.pi / 6)

    # 12 pixels along the box: 10.4 columns to the right and 6 rows down.
    assert canvas[26, 40, 0] == 255
    assert canvas[14, 40, 0] == 0


def test_a_box_thinner_than_a_pixel_is_faint() -> None:
    canvas = blank()
    paint_box(canvas, RED, (30.0, 20.5), (10.0, 0.2), 0.0)

    assert canvas[20, 30, 0] == pytest.approx(0.4 * 255, abs=1.0)


def test_what_lies_outside_the_picture_is_left_out() -> None:
    canvas = blank()
    paint_stroke(canvas, RED, (-30.0, -20.0), (-25.0, -20.0), 3.0)
    paint_stroke(canvas, RED, (90.0, 20.0), (90.0, 70.0), 3.0)
    assert red(canvas) == 0.0

    paint_stroke(canvas, RED, (0.0, 0.0), (0.0, 0.0), 8.0)
    assert red(canvas) == pytest.approx(np.pi * 8.0**2 / 4, rel=0.02)


def test_trails_fade_towards_their_beginning() -> None:
    canvas = blank()
    paint_trail(canvas, RED, np.array([[10.0, 20.0], [30.0, 20.0], [50.0, 20.0]]), longest=100.0)
    strength = canvas[20, 12:48, 0].astype(int)

    # It is made of dots a few pixels apart.
    assert (np.diff(strength[::3]) > 0).all()
    assert strength[0] < 30
    assert strength[-1] > 150


def test_only_the_end_of_a_long_trail_is_drawn() -> None:
    canvas = blank()
    paint_trail(canvas, RED, np.array([[-1e9, 20.0], [50.0, 20.0]]), longest=20.0)

    assert canvas[:, :25].sum() == 0
    assert canvas[20, 45, 0] > 100


@pytest.mark.parametrize("path", [[[20.0, 20.0], [20.0, 20.0]], [[-50.0, 20.0], [-40.0, 20.0]]])
def test_trails_without_length_or_outside_leave_no_trace(path: list[list[float]]) -> None:
    canvas = blank()
    paint_trail(canvas, RED, np.array(path), longest=100.0)

    assert red(canvas) == 0.0


def test_colours_are_mixed_as_far_as_a_pixel_is_covered() -> None:
    canvas = np.full((1, 3, 3), 100, dtype=np.uint8)
    blend(canvas, (200, 0, 100), np.array([[0.0, 0.5, 1.0]]))

    assert canvas[0].tolist() == [[100, 100, 100], [150, 50, 100], [200, 0, 100]]
