from __future__ import annotations

import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from typing import Any, final

import numpy as np
import pytest

from playing.test_recorder import Convinced
from playing.toy_world import DISC, STAGE, ToyWorld
from relforest.playing.frames import Frame, Stage, Thing
from relforest.playing.page import page
from relforest.playing.recorder import Choice, Recording, record_episodes
from relforest.playing.shapes import Circle
from relforest.smdp import Decision
from relforest.support.errors import InputError


@final
class Elements(HTMLParser):
    """Collects elements, and the text within each script."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.scripts: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag == "script":
            self.scripts.append("")

    def handle_data(self, data: str) -> None:
        if self.lasttag == "script":
            self.scripts[-1] += data


@final
class Right:
    def choose(self, decision: Decision, rng: np.random.Generator) -> int:  # noqa: ARG002
        return 1


def recorded(length: int = 3) -> Recording:
    return record_episodes(ToyWorld(length), Right())[0]


def data_of(text: str) -> dict[str, Any]:
    """Return what a browser would read as the data of a page."""
    found: dict[str, Any] = json.loads(Elements(text).scripts[0])
    return found


def poses(game: dict[str, Any], track: dict[str, Any]) -> np.ndarray[Any, Any]:
    moves = np.cumsum(np.array(track["moves"]).reshape(-1, 3), axis=0)
    poses: np.ndarray[Any, Any] = moves * (game["grain"], game["grain"], game["turn"])
    return poses


def test_the_data_are_the_recording() -> None:
    game = data_of(page([recorded()], title="Discs", subtitle="of mine"))
    (episode,) = game["episodes"]
    (track,) = episode["tracks"]
    shapes = game["looks"][track["looks"][0][1]]

    assert (game["title"], game["subtitle"], game["score"], game["legend"]) == (
        "Discs",
        "of mine",
        "place",
        "A disc.",
    )
    assert (episode["ticks"], episode["reward"], episode["end"]) == (7, 3.0, "over")
    xs = np.linspace(0.0, 3.0, 7)
    np.testing.assert_allclose(poses(game, track), np.stack([xs, 0 * xs, 3 * xs], axis=1), atol=0.001)
    assert (track["looks"], track["trail"]) == ([[0, track["looks"][0][1]]], "disc")
    assert shapes[0] == {
        "type": "circle",
        "centre": [0.0, 0.0],
        "radius": 0.5,
        "fill": "disc",
        "edge": "ink",
        "width": 0.1,
    }
    assert episode["captions"][:2] == [[0, "at 0"], [1, "at 0.5"]]
    assert episode["scores"][-1] == [6, 3.0]
    assert episode["bands"] == [[0, ""], [1, "disc"]]
    assert [tick for tick, _ in episode["notes"]] == [0, 3, 4, 5, 6]
    assert [[game["words"][line] for line in lines] for _, lines in episode["details"][:2]] == [
        [["x 0.0"]],
        [["x 0.5"]],
    ]


def test_choices_are_told_in_words_and_values() -> None:
    known, unknown = ((1.0, np.nan), (np.nan, np.nan))
    first, second = (
        Choice(0.0, 1.0, ("a",), 2.0, (("a",), ("b",)), 0, values) for values in (known, unknown)
    )
    game = data_of(page([replace(recorded(), choices=(first, second))]))
    one, other = game["episodes"][0]["choices"]

    assert (one["from"], one["until"], one["lasts"], one["reward"]) == (0, 2, 1.0, 2.0)
    assert (game["words"][one["words"]], one["chosen"], one["values"]) == (["a"], 0, [1.0, None])
    assert other["values"] is None


def test_reasons_mark_the_things_they_are_about() -> None:
    (recording,) = record_episodes(ToyWorld(1), Convinced(), explain=True)
    game = data_of(page([replace(recording, before=2.0)]))
    (episode,) = game["episodes"]
    why = episode["choices"][0]["why"]

    assert (episode["before"], episode["reward"]) == (2.0, 3.0)
    assert (game["words"][why["rival"]], why["lead"], why["rest"]) == (
        ["roll ", ["left", "disc"]],
        1.75,
        [3, 0.25],
    )
    assert [(reason["adds"], reason["marks"]) for reason in why["reasons"]] == [(2.0, [0]), (-0.5, [0])]
    assert game["words"][why["reasons"][0]["says"]] == ["C is right"]
    assert ["d", "disc"] in game["words"][why["reasons"][0]["stands"]]
    assert "why" not in data_of(page([recorded()]))["episodes"][0]["choices"][0]


def test_frames_at_any_times_become_ticks() -> None:
    frames = tuple(Frame(time, (Thing("a", DISC, time, 0.0, 3.0 * time),)) for time in (7.0, 7.2, 8.0, 8.6))
    game = data_of(page([Recording(STAGE, frames, ())]))
    (track,) = game["episodes"][0]["tracks"]

    np.testing.assert_allclose(poses(game, track)[:, 0], [7.0, 7.5, 8.0, 8.5], atol=0.001)
    # Angles go the short way.
    np.testing.assert_allclose(
        np.exp(1j * poses(game, track)[:3, 2]), np.exp(3j * np.array([7.0, 7.5, 8.0])), atol=0.01
    )


def test_a_decision_is_shown_at_its_very_moment() -> None:
    frames = tuple(Frame(time, (), caption=str(time)) for time in (0.0, 0.45, 0.6, 0.97, 1.0))
    choice = Choice(0.6, 0.97, ("a",), 0.0, (("a",),), 0, None)
    (episode,) = data_of(page([Recording(STAGE, frames, (choice,))]))["episodes"]

    assert episode["captions"] == [[0, "0.0"], [1, "0.6"], [2, "0.97"]]


def test_things_come_and_go_and_change() -> None:
    other = (DISC[0],)
    shown = [None, DISC, DISC, None, other]
    frames = tuple(
        Frame(time / 2, () if shapes is None else (Thing("a", shapes, float(time), 0.0),))
        for time, shapes in enumerate(shown)
    )
    game = data_of(page([Recording(STAGE, frames, ())]))
    (track,) = game["episodes"][0]["tracks"]
    looks = dict(track["looks"])

    assert [tick for tick, _ in track["looks"]] == [0, 1, 3, 4]
    assert looks[0] == looks[3] == -1
    assert looks[1] != looks[4]
    np.testing.assert_allclose(poses(game, track)[[1, 2, 4], 0], [1.0, 2.0, 4.0], atol=0.001)


def test_the_page_needs_nothing_from_elsewhere() -> None:
    text = page([recorded()])
    elements = Elements(text)

    assert re.findall(r"(?:https?:)?//[a-z]", re.sub(r"^\s*//.*$", "", text, flags=re.MULTILINE)) == []
    assert [tag for tag, attrs in elements.tags if {"src", "href"} & attrs.keys()] == []
    assert not {"link", "img", "iframe", "object"} & {tag for tag, _ in elements.tags}
    policies = [attrs["content"] for _, attrs in elements.tags if "http-equiv" in attrs]
    assert policies == ["default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'"]


def test_every_control_has_a_name() -> None:
    controls = [attrs for tag, attrs in Elements(page([recorded()])).tags if tag in {"button", "canvas"}]
    assert all("aria-label" in attrs or attrs.get("aria-hidden") == "true" for attrs in controls)


def test_every_element_that_the_program_looks_for_is_there() -> None:
    elements = Elements(page([recorded()]))
    wanted = set(re.findall(r"""(?:find|getElementById)\("([a-z]+)""", elements.scripts[1]))

    assert len(wanted) > 20
    assert wanted <= {attrs.get("id") for _, attrs in elements.tags}


