from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import final

import pytest
from matplotlib.figure import Figure

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.runner import run_study
from relforest.experiments.study import Place, Study
from relforest.experiments.table import Row, Table
from relforest.support.errors import InputError, RunFolderError
from relforest.support.rng import generator


@final
@dataclass(frozen=True, slots=True)
class Throws:
    """Some throws of a die."""

    count: int

    def __str__(self) -> str:
        return f"{self.count} throws"


class KilledError(BaseException):
    """Stands for the end of the process."""


def throw(setting: Throws, place: Place) -> list[Row]:
    faces = generator(place.stream).integers(1, 7, size=setting.count).tolist()
    return [{"throw": number, "face": face} for number, face in enumerate(faces)]


def stop_at_three(setting: Throws, place: Place) -> list[Row]:
    if setting.count == 3:
        raise KilledError
    return throw(setting, place)


def summarize(table: Table) -> Findings:
    mean = float(table.numbers("face").mean())
    return Findings(f"{len(table)} throws", (Claim("mean face", mean, low=1.0, high=6.0),))


def figures(table: Table) -> Mapping[str, Figure]:
    figure = Figure()
    figure.add_subplot().plot(table.numbers("face"))
    return {"faces.png": figure}


STUDY = Study(
    "dice", "Is it fair?", (Throws(2), Throws(3), Throws(4)), (Throws(1),), throw, summarize, figures
)


def contents(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file() and path.name != ".lock")
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def test_a_study_saves_rows_summary_and_figures(tmp_path: Path) -> None:
    findings = run_study(STUDY, tmp_path / "out", seed=5)

    lines = (tmp_path / "out" / "rows.csv").read_text().splitlines()
    assert lines[0] == "id,throw,face"
    assert [line.split(",")[0] for line in lines[1:]] == ["dice/0/5"] * 2 + ["dice/1/5"] * 3 + [
        "dice/2/5"
    ] * 4
    assert findings.text == "9 throws"
    assert (tmp_path / "out" / "summary.txt").read_text() == f"{findings}\n"
    assert sorted(contents(tmp_path / "out")) == [
        "faces.png",
        "rows.csv",
        "settings/0000.json",
        "settings/0001.json",
        "settings/0002.json",
        "study.json",
        "summary.txt",
    ]


def test_the_small_version_is_a_study_of_its_own(tmp_path: Path) -> None:
    assert run_study(STUDY, tmp_path / "small", smoke=True).text == "1 throws"
    with pytest.raises(RunFolderError, match=r"smoke \(True there, False here\)"):
        run_study(STUDY, tmp_path / "small")


def test_rows_depend_on_the_seed_and_not_on_the_number_of_processes(tmp_path: Path) -> None:
    run_study(STUDY, tmp_path / "one", seed=1)
    run_study(STUDY, tmp_path / "two", seed=1, n_jobs=2)
    run_study(STUDY, tmp_path / "other", seed=2)

    assert contents(tmp_path / "one") == contents(tmp_path / "two")
    assert contents(tmp_path / "one")["rows.csv"] != contents(tmp_path / "other")["rows.csv"]


def test_an_interrupted_study_computes_only_the_rest(tmp_path: Path) -> None:
    run_study(STUDY, tmp_path / "whole")
    with pytest.raises(KilledError):
        run_study(replace(STUDY, compute=stop_at_three), tmp_path / "cut")
    first = tmp_path / "cut" / "settings" / "0000.json"
    before = first.stat().st_mtime_ns
    (tmp_path / "cut" / "settings" / ".0001.json.0123456789abcdef.tmp").touch()
    lines: list[str] = []
    run_study(STUDY, tmp_path / "cut", on_progress=lines.append)

    assert first.stat().st_mtime_ns == before
    assert contents(tmp_path / "cut") == contents(tmp_path / "whole")
    assert lines == ["dice: 2 of 3 done (3 throws)", "dice: 3 of 3 done (4 throws)"]


def test_deleted_figures_are_drawn_again_from_the_saved_rows(tmp_path: Path) -> None:
    run_study(STUDY, tmp_path)
    before = contents(tmp_path)
    for name in ("faces.png", "rows.csv", "summary.txt"):
        (tmp_path / name).unlink()
    run_study(replace(STUDY, compute=stop_at_three), tmp_path)

    assert contents(tmp_path) == before


@pytest.mark.parametrize(
    "text",
    [
        "",
        '{"format": "relforest-study-rows", "version": 1}',
        '{"format": "relforest-study-rows", "version": 1, "setting": {"count": 2}, "rows": [1]}',
        '{"format": "relforest-study-rows", "version": 1, "setting": {"count": 7}, "rows": []}',
    ],
)
def test_a_damaged_setting_is_named(tmp_path: Path, text: str) -> None:
    run_study(STUDY, tmp_path)
    (tmp_path / "settings" / "0000.json").write_text(text)
    with pytest.raises(RunFolderError, match=r"0000\.json.*delete .*, and it is computed again"):
        run_study(STUDY, tmp_path)


def test_other_work_is_refused(tmp_path: Path) -> None:
    run_study(STUDY, tmp_path)
    before = contents(tmp_path)
    with pytest.raises(RunFolderError, match=r"seed \(0 there, 3 here\)"):
        run_study(STUDY, tmp_path, seed=3)
    with pytest.raises(RunFolderError, match=r"study \('dice' there, 'coins' here\)"):
        run_study(replace(STUDY, name="coins"), tmp_path)
    assert contents(tmp_path) == before


def test_options_are_checked_before_anything_is_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="seed must be an integer of at least 0, got -1"):
        run_study(STUDY, tmp_path / "out", seed=-1)
    with pytest.raises(InputError, match="n_jobs must be a positive integer, or -1 for all cores, got 0"):
        run_study(STUDY, tmp_path / "out", n_jobs=0)
    assert not (tmp_path / "out").exists()


def test_settings_are_stored_with_their_rows(tmp_path: Path) -> None:
    run_study(STUDY, tmp_path)
    document = json.loads((tmp_path / "settings" / "0000.json").read_text())

    assert document["setting"] == {"count": 2}
    assert [row["throw"] for row in document["rows"]] == [0, 1]
