from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.reports.text_size import drawable, line_height, shortened, text_width, wrapped

TEXTS = st.text("abcdefgh (),.-$", max_size=60)


def test_longer_and_larger_text_is_wider() -> None:
    assert text_width("a question", 8) > text_width("a", 8) > 0
    # Width grows with the size of the type, up to hinting.
    assert text_width("question", 16) == pytest.approx(2 * text_width("question", 8), rel=0.05)
    assert text_width("question", 8, "bold") > text_width("question", 8)


def test_lines_are_a_quarter_further_apart_than_the_type_is_high() -> None:
    # 1.25 * 72 points = 90 points = 1.25 inches
    assert line_height(72.0) == pytest.approx(1.25)


@given(TEXTS, st.floats(0.3, 3.0))
def test_wrapped_lines_fit_and_keep_every_word(text: str, width: float) -> None:
    lines = wrapped(text, width, 8.0)

    assert all(text_width(line, 8.0) <= width for line in lines)
    assert "".join("".join(lines).split()) == "".join(text.split())


def test_words_wider_than_a_line_are_broken() -> None:
    lines = wrapped("a " + "w" * 40, 1.0, 8.0)

    assert lines[0] == "a"
    assert len(lines) > 2


@given(TEXTS, st.floats(0.3, 3.0))
def test_shortened_text_fits(text: str, width: float) -> None:
    short = shortened(text, width, 8.0)

    assert text_width(short, 8.0) <= width
    assert short == text or short.endswith("…")


def test_only_what_the_font_has_is_drawn() -> None:
    mark = "\N{REPLACEMENT CHARACTER}"

    assert drawable("a\x00b\x1b\n\t\ud800 \N{CJK UNIFIED IDEOGRAPH-4E2D}é…") == (
        f"a{mark}b{mark * 4} {mark}é…"
    )
    assert shortened("\x00", 1.0, 8.0) == mark
    assert wrapped("a\nb \x00", 1.0, 8.0) == [f"a b {mark}"]


def test_very_long_text_is_cut() -> None:
    assert shortened("letters " * 100_000, 2.0, 8.0).endswith("…")
    lines = wrapped("w" * 100_000, 2.0, 8.0)

    assert lines[-1].endswith("…")
    assert len(lines) < 100
