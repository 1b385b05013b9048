from __future__ import annotations

import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from typing import Any, final

import numpy as np
import pytest

from relforest.support.errors import InputError
from relforest.worlds.blocks.page import SCORE_NAMES, page
from worlds.blocks.recorded_episodes import recording


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
    game = recording()
    data = data_of(page([game], title="Towers", subtitle="of four"))
    (episode,) = data["episodes"]
    poses = np.cumsum(np.array(episode["moves"]).reshape(-1, 12), axis=0).reshape(-1, 4, 3)

    assert (data["title"], data["subtitle"], data["task"]) == ("Towers", "of four", "high-towers")
    assert (data["score"], data["rate"]) == ("mean height", 25)
    assert (episode["ids"], episode["ticks"]) == ([10, 11, 12, 13], len(game.times))
    np.testing.assert_allclose(poses / [100, 100, 1000], game.poses, atol=0.0051)
    np.testing.assert_allclose(episode["sides"], game.half_extents, atol=1e-4)
    assert episode["gone"] == [None] * 4
    assert episode["first"] == pytest.approx(game.first_score, abs=1e-4)
    assert episode["total"] == pytest.approx(game.total_reward, abs=1e-4)
    assert [(option["from"], option["until"]) for option in episode["options"]] == [(50, 250), (250, 450)]
    assert [option["blocks"] for option in episode["options"]] == [[11, 10], [12, 10]]
    for option, made in zip(episode["options"], game.options, strict=True):
        assert option["reward"] == pytest.approx(made.reward, abs=1e-4)
        assert option["score"] == pytest.approx(made.score, abs=1e-4)
        assert (option["name"], option["target"], option["duration"]) == ("put", None, 8.0)
    assert episode["marks"][2] == [[-12.0, -4.0, 0.0, 0.0, 1.25]]


def test_what_was_held_is_known_at_every_moment() -> None:
    game = recording()
    changes = data_of(page([game]))["episodes"][0]["held"]
    ticks = [tick for tick, _ in changes]
    held = np.repeat([block for _, block in changes], np.diff([*ticks, len(game.times)]))

    assert held.tolist() == game.held.tolist()
    assert len(changes) == 5


def test_colours_are_written_as_browsers_read_them() -> None:
    game = recording(blocks=2, options=0)
    shown = replace(game, colors=np.array([[0.0, 0.5, 1.0], [1.2, -0.1, 1 / 255]]))

    assert data_of(page([shown]))["episodes"][0]["colors"] == ["#0080ff", "#ff0001"]


def test_frames_at_any_times_become_pictures_at_equal_ones() -> None:
    game = recording(options=0)
    kept = np.array([0, 3, 4, 10, 50])
    sparse = replace(game, times=game.times[kept] + 7.0, poses=game.poses[kept], held=game.held[kept])
    (episode,) = data_of(page([sparse]))["episodes"]
    poses = np.cumsum(np.array(episode["moves"]).reshape(-1, 12), axis=0).reshape(-1, 4, 3)

    assert episode["ticks"] == 51
    np.testing.assert_allclose(poses[kept] / [100, 100, 1000], game.poses[kept], atol=0.0051)
    # Half way between two of them.
    halfway = (game.poses[4] + game.poses[10]) / 2
    np.testing.assert_allclose(poses[7] / [100, 100, 1000], halfway, atol=0.0051)


def test_a_block_that_fell_from_the_table_is_gone_for_good() -> None:
    game = recording(lost=True)
    (episode,) = data_of(page([game]))["episodes"]
    moves = np.array(episode["moves"]).reshape(-1, 4, 3)

    assert episode["gone"] == [None, None, None, 125]
    assert not moves[125:, 3].any()

    poses = game.poses.copy()
    poses[140:, 3] = 0.0
    with pytest.raises(InputError, match="none after it has fallen off the table"):
        page([replace(game, poses=poses)])
    poses[:, 3] = np.nan
    with pytest.raises(InputError, match="must have a pose at the beginning"):
        page([replace(game, poses=poses)])


@pytest.mark.parametrize("task", list(SCORE_NAMES))
def test_every_task_can_be_shown(task: str) -> None:
    data = data_of(page([recording(task=task), recording(task=task, options=0, blocks=1)]))

    assert data["score"] == SCORE_NAMES[task]
    assert [len(episode["options"]) for episode in data["episodes"]] == [2, 0]


def test_targets_are_kept() -> None:
    game = recording(task="arch")
    options = data_of(page([game]))["episodes"][0]["options"]

    assert [option["target"] for option in options] == [option.target for option in game.options]


def test_an_episode_in_which_every_block_is_lost_or_none_was_there_can_be_shown() -> None:
    game = recording(blocks=1, options=0)
    empty = replace(
        game,
        ids=game.ids[:0],
        half_extents=game.half_extents[:0],
        colors=game.colors[:0],
        poses=game.poses[:, :0],
    )

    assert data_of(page([empty]))["episodes"][0]["moves"] == []


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
    elements = Elements(page([recording()]))
    wanted = set(re.findall(r"""(?:find|drawSmall|getElementById)\("([a-z]+)""", elements.scripts[1]))

    assert len(wanted) > 15
    assert wanted <= {attrs.get("id") for _, attrs in elements.tags}


def test_colours_of_the_program_are_colours_of_the_style() -> None:
    text = page([recording()])
    (listed,) = re.findall(r"colors: \[(.*?)\]", text)

    assert set(re.findall(r"\bcolors\.(\w+)", text)) - {"map"} <= set(re.findall(r'"(\w+)"', listed))
    for name in re.findall(r'"(\w+)"', listed):
        assert f"--{name}:" in text


@pytest.mark.parametrize("hostile", ["</script><script>alert(1)</script>", "@@data@@ @@script@@"])
def test_titles_can_do_no_harm(hostile: str) -> None:
    plain, text = page([recording()], title="plain"), page([recording()], title=hostile, subtitle=hostile)

    assert (data_of(text)["title"], data_of(text)["subtitle"]) == (hostile, hostile)
    assert [tag for tag, _ in Elements(text).tags] == [tag for tag, _ in Elements(plain).tags]
    assert Elements(text).scripts[1] == Elements(plain).scripts[1]


def test_pages_of_nothing_or_of_different_tasks_are_refused() -> None:
    with pytest.raises(InputError, match="at least one recorded episode"):
        page([])
    with pytest.raises(InputError, match="of the same task"):
        page([recording(), recording(task="arch")])
    with pytest.raises(InputError, match="one of high-towers, color-grouping, arch, got 'chess'"):
        page([recording(task="chess")])


def test_numbers_that_are_not_finite_are_refused() -> None:
    game = recording()
    poses, colors = game.poses.copy(), game.colors.copy()
    poses[3, 1, 0], colors[2, 1] = np.inf, np.nan
    first, *rest = game.options
    changes: list[dict[str, Any]] = [
        {"poses": poses},
        {"colors": colors},
        {"first_score": np.nan},
        {"options": (replace(first, reward=np.nan), *rest)},
    ]

    for change in changes:
        with pytest.raises(InputError, match="not finite"):
            page([replace(game, **change)])
