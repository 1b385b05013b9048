from __future__ import annotations

import math
from html.parser import HTMLParser
from typing import final

import pytest

from relforest.playing.frames import Frame, Stage, Thing
from relforest.playing.shapes import Circle, Line, Polygon, Text
from relforest.playing.svg import svg
from relforest.support.errors import InputError

# Ten pixels a unit; y = 8 is the upper edge.
STAGE = Stage((-2.0, 8.0, 0.0, 8.0), pixels=100)


@final
class Elements(HTMLParser):
    """Collects elements with their attributes, and texts."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[dict[str, str]] = []
        self.texts: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append({"tag": tag, **{key: value or "" for key, value in attrs}})

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


def drawn(*things: Thing, notes: tuple[Line, ...] = ()) -> Elements:
    return Elements(svg(STAGE, Frame(0.0, things, notes), label="a < b"))


def test_shapes_are_where_their_thing_is() -> None:
    shapes = (
        Circle((1.0, 0.0), 0.5, "ink"),
        Polygon(((0.0, 0.0), (1.0, 0.0), (0.0, 2.0)), "#ff0000", "grey", 0.2),
        Text("a & b", (0.0, 1.0), 2.0, side=-1.0),
    )
    picture = drawn(Thing("7", shapes, 3.0, 4.0, math.pi / 2))
    root, group, circle, polygon, text = picture.found

    assert (root["aria-label"], group["data-key"], picture.texts) == ("a < b", "7", ["a & b"])
    # A quarter turn takes (1, 0) to (0, 1): at (3, 5), which is 50 from the left and 30 from above.
    assert [circle[key] for key in ("cx", "cy", "r")] == ["50.0", "30.0", "5.0"]
    assert polygon["points"] == "50.0,40.0 50.0,30.0 30.0,40.0"
    assert "fill:#ff0000;stroke:var(--grey);stroke-width:2.0px" in polygon["style"]
    assert (text["x"], text["text-anchor"]) == ("40.0", "start")


def test_the_head_of_an_arrow_is_no_longer_than_half_of_it() -> None:
    _, line, head = drawn(notes=(Line(((0.0, 1.0), (1.0, 1.0)), "ink", 1.0, arrow=True),)).found
    (x, y), (tip_x, tip_y), _ = (map(float, point.split(",")) for point in head["points"].split())

    assert line["points"] == "20.0,70.0 30.0,70.0"
    assert (tip_x, tip_y) == (30.0, 70.0)
    assert math.hypot(tip_x - x, tip_y - y) == pytest.approx(5.0, abs=0.1)


def test_unknown_colors_are_refused() -> None:
    with pytest.raises(InputError, match="'mauve' is no color"):
        drawn(Thing("1", (Circle((0.0, 0.0), 1.0, "mauve"),), 0.0, 0.0))
