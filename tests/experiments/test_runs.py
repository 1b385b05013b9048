from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from experiments.run_folders import SMALL, TWO_RUNS, contents, stamps
from relforest.experiments.run_config import RunConfig
from relforest.experiments.runs import learn_runs
from relforest.runs.store import iterations_of, metrics_of
from relforest.support.errors import InputError, ModelFormatError, RunFolderError

HOLDER = """
import sys
from relforest.support.locks import FolderLock
with FolderLock(sys.argv[1]):
    print("held", flush=True)
    sys.stdin.read()
"""


class KilledError(BaseException):
    """Stands for the end of the process."""


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished run of the small configuration, only to be read."""
    out = tmp_path_factory.mktemp("finished")
    learn_runs(SMALL, out)
    return out


@pytest.fixture(scope="module")
def two_finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two finished runs, only to be read."""
    out = tmp_path_factory.mktemp("two")
    learn_runs(TWO_RUNS, out)
    return out


def test_a_run_folder_holds_configuration_results_and_pictures(finished: Path) -> None:
    names = {name for name in contents(finished) if not name.startswith(("trees/", "experience/"))}

    assert names == {
        "run.json",
        "checkpoint.json",
        "metrics.jsonl",
        "policy.json",
        "weights.npz",
        "q-function.png",
        "reward.png",
    }
    rows = [json.loads(line) for line in (finished / "metrics.jsonl").read_text().splitlines()]
    assert [list(row) for row in rows] == [
        ["iteration", "test_reward", "train_reward", "trees", "leaves"]
    ] * 2
    assert [row["iteration"] for row in rows] == [0, 1]
    assert list(metrics_of(finished)) == rows
    assert json.loads((finished / "run.json").read_text())["seed"] == 0


def test_iterations_are_reported_with_their_rows_and_seconds(tmp_path: Path, finished: Path) -> None:
    reports: list[tuple[int, dict[str, Any], dict[str, float]]] = []
    learn_runs(SMALL, tmp_path / "out", on_iteration=lambda *report: reports.append(report))

    assert [run for run, _, _ in reports] == [0, 0]
    assert [row for _, row, _ in reports] == list(metrics_of(finished))
    assert all(sum(seconds.values()) > 0.0 for _, _, seconds in reports)


def test_a_finished_run_is_left_unchanged(finished: Path) -> None:
    before = stamps(finished)
    reports: list[int] = []

    assert learn_runs(SMALL, finished, on_iteration=lambda run, _row, _s: reports.append(run)) == [finished]
    assert stamps(finished) == before
    assert reports == []


def test_more_iterations_extend_a_run_to_the_one_that_had_them_at_once(tmp_path: Path) -> None:
    longer = replace(SMALL, iterations=2)
    learn_runs(longer, tmp_path / "at-once")
    learn_runs(SMALL, tmp_path / "extended")
    learn_runs(longer, tmp_path / "extended")

    assert contents(tmp_path / "extended") == contents(tmp_path / "at-once")


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"seed": 7}, r"seed \(0 there, 7 here\)"),
        ({"episodes": 5}, r"episodes \(4 there, 5 here\)"),
        ({"test_episodes": 3}, r"test_episodes \(2 there, 3 here\)"),
        ({"features": "bits"}, r"features \('densities\+bits' there, 'bits' here\)"),
        ({"runs": 2}, r"runs \(1 there, 2 here\)"),
    ],
)
def test_another_configuration_is_refused(finished: Path, changes: dict[str, Any], named: str) -> None:
    before = stamps(finished)

    with pytest.raises(RunFolderError, match=f"{named}.*choose another folder"):
        learn_runs(replace(SMALL, **changes), finished)
    assert stamps(finished) == before


