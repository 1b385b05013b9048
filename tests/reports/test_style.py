from __future__ import annotations

import matplotlib as mpl

from relforest.reports.style import MARKERS, NEGATIVE, POSITIVE, SERIES, mixed, probability_color, styled


def test_the_style_holds_only_inside_its_context() -> None:
    before = dict(mpl.rcParams)
    with styled():
        assert mpl.rcParams["svg.hashsalt"] == "relforest"

    assert dict(mpl.rcParams) == before


def test_mixing_goes_from_one_color_to_the_other() -> None:
    assert mixed("#000000", 0.0) == (1.0, 1.0, 1.0)
    assert mixed("#000000", 1.0) == (0.0, 0.0, 0.0)
    # A quarter of red in white: 1, 0.75, 0.75.
    assert mixed("#FF0000", 0.25) == (1.0, 0.75, 0.75)


def test_leaves_are_colored_by_probability() -> None:
    assert probability_color(0.5) == (1.0, 1.0, 1.0)
    assert probability_color(1.0) == mixed(POSITIVE, 0.65)
    assert probability_color(0.0) == mixed(NEGATIVE, 0.65)


def test_neighbouring_series_differ_in_color_and_mark() -> None:
    assert len(set(SERIES)) == len(SERIES)
    assert len(set(MARKERS)) == len(MARKERS) == len(SERIES)
