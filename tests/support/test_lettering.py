from __future__ import annotations

import numpy as np
import pytest

from relforest.support.lettering import text_width, write
from relforest.support.painting import Canvas

RED = (255, 0, 0)


def blank() -> Canvas:
    return np.zeros((40, 120, 3), dtype=np.uint8)


def columns(canvas: Canvas) -> tuple[int, int]:
    """Return the first and the last column that something is written in."""
    found = np.nonzero(canvas.any(axis=(0, 2)))[0]
    return int(found[0]), int(found[-1])


def test_digits_have_their_middle_where_they_are_written() -> None:
    canvas = blank()
    write(canvas, "88", (60.0, 20.0), size=20, color=RED)
    rows = np.nonzero(canvas.any(axis=(1, 2)))[0]

    assert (rows[0] + rows[-1] + 1) / 2 == pytest.approx(20.0, abs=1.0)
    assert len(rows) == pytest.approx(0.73 * 20, abs=2.0)
    assert sum(columns(canvas)) / 2 == pytest.approx(60.0, abs=1.5)
    assert canvas[:, :, 0].max() == 255


@pytest.mark.parametrize(("side", "first", "last"), [(-1.0, 60, None), (1.0, None, 60)])
def test_lines_begin_or_end_at_a_point(side: float, first: int | None, last: int | None) -> None:
    canvas = blank()
    write(canvas, "400 m", (60.0, 20.0), size=12, color=RED, side=side)
    begin, end = columns(canvas)

    assert begin == pytest.approx(first if first is not None else 60 - text_width("400 m", 12), abs=2.0)
    assert end == pytest.approx(last if last is not None else 60 + text_width("400 m", 12), abs=2.0)


def test_wider_is_what_is_longer_larger_or_bolder() -> None:
    plain = text_width("moving", 12)

    assert 0 == text_width("", 12) < text_width("m", 12) < plain
    assert plain < text_width("moving", 15)
    assert plain < text_width("moving", 12, bold=True)


@pytest.mark.parametrize("at", [(0.0, 20.0), (119.0, 20.0), (60.0, 0.0), (60.0, 39.0)])
def test_what_sticks_out_of_the_picture_is_cut_off(at: tuple[float, float]) -> None:
    whole, canvas = np.zeros((120, 320, 3), dtype=np.uint8), blank()
    write(whole, "episode", (at[0] + 100, at[1] + 40), size=14, color=RED)
    write(canvas, "episode", at, size=14, color=RED)

    np.testing.assert_array_equal(canvas, whole[40:80, 100:220])
    assert canvas.any()


def test_nothing_is_written_for_an_empty_line() -> None:
    canvas = blank()
    write(canvas, "", (60.0, 20.0), size=12, color=RED)

    assert not canvas.any()
