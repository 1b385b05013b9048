from __future__ import annotations

import sys
from pathlib import Path

import pytest

from relforest.experiments.resume.run import command, compare, kill_after, run
from relforest.experiments.resume.settings import SETTINGS, SMOKE, ResumeSetting
from relforest.experiments.study import Place
from relforest.support.errors import RelforestError


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
    parent = f"import subprocess, sys, time; subprocess.Popen([sys.executable, '-c', {child!r}]); time.sleep(60)"

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
    with pytest.raises(RelforestError, match=r"relforest learn failed in .* with exit status 1:\n.*episodes must be"):
        run(ResumeSetting("x", 1, 1, 1, episodes=0, moments=1), Place(0, 0, tmp_path))


def test_every_variant_is_killed_at_ten_moments() -> None:
    assert {setting.moments for setting in SETTINGS} == {10}
    assert max(setting.kills for setting in SETTINGS) > 1
    assert [setting.moments for setting in SMOKE] == [1]
