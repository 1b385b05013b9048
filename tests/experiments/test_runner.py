from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import final

import pytest
from matplotlib.figure import Figure

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.run_config import RunConfig
from relforest.experiments.runner import run_study
from relforest.experiments.runs import RunInFolder
from relforest.experiments.sheets import Sheet
from relforest.experiments.study import Context, Study, Unavailable, repeated, resized
from relforest.experiments.table import Row, Table
from relforest.rl.fitted.settings import Source
from relforest.runs.store import read_checkpoint
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


def throw(setting: Throws, context: Context) -> list[Row]:
    faces = generator(context.stream).integers(1, 7, size=setting.count).tolist()
    return [{"throw": number, "face": face} for number, face in enumerate(faces)]


def stop_at_three(setting: Throws, context: Context) -> list[Row]:
    if setting.count == 3:
        raise KilledError
    return throw(setting, context)


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
    with pytest.raises(RunFolderError, match=r"0000\.json.*delete .* to compute it again"):
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


def by_parity(setting: Throws) -> str:
    return "odd" if setting.count % 2 else "even"


CHOOSY = replace(STUDY, choices={"parity": by_parity, "counts": lambda setting: str(setting.count)})


def test_a_choice_may_be_widened_later_in_the_same_folder(tmp_path: Path) -> None:
    run_study(STUDY, tmp_path / "whole")
    narrow = run_study(CHOOSY, tmp_path / "grown", only={"parity": ["even"], "counts": []})
    lines = (tmp_path / "grown" / "rows.csv").read_text().splitlines()

    assert narrow.text == "6 throws"
    # Rows are numbered as in the whole study, and have its random numbers.
    assert [line.split(",")[0] for line in lines[1:]] == ["dice/0/0"] * 2 + ["dice/2/0"] * 4
    assert set(lines) < set((tmp_path / "whole" / "rows.csv").read_text().splitlines())

    told: list[str] = []
    run_study(CHOOSY, tmp_path / "grown", on_progress=told.append)
    assert told == ["dice: 3 of 3 done (3 throws)"]
    assert contents(tmp_path / "grown") == contents(tmp_path / "whole")

    run_study(CHOOSY, tmp_path / "grown", only={"parity": ["odd"]})
    assert (tmp_path / "grown" / "summary.txt").read_text().startswith("3 throws\n")
    assert contents(tmp_path / "grown")["rows.csv"] == contents(tmp_path / "whole")["rows.csv"]


