from __future__ import annotations

import sys
import time
from pathlib import Path
from threading import Event, Thread

import pytest

from relforest.experiments.resume.run import await_locks, command, compare, compute, kill_after
from relforest.experiments.resume.settings import SETTINGS, SMOKE, ResumeSetting
from relforest.experiments.study import Place
from relforest.support.errors import RelforestError, RunFolderError
from relforest.support.locks import FolderLock


def write(folder: Path, **texts: str) -> None:
    folder.mkdir(exist_ok=True)
    for name, text in texts.items():
        (folder / name).write_text(text)


def test_folders_are_compared_file_by_file(tmp_path: Path) -> None:
    write(tmp_path / "a", metrics="1", tree="x", lost="y")
    write(tmp_path / "b", metrics="1", tree="z", new="w")
    for folder, clock in (("a", "1 s"), ("b", "2 s")):
        (tmp_path / folder / "timings.jsonl").write_text(clock)
        (tmp_path / folder / ".lock").write_text(clock)

    assert compare(tmp_path / "a", tmp_path / "b") == (["metrics"], ["lost", "new", "tree"])


def test_a_killed_command_takes_its_children_along(tmp_path: Path) -> None:
    child = f"import time, pathlib; time.sleep(2); pathlib.Path({str(tmp_path / 'survived')!r}).touch()"
    parent = (
        f"import subprocess, sys, time; subprocess.Popen([sys.executable, '-c', {child!r}]); time.sleep(60)"
    )

    assert kill_after([sys.executable, "-c", parent], 1.0)
    # Gone with it: this interpreter outlasts what the child would have slept.
    assert not kill_after([sys.executable, "-c", "import time; time.sleep(2.5)"], 60.0)
    assert not (tmp_path / "survived").exists()


def test_a_command_that_has_ended_was_not_running() -> None:
    assert not kill_after([sys.executable, "-c", "pass"], 60.0)


def test_the_command_is_the_one_that_users_type(tmp_path: Path) -> None:
    words = command(ResumeSetting("x", 2, 2, 1, 30, 3), tmp_path, 7, 2)

    assert words[3:] == [
        *("learn", "corridor", "--episodes", "30", "--iterations", "3", "--runs", "2"),
        *("--jobs", "2", "--seed", "7", "--out", str(tmp_path)),
    ]


def test_a_run_that_fails_is_no_result(tmp_path: Path) -> None:
    with pytest.raises(
        RelforestError, match=r"relforest learn failed in .* with exit status 1:\n.*episodes must be"
    ):
        compute(ResumeSetting("x", 1, 1, 1, episodes=0, moments=1), Place(0, 0, tmp_path))


COUNTING = """
import pathlib, sys, time
out = pathlib.Path(sys.argv[1])
out.mkdir(parents=True, exist_ok=True)
(out / "starts").open("a").write("x" if {counted} else "")
time.sleep(0.3)
(out / "result").write_text("42")
"""


@pytest.mark.parametrize(("counted", "identical"), [(False, True), (True, False)])
def test_each_moment_is_killed_as_often_as_it_says_and_compared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, counted: bool, identical: bool
) -> None:
    def short_command(_setting: ResumeSetting, out: Path, _seed: int, _jobs: int) -> list[str]:
        return [sys.executable, "-c", COUNTING.format(counted=counted), str(out)]

    monkeypatch.setattr("relforest.experiments.resume.run.command", short_command)
    rows = compute(ResumeSetting("x", 1, 1, 1, moments=2, kills=2), Place(0, 0, tmp_path))

    assert [row["moment"] for row in rows] == [0, 1]
    assert [row["identical"] for row in rows] == [identical] * 2
    assert [row["differing"] for row in rows] == ["" if identical else "starts"] * 2
    assert [row["files"] for row in rows] == [2, 2]
    assert all(
        0.5 * moment <= float(str(row["fraction"])) < 0.5 * (moment + 1) for moment, row in enumerate(rows)
    )


def test_locks_of_dying_workers_are_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    held = Event()

    def hold() -> None:
        with FolderLock(tmp_path / "run-00"):
            held.set()
            time.sleep(0.2)

    worker = Thread(target=hold)
    worker.start()
    held.wait()
    await_locks(tmp_path)
    worker.join()

    monkeypatch.setattr("relforest.experiments.resume.run._PATIENCE", 0.0)
    with FolderLock(tmp_path / "run-00"), pytest.raises(RunFolderError, match="in use"):
        await_locks(tmp_path)


def test_every_variant_is_killed_at_ten_moments() -> None:
    assert {setting.moments for setting in SETTINGS} == {10}
    assert max(setting.kills for setting in SETTINGS) > 1
    assert [setting.moments for setting in SMOKE] == [1]
