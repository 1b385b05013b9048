from __future__ import annotations

from pathlib import Path

from browser import told_by
from playing.test_recorder import Convinced
from playing.toy_world import ToyWorld
from relforest.playing.page import page
from relforest.playing.recorder import record_episodes

ACTS = """
const find = (id) => document.getElementById(id);
const click = (id) => () => find(id).click();
const press = (key, shiftKey = false) => () =>
  document.body.dispatchEvent(new KeyboardEvent("keydown", {key, shiftKey, bubbles: true}));
const set = (id, value, event) => () => {
  find(id)[typeof value === "boolean" ? "checked" : "value"] = value;
  find(id).dispatchEvent(new Event(event, {bubbles: true}));
};
const seen = () => [
  find("clock").textContent, find("episode").value, find("speed").value, find("trails").checked,
  find("play").getAttribute("aria-label"), find("said").textContent,
];
const done = (acts) => acts.map((act) => { act(); return seen(); });
"""
MOUSE = """[
  click("forth"), click("forth"), click("back"), click("play"), click("play"), set("speed", "2", "change"),
  set("speed", "1", "change"), set("trails", false, "change"), set("trails", true, "change"),
  click("later"), set("scrub", find("scrub").max, "input"), set("scrub", "0", "input"), click("earlier"),
]"""
KEYS = """[
  press("ArrowRight", true), press("ArrowRight", true), press("ArrowLeft", true), press(" "), press(" "),
  press("+"), press("-"), press("t"), press("t"), press("n"), press("End"), press("Home"), press("p"),
]"""


def test_every_control_works_by_mouse_and_keyboard_alike(tmp_path: Path) -> None:
    text = page(record_episodes(ToyWorld(3), Convinced(), 2, explain=True), title="Discs", subtitle="of mine")
    start, by_mouse, by_keys = told_by(
        text, f"{ACTS} return [seen(), done({MOUSE}), done({KEYS})];", tmp_path
    )
    assert by_mouse == by_keys
    assert by_mouse[-1] == start
    clocks, episodes, speeds, trails, labels, said = zip(start, *by_mouse, strict=True)
    assert all("roll right" in each for each in said)
    assert clocks[1] < clocks[2] > clocks[3] == clocks[1]
    assert labels[3:6] == ("Play", "Pause", "Play")
    assert (set(episodes), set(speeds), set(trails)) == ({"0", "1"}, {"1", "2"}, {True, False})
    assert labels[11] == "Play again"
