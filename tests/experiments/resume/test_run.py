from __future__ import annotations

import signal
import time
from pathlib import Path

import pytest

from relforest.experiments.resume import run
from relforest.experiments.resume.run import KILLS, Kill, command, compare, compute, kill_after
from relforest.experiments.resume.settings import SETTINGS, SMOKE, ResumeSetting
from relforest.experiments.study import Context
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


ALL = Kill(signal.SIGKILL, all_processes=True)
FIRST = Kill(signal.SIGKILL, all_processes=False)
SLEEPING_CHILD = """
import subprocess, time
subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
time.sleep(60)
"""


def test_a_killed_command_takes_its_children_along(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "_RELFOREST", SLEEPING_CHILD)

    assert kill_after([], 1.0, ALL) == (True, 0)


def test_children_that_outlive_the_first_process_are_counted_and_killed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    processes: list[int] = []
    count = run.running

    def running(group: int) -> int:
        processes.append(group)
        return count(group)

    monkeypatch.setattr(run, "_RELFOREST", SLEEPING_CHILD)
    monkeypatch.setattr(run, "LONGEST", 0.2)
    monkeypatch.setattr(run, "running", running)

    assert kill_after([], 1.0, FIRST) == (True, 1)
    limit = time.monotonic() + 10.0
    while count(processes[0]) and time.monotonic() < limit:
        time.sleep(0.05)
    assert count(processes[0]) == 0


def test_a_command_that_has_ended_was_not_running(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "_RELFOREST", "pass")

    assert kill_after([], 60.0, FIRST) == (False, 0)


def test_the_command_is_the_one_that_users_type(tmp_path: Path) -> None:
    assert command(ResumeSetting("x", "x", 2, 2, 1, 30, 3), tmp_path, 7, 2) == [
        *("learn", "corridor", "--method", "smrf-rpi", "--episodes", "30", "--iterations", "3"),
        *("--runs", "2", "--jobs", "2", "--seed", "7", "--out", str(tmp_path)),
    ]


def test_a_run_that_fails_is_no_result(tmp_path: Path) -> None:
    with pytest.raises(
        RelforestError, match=r"relforest learn failed in .* with exit status 2:\n.*--episodes must be"
    ):
        compute(ResumeSetting("x", "x", 1, 1, 1, episodes=0, moments=1), Context(0, 0, tmp_path))


COUNTING = """
import pathlib, time
out = pathlib.Path(sys.argv[-1])
out.mkdir(parents=True, exist_ok=True)
(out / "starts").open("a").write("x" if {counted} else "")
time.sleep(0.8)
(out / "result").write_text("42")
"""


@pytest.mark.parametrize(("counted", "identical"), [(False, True), (True, False)])
def test_each_moment_is_killed_as_often_as_it_says_and_compared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, counted: bool, identical: bool
) -> None:
    monkeypatch.setattr(run, "_RELFOREST", COUNTING.format(counted=counted))
    rows = compute(ResumeSetting("x", "x", 1, 1, 1, moments=2, kills=2), Context(0, 0, tmp_path))

    assert [row["moment"] for row in rows] == [0, 1]
    assert [row["identical"] for row in rows] == [identical] * 2
    assert [row["differing"] for row in rows] == ["" if identical else "starts"] * 2
    assert [row["files"] for row in rows] == [2, 2]
    assert all(
        0.5 * moment <= float(str(row["fraction"])) < 0.5 * (moment + 1) for moment, row in enumerate(rows)
    )


def test_every_variant_is_killed_at_ten_moments_and_the_first_process_at_a_hundred() -> None:
    moments = {setting.name: 0 for setting in SETTINGS}
    for setting in SETTINGS:
        moments[setting.name] += setting.moments

    learners = {"smrf-q-keepaway": 10, "smrf-q-high-towers": 10}
    assert moments == {"threads": 10, "processes": 10, "thrice": 10, "orphans": 100, **learners}
    assert max(setting.kills for setting in SETTINGS) > 1
    assert {setting.moments for setting in SMOKE} == {1}


def test_the_first_process_is_killed_in_every_way(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "_RELFOREST", COUNTING.format(counted=False))
    rows = compute(
        ResumeSetting("x", "x", 1, 1, 1, moments=4, whom="parent", part=2), Context(0, 0, tmp_path)
    )

    assert [row["signal"] for row in rows] == [kill.name for kill in KILLS[1:]]
    assert [row["moment"] for row in rows] == [8, 9, 10, 11]
    assert [row["survivors"] for row in rows] == [0] * 4
    assert not list((tmp_path / "runs").rglob("killed-*"))
