from __future__ import annotations

from typing import Any

import pytest

from playing.toy_world import STAGE, ToyWorld
from relforest.playing.frames import Shown, Stage, Thing
from relforest.playing.shapes import Chip, plain
from relforest.support.errors import InputError


def test_a_users_world_can_be_shown() -> None:
    assert isinstance(ToyWorld(), Shown)
    assert not isinstance(object(), Shown)


def test_words_can_be_read_without_colors() -> None:
    assert plain(("put ", Chip("3", "#ff0000"), " on ", Chip("1", "ink"))) == "put 3 on 1"


def test_colors_are_roles_or_numbers() -> None:
    assert [STAGE.shade(color) for color in ("disc", "ink", "#a0b1c2", "#a0b1c280")] == [
        "#0000ff",
        "#262626",
        "#a0b1c2",
        "#a0b1c280",
    ]
    for color in ("red", "", "#fff", "#GGGGGG", "ink;"):
        with pytest.raises(InputError, match=r"is no color: write '#rrggbb', or one of paper, .*, disc"):
            STAGE.shade(color)


@pytest.mark.parametrize(
    "change",
    [
        {"view": (1.0, 1.0, 0.0, 2.0)},
        {"view": (0.0, 1.0, 2.0, 0.0)},
        {"widest": (0.0, float("nan"), 0.0, 1.0)},
        {"colors": {"a b": ("#000000", "#000000")}},
        {"colors": {"red": ("red", "#000000")}},
    ],
)
def test_stages_are_checked(change: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=r"a view is left < right|a color is a word and two shades"):
        Stage(**{"view": (0.0, 1.0, 0.0, 1.0), **change})


def test_the_view_grows_with_the_things_as_far_as_it_may() -> None:
    near, far = (Thing("a", (), 3.0, 1.0),), (Thing("a", (), 3.0, 1.0), Thing("b", (), -70.0, 30.0))
    fixed, free = (
        Stage((-5.0, 5.0, 0.0, 4.0), widest=widest, room=1.0) for widest in (None, (-50, 50, 0, 20))
    )

    assert fixed.framed(far) == free.framed(near) == free.view
    assert free.framed(far) == (-50, 5.0, 0.0, 20)