def test_a_folder_of_something_else_is_not_touched(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("mine")

    with pytest.raises(RunFolderError, match=r"contains .thesis\.txt. but not run\.json"):
        learn_runs(SMALL, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


def test_the_number_of_jobs_is_checked_before_anything_is_written(tmp_path: Path) -> None:
    for n_jobs in (0, -2):
        with pytest.raises(
            InputError, match=f"n_jobs must be a positive integer, or -1 for all cores, got {n_jobs}"
        ):
            learn_runs(SMALL, tmp_path / "out", n_jobs=n_jobs)
    assert not (tmp_path / "out").exists()


def test_the_first_of_many_runs_is_the_single_run(finished: Path, two_finished: Path) -> None:
    first = contents(two_finished / "run-00")
    single = contents(finished, pictures=False)

    # They differ in what says how many runs there are.
    del first["run.json"], single["run.json"]
    assert first == single
    assert first["metrics.jsonl"] != contents(two_finished / "run-01")["metrics.jsonl"]


def test_runs_in_processes_give_the_same_files(tmp_path: Path, two_finished: Path) -> None:
    reports: list[tuple[int, int]] = []
    folders = learn_runs(
        TWO_RUNS,
        tmp_path / "out",
        n_jobs=2,
        on_iteration=lambda run, row, _: reports.append((run, row["iteration"])),
    )

    assert [folder.name for folder in folders] == ["run-00", "run-01"]
    assert sorted(reports) == [(0, 0), (0, 1), (1, 0), (1, 1)]
    assert contents(tmp_path / "out") == contents(two_finished)


def test_a_run_in_use_by_a_worker_that_survived_is_refused(tmp_path: Path, two_finished: Path) -> None:
    out = tmp_path / "out"
    command = [sys.executable, "-c", HOLDER, str(out / "run-01")]
    learn_runs(TWO_RUNS, out)
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "held\n"
        with pytest.raises(RunFolderError, match=f"run-01 is in use by process {process.pid}"):
            learn_runs(replace(TWO_RUNS, iterations=2), out)
        process.kill()
    assert contents(out / "run-01") == contents(two_finished / "run-01")


def killed_at_write(number: int, config: RunConfig, out: Path, monkeypatch: pytest.MonkeyPatch) -> bool:
    """Learn, but end within the write of that number and leave its temporary file; False if there is none."""
    replace_file, unlink, written = Path.replace, Path.unlink, 0

    def count(path: Path, target: Path) -> Path:
        nonlocal written
        written += 1
        if written == number:
            raise KilledError
        return replace_file(path, target)

    def keep_temporary(path: Path, missing_ok: bool = False) -> None:  # noqa: FBT001, FBT002 - pathlib's
        if path.suffix != ".tmp":
            unlink(path, missing_ok=missing_ok)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", count)
        patch.setattr(Path, "unlink", keep_temporary)
        try:
            learn_runs(config, out)
        except KilledError:
            return True
    return False


def test_a_run_killed_at_any_write_resumes_to_the_same_files(
    tmp_path: Path, finished: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    number = 1
    while killed_at_write(number, SMALL, out := tmp_path / f"{number}", monkeypatch):
        learn_runs(SMALL, out)
        assert contents(out) == contents(finished), f"killed at write {number}"
        number += 1

    # run.json; checkpoint, metrics, weights and policy twice; experience and at least one tree; two pictures.
    assert number > 1 + 4 + 4 + 2 + 2


def test_several_runs_killed_in_the_middle_resume_to_the_same_files(
    tmp_path: Path, two_finished: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for number in (1, 2, 20):
        out = tmp_path / f"{number}"
        assert killed_at_write(number, TWO_RUNS, out, monkeypatch)
        learn_runs(TWO_RUNS, out)
        assert contents(out) == contents(two_finished)


def test_a_damaged_checkpoint_is_named(tmp_path: Path) -> None:
    learn_runs(SMALL, tmp_path)
    (tmp_path / "checkpoint.json").write_text('{"format": "relforest-checkpoint", "version": 1}')

    assert iterations_of(tmp_path) == -1
    with pytest.raises(ModelFormatError, match=r"checkpoint\.json is damaged"):
        metrics_of(tmp_path)
    with pytest.raises(ModelFormatError, match=r"checkpoint\.json is damaged"):
        learn_runs(SMALL, tmp_path)


def test_a_run_that_has_not_begun_has_no_metrics(tmp_path: Path) -> None:
    assert metrics_of(tmp_path / "nothing") == ()
    assert iterations_of(tmp_path / "nothing") == -1


def test_a_configuration_is_a_value() -> None:
    assert RunConfig("corridor") == RunConfig("corridor")
    assert hash(RunConfig("corridor")) == hash(RunConfig("corridor"))
