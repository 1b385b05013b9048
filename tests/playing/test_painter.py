from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from playing.toy_world import STAGE, ToyWorld
from relforest.playing.frames import Frame, Stage, Thing
from relforest.playing.painter import paint, picture_shape
from relforest.playing.shapes import Circle, Line, Polygon, Text, box
from relforest.support.errors import InputError

PLAIN = Stage((-10.0, 10.0, 0.0, 10.0), pixels=200)
HEADER = 32


def painted(*things: Thing, stage: Stage = PLAIN) -> NDArray[np.int64]:
    return paint(stage, Frame(0.0, things)).astype(np.int64)


def places(picture: NDArray[np.int64], color: tuple[int, int, int]) -> NDArray[np.int64]:
    """Rows and columns of the pixels of a color."""
    return np.argwhere((picture == color).all(axis=2))


def test_pictures_have_the_form_that_gymnasium_wants() -> None:
    picture = paint(STAGE, ToyWorld().frame(1.5, 1.5))

    assert picture.shape == (*picture_shape(STAGE), 3) == (360 + HEADER, 720, 3)
    assert picture.dtype == np.uint8
    np.testing.assert_array_equal(picture, paint(STAGE, ToyWorld().frame(1.5, 1.5)))
    for other in ((1.4, 1.5), (1.5, 1.6)):
        assert (picture != paint(STAGE, ToyWorld().frame(*other))).any()


@pytest.mark.parametrize("view", [(0.0, 3.0, 0.0, 1.0), (0.0, 1.0, 0.0, 3.0), (0.0, 1000.0, 0.0, 0.1)])
def test_sides_are_even(view: tuple[float, float, float, float]) -> None:
    height, width = picture_shape(Stage(view, pixels=301))
    assert height % 2 == width % 2 == 0
    assert max(height - HEADER, width) == 300
    assert height > HEADER


def test_things_are_drawn_where_they_are_with_y_upwards() -> None:
    red = (Circle((0.0, 0.0), 1.0, "#ff0000"),)
    disc = places(painted(Thing("a", red, 5.0, 2.0)), (255, 0, 0))

    # 10 pixels for each unit; the lowest row is y = 0.
    assert disc.mean(axis=0) + 0.5 == pytest.approx([HEADER + 80, 150], abs=0.5)
    assert len(disc) == pytest.approx(np.pi * 100, rel=0.15)


def test_things_turn_counter_clockwise() -> None:
    red = (Polygon(box(0.0, 4.0, -0.5, 0.5), "#ff0000"),)
    level, up = (places(painted(Thing("a", red, 0.0, 5.0, turn)), (255, 0, 0)) for turn in (0.0, np.pi / 2))

    assert level.mean(axis=0) + 0.5 == pytest.approx([HEADER + 50, 120], abs=0.6)
    assert up.mean(axis=0) + 0.5 == pytest.approx([HEADER + 30, 100], abs=0.6)


def test_what_comes_later_hides_what_came_before() -> None:
    red, blue = ((Circle((0.0, 0.0), 1.0, color),) for color in ("#ff0000", "#0000ff"))
    picture = painted(Thing("a", red, 0.0, 5.0), Thing("b", blue, 0.0, 5.0))

    assert len(places(picture, (255, 0, 0))) == 0
    assert len(places(picture, (0, 0, 255))) > 0


def test_colors_may_be_transparent() -> None:
    paper, red = (Polygon(box(-10.0, 10.0, 0.0, 10.0), color) for color in ("#ffffff", "#ff000080"))
    picture = painted(Thing("a", (paper, red), 0.0, 0.0))

    assert picture[HEADER + 50, 100] == pytest.approx([255, 127, 127], abs=2)


def test_dashed_lines_have_gaps_and_arrows_have_heads() -> None:
    whole, dashed, arrow = (
        len(places(painted(Thing("a", (line,), 0.0, 5.0)), (255, 0, 0)))
        for line in (
            Line(((-5.0, 0.0), (5.0, 0.0)), "#ff0000", 0.4),
            Line(((-5.0, 0.0), (5.0, 0.0)), "#ff0000", 0.4, dashed=True),
            Line(((-5.0, 0.0), (5.0, 0.0)), "#ff0000", 0.4, arrow=True),
        )
    )
    assert 0.3 * whole < dashed < 0.7 * whole
    assert whole + 50 < arrow


def test_texts_stay_upright_and_readable() -> None:
    def text(angle: float, size: float) -> NDArray[np.int64]:
        shapes = (Text("III", (0.0, 0.0), size, "#ff0000", bold=True),)
        return np.argwhere(painted(Thing("a", shapes, 0.0, 5.0, angle))[HEADER:, :, 2] < 150)

    np.testing.assert_array_equal(text(0.0, 1.0), text(2.0, 1.0))
    np.testing.assert_array_equal(text(0.0, 0.001), text(0.0, 0.9))
    assert np.ptp(text(0.0, 3.0)[:, 0]) > 2 * np.ptp(text(0.0, 1.0)[:, 0])


def test_texts_begin_or_end_at_their_place() -> None:
    left, middle, right = (
        np.argwhere(painted(Thing("a", (Text("MM", (0.0, 0.0), 1.5, side=side),), 0.0, 5.0))[40:, :, 0] < 150)
        for side in (1.0, 0.0, -1.0)
    )
    assert left[:, 1].max() <= 100 <= right[:, 1].min()
    assert middle[:, 1].min() < 100 < middle[:, 1].max()


def test_the_header_tells_caption_score_and_time() -> None:
    def header(frame: Frame) -> int:
        return int((paint(PLAIN, frame)[:HEADER] < 150).sum())

    plain = header(Frame(1.0, ()))
    assert 0 < plain < header(Frame(1.0, (), score=-2.0))
    assert plain < header(Frame(1.0, (), caption="falls"))
    # Nothing reaches into it.
    tall = Thing("a", (Polygon(box(-10.0, 10.0, 0.0, 90.0), "#000000"),), 0.0, 0.0)
    assert header(Frame(1.0, (tall,))) == plain


def test_the_picture_zooms_out_but_the_ground_stays() -> None:
    stage = replace(PLAIN, widest=(-20.0, 20.0, 0.0, 20.0), room=1.0)
    red = (Circle((0.0, 0.0), 1.0, "#ff0000"),)
    near, far = (places(painted(Thing("a", red, x, 1.0), stage=stage), (255, 0, 0)) for x in (0.0, 18.0))

    assert len(far) < 0.7 * len(near)
    assert near[:, 0].max() == pytest.approx(HEADER + 99, abs=1)
    assert far[:, 0].max() == pytest.approx(HEADER + 99, abs=1)
    assert far[:, 1].max() < 200


def test_unknown_colors_are_refused() -> None:
    with pytest.raises(InputError, match="'red' is no color"):
        painted(Thing("a", (Circle((0.0, 0.0), 1.0, "red"),), 0.0, 0.0))
