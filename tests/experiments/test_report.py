from __future__ import annotations

import re
from dataclasses import asdict
from html.parser import HTMLParser
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from browser import told_by
from experiments.run_folders import SMALL, TWO_RUNS
from relforest.experiments.claims import Claim
from relforest.experiments.learning.settings import SETTINGS
from relforest.experiments.report.folders import section_of
from relforest.experiments.report.page import report_page
from relforest.experiments.report.section import Picture, Player, Section
from relforest.experiments.runner import saved_rows
from relforest.experiments.runs import learn_runs
from relforest.experiments.sheets import Passage, Sheet
from relforest.support.errors import InputError, ModelFormatError, RunFolderError
from relforest.support.files import write_json


class Elements(HTMLParser):
    """Checks that elements are closed in order, and keeps texts and attributes."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.texts: list[str] = []
        self.attributes: list[tuple[str, str | None]] = []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.attributes += attrs
        if tag != "meta":
            self.open.append(tag)

    def handle_startendtag(self, _tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.attributes += attrs

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


def write_study(folder: Path, done: int) -> None:
    """Write the study of colors with a hand-made policy that did so well in its first runs."""
    settings = [asdict(setting) for setting in SETTINGS["color-grouping"]]
    content = {"study": "color-learning", "seed": 3, "smoke": False, "settings": settings}
    write_json(folder / "study.json", {"format": "relforest-study", "version": 1, **content})
    for number in range(done):
        row = {"task": "color-grouping", "condition": "manual", "run": number, "played": "color-grouping"}
        row |= {"episodes": 0, "reward": 0.5 + number, "train": None, "leaves": None, "paid": 0.9}
        rows = [row]
        document = {"format": "relforest-study-rows", "version": 1, "setting": settings[number], "rows": rows}
        write_json(folder / "settings" / f"{number:04d}.json", document)


def test_an_unfinished_study_says_what_it_leaves_out(tmp_path: Path) -> None:
    write_study(tmp_path, done=3)
    section = section_of(tmp_path)
    assert section.heading == "color-learning"
    assert section.lead[1].startswith("Seed 3, 3 of 60 settings. The others have not been computed")
    said, sheet = (part for part in section.parts if isinstance(part, Sheet))
    assert {row[-1] for row in said.rows} == {"not run"}
    assert sheet.rows[0][:4] == ("manual", 0, 3, 1.5)
    assert [claim.verdict for claim in section.claims] == ["not claimed"]


def test_the_rows_of_a_study_are_reported_like_its_folder(tmp_path: Path) -> None:
    write_study(tmp_path, done=3)
    (tmp_path / "rows.csv").write_text(saved_rows(tmp_path).table.to_csv(), "utf-8")
    of_folder, of_rows = section_of(tmp_path), section_of(tmp_path / "rows.csv")
    assert of_rows.lead[1] == "Seed 3, 3 of 3 settings."
    assert (of_rows.heading, of_rows.claims) == (of_folder.heading, of_folder.claims)
    sheets, others = (
        [part for part in section.parts if isinstance(part, Sheet)] for section in (of_folder, of_rows)
    )
    assert sheets == others


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "does not hold the rows of a study: not a table"),
        ("name,reward\na,1\n", "does not hold the rows of a study: .* column 'id'"),
        ("id,reward\n7,1\n", "does not hold the rows of a study"),
        ("id,reward\na/0/0,1\nb/0/0,1\n", "does not hold the rows of a study"),
        ("id,reward\ncolor-learning/0/0,1\n", "damaged"),
    ],
)
def test_other_tables_are_refused(tmp_path: Path, text: str, complaint: str) -> None:
    (tmp_path / "rows.csv").write_text(text, "utf-8")
    with pytest.raises((InputError, ModelFormatError), match=complaint):
        section_of(tmp_path / "rows.csv")


def test_runs_are_told_drawn_and_played(tmp_path: Path) -> None:
    learn_runs(TWO_RUNS, tmp_path)
    section = section_of(tmp_path, episodes=1)
    assert section.lead == ("SMRF-RPI learns corridor; iterations: 1, of 4 episodes each; seed: 0.",)
    assert [type(part) for part in section.parts] == [Picture, Sheet, Picture, Passage, Player]
    page = report_page([section], title="One")
    assert "corridor, played by run-00" in page
    Elements(page)


def test_a_report_opens_without_an_error_and_unfolds_on_paper(tmp_path: Path) -> None:
    learn_runs(TWO_RUNS, tmp_path / "runs")
    page = report_page([section_of(tmp_path / "runs", episodes=1)], title="One")
    script = """
    const texts = [...document.querySelectorAll("details")], states = () => texts.map((text) => text.open);
    const told = [states()];
    for (const event of ["beforeprint", "afterprint"]) {
      dispatchEvent(new Event(event));
      told.push(states());
    }
    texts[0].querySelector("summary").click();
    return [...told, texts[0].open, document.querySelectorAll("iframe").length];
    """
    before, printed, after, clicked, players = told_by(page, script, tmp_path)
    assert before
    assert not any(before)
    assert all(printed)
    assert after == before
    assert clicked
    assert players == 1


def test_a_run_before_its_first_iteration_has_nothing_to_report(tmp_path: Path) -> None:
    learn_runs(SMALL, tmp_path)
    (tmp_path / "checkpoint.json").unlink()
    with pytest.raises(InputError, match="has not finished an iteration yet"):
        section_of(tmp_path)


def test_everything_on_the_page_is_text_whatever_it_contains() -> None:
    evil = "<script>alert('&')</script>"
    claims = (Claim(evil, 0.5, low=1.0), Claim("half", 0.5, high=1.0), Claim("other", missing=(evil,)))
    parts = (Sheet(evil, {evil: ""}, ((evil,),)), Passage(evil, evil), Player(evil, f'<p title="{evil}">'))
    text = report_page([Section(evil, (evil,), claims, parts)] * 2, title=evil)
    assert evil not in text
    assert text.count("<script>") == 1
    page = Elements(text)
    assert page.texts.count(evil) == 2 + 2 * 10
    # What plays episodes is a page of its own.
    assert ("srcdoc", f'<p title="{evil}">') in page.attributes
    assert re.findall(r'<td class="(met|missed|not)">', text)[:3] == ["missed", "met", "not"]


def test_pictures_stand_beside_each_other() -> None:
    picture, passage = Picture("one", Figure()), Passage("text", "")
    text = report_page([Section("a", (), (), (picture, picture, passage, picture))], title="Three")
    rows = re.findall(r'<div class="pictures">(.*?)</figure></div>', text, re.DOTALL)
    assert [row.count("<figcaption>") for row in rows] == [2, 1]
    Elements(text)


@pytest.mark.parametrize(
    ("files", "error", "complaint"),
    [
        (None, InputError, "there is no folder"),
        ({}, InputError, "neither a study nor a run"),
        ({"notes.txt": ""}, InputError, "neither a study nor a run"),
        ({"study.json": "{"}, RunFolderError, "study.json"),
        ({"run.json": "{}"}, ModelFormatError, "run.json"),
    ],
)
def test_other_folders_are_refused(
    tmp_path: Path, files: dict[str, str] | None, error: type[Exception], complaint: str
) -> None:
    folder = tmp_path / "results"
    if files is not None:
        folder.mkdir()
        for name, text in files.items():
            (folder / name).write_text(text, "utf-8")
    with pytest.raises(error, match=complaint):
        section_of(folder)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"study": "alchemy"}, "of the study 'alchemy', which this version"),
        ({"settings": 3}, "damaged"),
        ({"settings": []}, "has no results yet"),
    ],
)
def test_studies_that_are_unknown_damaged_or_empty_are_refused(
    tmp_path: Path, change: dict[str, object], complaint: str
) -> None:
    write_study(tmp_path, done=1)
    content = {
        "study": "color-learning",
        "seed": 3,
        "smoke": False,
        "settings": [asdict(SETTINGS["color-grouping"][0])],
    }
    write_json(tmp_path / "study.json", {"format": "relforest-study", "version": 1, **content, **change})
    with pytest.raises((InputError, RunFolderError), match=complaint):
        section_of(tmp_path)
