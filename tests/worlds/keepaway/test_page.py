from __future__ import annotations

import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from typing import Any, final

import numpy as np
import pytest

from relforest.support.errors import InputError
from relforest.worlds.keepaway.layout import CAPPED, TAKEN
from relforest.worlds.keepaway.page import page
from worlds.keepaway.recorded_games import recording


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


def data_of(text: str) -> dict[str, Any]:
    """Return what a browser would read as the data of a page."""
    found: dict[str, Any] = json.loads(Elements(text).scripts[0])
    return found


def test_the_data_are_the_recording() -> None:
    game = recording(cycles=30)
    data = data_of(page([game], title="A game", subtitle="of two"))
    (episode,) = data["episodes"]
    players = np.array(episode["players"]).reshape(31, 5, 3)

    assert (data["keepers"], data["takers"], data["field"]) == (3, 2, [20.0, 20.0])
    assert (data["title"], data["subtitle"], episode["end"]) == ("A game", "of two", game.end)
    np.testing.assert_allclose(players[:, :, :2] / 100, game.players[:, :, :2], atol=0.0051)
    np.testing.assert_allclose(players[:, :, 2], game.players[:, :, 4], atol=0.51)
    np.testing.assert_allclose(np.array(episode["ball"]).reshape(31, 2) / 100, game.ball[:, :2], atol=0.0051)
    assert episode["commands"] == game.commands.ravel().tolist()
    decisions = episode["decisions"]
    assert decisions["time"] == game.decisions.times.tolist()
    assert decisions["actor"] == game.decisions.actors.tolist()
    assert decisions["action"] == game.decisions.actions.tolist()
    assert decisions["order"] == game.decisions.orders.ravel().tolist()
    np.testing.assert_allclose(decisions["values"], game.decisions.values.ravel(), rtol=1e-4)


def test_unknown_values_are_left_out() -> None:
    game = recording(cycles=30)
    values = game.decisions.values.copy()
    values[0, 1] = np.nan
    some = replace(game, decisions=replace(game.decisions, values=values))

    assert data_of(page([some]))["episodes"][0]["decisions"]["values"][1] is None
    assert data_of(page([recording(values=False)]))["episodes"][0]["decisions"]["values"] is None


def test_several_episodes_keep_their_order_and_ends() -> None:
    games = [recording(cycles=12, end=TAKEN), recording(cycles=30, end=CAPPED, seed=1)]
    episodes = data_of(page(games))["episodes"]

    assert [len(episode["ball"]) // 2 - 1 for episode in episodes] == [12, 30]
    assert [episode["end"] for episode in episodes] == [TAKEN, CAPPED]


def test_an_episode_without_decisions_can_be_shown() -> None:
    episode = data_of(page([recording(cycles=3)]))["episodes"][0]

    assert episode["decisions"]["time"] == []


def test_the_page_needs_nothing_from_elsewhere() -> None:
    text = page([recording()])
    elements = Elements(text)

    assert re.findall(r"(?:https?:)?//[a-z]", re.sub(r"^\s*//.*$", "", text, flags=re.MULTILINE)) == []
    assert [tag for tag, attrs in elements.tags if {"src", "href"} & attrs.keys()] == []
    assert not {"link", "img", "iframe", "object"} & {tag for tag, _ in elements.tags}
    policies = [attrs["content"] for _, attrs in elements.tags if "http-equiv" in attrs]
    assert policies == ["default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'"]


def test_every_control_has_a_name() -> None:
    elements = Elements(page([recording()]))
    controls = [attrs for tag, attrs in elements.tags if tag in {"button", "canvas"}]

    assert all("aria-label" in attrs or attrs.get("aria-hidden") == "true" for attrs in controls)


def test_every_element_that_the_program_looks_for_is_there() -> None:
    text = page([recording()])
    elements = Elements(text)
    wanted = set(re.findall(r"""(?:find|getElementById)\("([a-z]+)"\)""", elements.scripts[1]))

    assert len(wanted) > 15
    assert wanted <= {attrs.get("id") for _, attrs in elements.tags}


@pytest.mark.parametrize(
    "hostile",
    ["</script><script>alert(1)</script>", "<!--<script>", "@@data@@ @@script@@", "\u2028\u2029&amp;\"'\\"],
)
def test_titles_can_do_no_harm(hostile: str) -> None:
    plain, text = page([recording()], title="plain"), page([recording()], title=hostile, subtitle=hostile)

    assert (data_of(text)["title"], data_of(text)["subtitle"]) == (hostile, hostile)
    assert [tag for tag, _ in Elements(text).tags] == [tag for tag, _ in Elements(plain).tags]
    assert Elements(text).scripts[1] == Elements(plain).scripts[1]


def test_pages_of_different_games_are_refused() -> None:
    with pytest.raises(InputError, match="at least one recorded episode"):
        page([])
    with pytest.raises(InputError, match="the same field and the same numbers of players"):
        page([recording(), recording(field=(25.0, 20.0))])
    with pytest.raises(InputError, match="the same field and the same numbers of players"):
        page([recording(), recording(takers=3)])


def test_states_that_are_not_finite_are_refused() -> None:
    game = recording()
    ball = game.ball.copy()
    ball[3, 0] = np.nan

    with pytest.raises(InputError, match="states that are not finite"):
        page([replace(game, ball=ball)])


def test_an_installation_without_the_page_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pkgutil.get_data", lambda *_: None)

    with pytest.raises(InputError, match=r"episode_player.css is missing from .*: reinstall relforest"):
        page([recording()])