def test_all_colors_have_a_light_and_a_dark_shade() -> None:
    text = page([recorded()])

    assert data_of(text)["roles"] == list(STAGE.shades)
    assert set(re.findall(r"\bcolors\.(\w+)", text)) <= set(STAGE.shades)
    for role, (light, dark) in STAGE.shades.items():
        assert text.index(f"--{role}: {light};") < text.index(f"--{role}: {dark};", text.index("@media"))


@pytest.mark.parametrize("hostile", ["</script><script>alert(1)</script>", "@@data@@ @@script@@", "a\u2028b"])
def test_titles_can_do_no_harm(hostile: str) -> None:
    plain, text = page([recorded()], title="plain"), page([recorded()], title=hostile, subtitle=hostile)

    assert (data_of(text)["title"], data_of(text)["subtitle"]) == (hostile, hostile)
    assert [tag for tag, _ in Elements(text).tags] == [tag for tag, _ in Elements(plain).tags]
    assert Elements(text).scripts[1] == Elements(plain).scripts[1]


def test_what_cannot_be_shown_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="at least one recorded episode"):
        page([])
    with pytest.raises(InputError, match="on the same stage"):
        page([recorded(), replace(recorded(), stage=Stage((0.0, 1.0, 0.0, 1.0)))])
    far = Frame(9.0, (Thing("disc", DISC, np.inf, 0.0),))
    wrong = Frame(9.0, (), score=np.nan)
    red = Frame(9.0, (Thing("disc", (Circle((0.0, 0.0), 1.0, "red"),), 0.0, 0.0),))
    for frame, message in ((far, "not finite"), (wrong, "not finite"), (red, "'red' is no color")):
        with pytest.raises(InputError, match=message):
            page([replace(recorded(), frames=(*recorded().frames, frame))])
    monkeypatch.setattr("pkgutil.get_data", lambda *_: None)
    with pytest.raises(InputError, match=r"is missing from relforest\.playing: reinstall relforest"):
        page([recorded()])