@pytest.mark.parametrize(
    ("only", "complaint"),
    [
        (
            {"sides": ["6"]},
            r"the study dice does not offer a choice of sides, only of parity and counts: omit it",
        ),
        ({"counts": ["2", "5"]}, r"counts of the study dice must be one of '2', '3', '4', got '5'"),
        (
            {"counts": ["2"], "parity": ["odd"]},
            r"no setting of the study dice has counts 2 and parity odd: choose",
        ),
    ],
)
def test_a_choice_must_exist(tmp_path: Path, only: dict[str, list[str]], complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        run_study(CHOOSY, tmp_path / "out", only=only)
    assert not (tmp_path / "out").exists()


def test_a_study_without_choices_says_so(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="the study dice does not offer a choice of methods: omit it"):
        run_study(STUDY, tmp_path / "out", only={"methods": ["a"]})


def lacking_dice(settings: Sequence[Throws]) -> dict[Throws, Unavailable]:
    return {
        setting: Unavailable(f"die {setting.count}", "Buy some." if setting.count < 4 else "Find it.")
        for setting in settings
        if setting.count > 2
    }


def test_what_cannot_be_computed_is_left_out_and_told(tmp_path: Path) -> None:
    told: list[str] = []
    study = replace(STUDY, unavailable=lacking_dice)
    findings = run_study(study, tmp_path, on_progress=told.append)
    notes = ["Left out (1 settings): die 3. Buy some.", "Left out (1 settings): die 4. Find it."]

    assert told == [*notes, "dice: 1 of 1 done (2 throws)"]
    assert findings.text.splitlines() == [*notes, "", "2 throws"]
    assert (tmp_path / "summary.txt").read_text() == f"{findings}\n"
    # What has been computed is there, whatever is missing now.
    run_study(STUDY, tmp_path)
    assert run_study(study, tmp_path).text == "9 throws"


def test_nothing_left_to_compute_is_an_error(tmp_path: Path) -> None:
    study = replace(CHOOSY, unavailable=lacking_dice)
    with pytest.raises(InputError, match=r"^Left out \(1 settings\): die 3\. Buy some\.$"):
        run_study(study, tmp_path / "out", only={"parity": ["odd"]})
    assert not (tmp_path / "out").exists()


def test_findings_may_bring_documents(tmp_path: Path) -> None:
    def with_table(table: Table) -> Findings:
        return Findings("text", (), (Sheet("Throws", {"": "", "number": ""}, (("all", len(table)),)),))

    run_study(replace(STUDY, summarize=with_table), tmp_path)
    assert "| all | 9 |" in (tmp_path / "tables.md").read_text()


def beginning_with(folder: Path | None, context: Context) -> RunInFolder:
    source = None if folder is None else Source(folder)
    config = RunConfig("corridor", 4, 1, test_episodes=1, method="smrf-q", source=source)
    return RunInFolder(config, 0, context.folder / "runs" / str(context.index))


def test_runs_are_learned_after_those_that_they_begin_with(tmp_path: Path) -> None:
    # The first setting needs the run of the second.
    def learned(setting: Throws, context: Context) -> RunInFolder:
        return beginning_with(tmp_path / "runs" / "1" if setting.count == 2 else None, context)

    run_study(replace(STUDY, settings=STUDY.settings[:2], learned=learned), tmp_path)

    begun, source = (read_checkpoint(tmp_path / "runs" / name) for name in ("0", "1"))
    assert begun.configuration["from"] == str(tmp_path / "runs" / "1")
    assert begun.iteration == source.iteration == 1


@final
@dataclass(frozen=True, slots=True)
class Turn:
    """A throw by one of some players."""

    count: int
    run: int = 0
    runs: int = 2

    def __str__(self) -> str:
        return f"{self.count} throws, player {self.run}"


SIZED = Study(
    "turns",
    "Who wins?",
    tuple(Turn(count, run) for count in (2, 3) for run in range(2)),
    (Turn(1, 0, 1),),
    throw,  # type: ignore[arg-type]  # a turn has a count too
    summarize,
    sizes={"runs": repeated, "throws": lambda setting, number: (replace(setting, count=number),)},
)


def test_a_study_is_made_larger_and_smaller() -> None:
    larger = resized(SIZED, {"runs": 3, "throws": 5})
    assert larger.settings == tuple(Turn(5, run, 3) for _ in range(2) for run in range(3))
    assert larger.smoke == tuple(Turn(5, run, 3) for run in range(3))
    assert resized(SIZED, {}) is SIZED


@pytest.mark.parametrize(
    ("sizes", "complaint"),
    [
        ({"runs": 0}, "runs must be an integer of at least 1, got 0"),
        (
            {"games": 3},
            "the number of games of the study turns cannot be chosen, only its runs and throws: omit it",
        ),
    ],
)
def test_sizes_must_exist_and_be_positive(sizes: dict[str, int], complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        resized(SIZED, sizes)


def test_a_study_of_one_size_says_so() -> None:
    with pytest.raises(InputError, match="the number of runs of the study dice cannot be chosen: omit it"):
        resized(STUDY, {"runs": 3})


def test_another_size_needs_another_folder(tmp_path: Path) -> None:
    run_study(resized(SIZED, {"throws": 1}), tmp_path)
    with pytest.raises(RunFolderError, match=r"settings\[0\]\.runs \(2 there, 3 here\); choose another"):
        run_study(resized(SIZED, {"throws": 1, "runs": 3}), tmp_path)
