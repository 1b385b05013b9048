"""A run that is interrupted anywhere and taken up again ends with the same files."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from interpreted import compiled_only
from relforest.rl.experience import COLUMNS, OPTIONAL_COLUMNS
from relforest.rl.policy_json import POLICY, TREES, WEIGHTS
from relforest.rl.rpi import SMRFRPI
from relforest.rl.saved_policy import read_policy
from relforest.rl.settings import RPISettings
from relforest.rl.value import ValueFunction
from relforest.runs.store import CHECKPOINT, METRICS, TIMINGS
from relforest.support import files
from relforest.support.errors import ModelFormatError, RunFolderError
from relforest.support.locks import FolderLock
from relforest.worlds.corridor.env import CorridorEnv
from rl.small_worlds import Picking

pytestmark = compiled_only

QUICK = RPISettings(trees_per_label=1, max_rounds=2, max_scenes=40)
ITERATIONS, EPISODES = 2, 5
EXPERIENCE = "experience"


def learn(folder: Path, iterations: int = ITERATIONS, episodes: int = EPISODES, **options: Any) -> SMRFRPI:
    chosen: dict[str, Any] = {"settings": QUICK, "random_state": 0, "checkpoint": folder}
    return SMRFRPI(CorridorEnv(), **(chosen | options)).learn(iterations, episodes)


def contents(folder: Path) -> dict[str, bytes]:
    """Everything but clock times and the lock."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name not in {TIMINGS, ".lock"}
    }


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("finished")
    learn(folder)
    return folder


@pytest.fixture
def copy(finished: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(finished, tmp_path / "copy"))


def test_the_files_of_a_run(finished: Path) -> None:
    names = set(contents(finished))
    assert {CHECKPOINT, METRICS, POLICY, WEIGHTS} <= names
    assert {f"{EXPERIENCE}/iteration-000{number}.npz" for number in (1, 2)} <= names
    assert f"{TREES}/0001-left-1.json" in names or f"{TREES}/0001-right-1.json" in names
    value = read_policy(finished)
    assert isinstance(value, ValueFunction)
    assert value.n_trees == sum(name.startswith(f"{TREES}/") for name in names)


def test_metrics_are_lines_of_json(finished: Path) -> None:
    rows = [json.loads(line) for line in (finished / METRICS).read_text("utf-8").splitlines()]
    assert rows == learn(finished).metrics_
    times = [json.loads(line) for line in (finished / TIMINGS).read_text("utf-8").splitlines()]
    assert [row["iteration"] for row in times] == [0, 1, 2]


def test_a_finished_run_is_left_alone(copy: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in copy.rglob("*") if path.name != ".lock"}
    learn(copy)
    learn(copy, iterations=1)
    after = {path: path.stat().st_mtime_ns for path in copy.rglob("*") if path.name != ".lock"}
    assert {path.name for path in after if after[path] != before.get(path)} <= {copy.name}


def test_more_iterations_extend_a_finished_run(finished: Path, tmp_path: Path) -> None:
    learn(tmp_path, iterations=1)
    learn(tmp_path)
    assert contents(tmp_path) == contents(finished)


class Killed(BaseException):
    """Stands for the end of the process: nothing catches it."""


def fail_at(monkeypatch: pytest.MonkeyPatch, place: int, *, torn: bool) -> None:
    """Let the process end at the `place`-th writing of a file; if `torn`, after leaving a part of it."""
    count = 0
    write: Callable[..., None] = files.write_bytes

    def write_bytes(path: Path, data: bytes) -> None:
        nonlocal count
        count += 1
        if count == place:
            if torn:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.with_name(f".{path.name}.0123456789abcdef.tmp").write_bytes(data[:10])
            raise Killed
        write(path, data)

    monkeypatch.setattr(files, "write_bytes", write_bytes)


def test_a_run_killed_at_any_file_goes_on_to_the_same_end(
    finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place, expected = 0, contents(finished)
    while True:
        place += 1
        folder = tmp_path / str(place)
        fail_at(monkeypatch, place, torn=place % 2 == 0)
        try:
            learn(folder)
        except Killed:
            monkeypatch.undo()
            assert learn(folder).metrics_[-1]["iteration"] == ITERATIONS
            assert contents(folder) == expected
        else:
            break
    monkeypatch.undo()
    # Three files for row 0; at least experience, a tree, checkpoint and three derived files per iteration.
    assert place > 4 + 2 * 6


def test_leftovers_of_an_unfinished_iteration_do_no_harm(finished: Path, copy: Path) -> None:
    (copy / TREES / "0003-left-1.json").write_text("{", "utf-8")
    (copy / EXPERIENCE / "iteration-0003.npz").write_bytes(b"PK")
    (copy / TREES / ".0003-left-2.json.0123456789abcdef.tmp").write_text("{", "utf-8")
    (copy / "notes.txt").write_text("mine", "utf-8")
    learn(copy)
    assert contents(copy) == contents(finished) | {"notes.txt": b"mine"}


@pytest.mark.parametrize("name", [METRICS, POLICY, WEIGHTS])
def test_derived_files_are_restored(finished: Path, copy: Path, name: str) -> None:
    (copy / name).unlink()
    learn(copy)
    assert contents(copy) == contents(finished)


def test_derived_files_of_an_older_iteration_are_replaced(finished: Path, copy: Path) -> None:
    older = json.loads((copy / POLICY).read_text("utf-8")) | {"iteration": 1}
    (copy / POLICY).write_text(json.dumps(older), "utf-8")
    lines = (copy / METRICS).read_text("utf-8").splitlines(keepends=True)
    (copy / METRICS).write_text("".join(lines[:-1]), "utf-8")
    learn(copy)
    assert contents(copy) == contents(finished)


def test_an_unnamed_seed_is_taken_from_the_folder(finished: Path, copy: Path) -> None:
    learn(copy, random_state=None)
    assert contents(copy) == contents(finished)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"random_state": 1}, r"random_state\.entropy \(0 there, 1 here\)"),
        ({"episodes": 7}, r"episodes \(5 there, 7 here\)"),
        ({"settings": RPISettings(alpha=0.2)}, r"settings\.alpha \(0\.05 there, 0\.2 here\)"),
    ],
)
def test_another_configuration_is_refused(copy: Path, changes: dict[str, Any], message: str) -> None:
    before = contents(copy)
    with pytest.raises(RunFolderError, match=message):
        learn(copy, **changes)
    assert contents(copy) == before


def test_a_run_of_another_world_is_refused(copy: Path) -> None:
    other = SMRFRPI(Picking(), settings=QUICK, random_state=0, checkpoint=copy)
    with pytest.raises(RunFolderError, match=r"world\.name \('CorridorEnv' there, 'Picking' here\)"):
        other.learn(ITERATIONS, EPISODES)


def test_a_folder_in_use_is_refused(copy: Path) -> None:
    with FolderLock(copy), pytest.raises(RunFolderError, match="in use"):
        learn(copy)


def test_a_folder_without_its_checkpoint_is_refused(copy: Path) -> None:
    (copy / CHECKPOINT).unlink()
    with pytest.raises(RunFolderError, match=rf"{CHECKPOINT} is missing from .*{METRICS}"):
        learn(copy)
    (copy / METRICS).unlink()
    with pytest.raises(RunFolderError, match=rf"contains {POLICY}, which is not part of a run"):
        learn(copy)


@pytest.mark.parametrize("pattern", [CHECKPOINT, f"{EXPERIENCE}/*", f"{TREES}/*"])
@pytest.mark.parametrize("content", [b"", b"\x00" * 100, b'{"format": "something", "version": 1}'])
def test_damaged_files_are_named(copy: Path, pattern: str, content: bytes) -> None:
    path = next(copy.glob(pattern))
    path.write_bytes(content)
    with pytest.raises(ModelFormatError, match=path.name):
        learn(copy)


@pytest.mark.parametrize("pattern", [f"{EXPERIENCE}/*", f"{TREES}/*"])
def test_missing_files_are_named(copy: Path, pattern: str) -> None:
    path = next(copy.glob(pattern))
    path.unlink()
    with pytest.raises(ModelFormatError, match=path.name):
        learn(copy)


def edited(folder: Path, **changes: Any) -> Path:
    document = json.loads((folder / CHECKPOINT).read_text("utf-8"))
    (folder / CHECKPOINT).write_text(json.dumps(document | changes), "utf-8")
    return folder


ROW = {"iteration": 0, "test_reward": 1.0, "train_reward": None, "trees": 0, "leaves": 0}


@pytest.mark.parametrize(
    "changes",
    [
        {"metrics": None},
        {"metrics": []},
        {"metrics": [ROW]},
        {"metrics": {"a": ROW}},
        {"metrics": [ROW | {"iteration": 1}], "iteration": 0},
        {"metrics": [ROW | {"trees": "many"}], "iteration": 0},
        {"metrics": [ROW | {"test_reward": None}], "iteration": 0},
        {"metrics": [ROW | {"more": 1}], "iteration": 0},
        {"metrics": [ROW | {"leaves": True}], "iteration": 0},
        {"metrics": [ROW | {"test_reward": -(10**400)}], "iteration": 0},
        {"weights": {"left": [10**400], "right": [0]}},
        {"weights": {"left": ["1"], "right": [0]}},
        {"weights": {"left": 1, "right": [0]}},
        {"weights": {"left": [True], "right": [0]}},
        {"iteration": 7},
        {"configuration": None},
        {"configuration": 3},
        {"policy": None},
        {"policy": {}},
        {"weights": []},
        {"weights": {"left": ["x"], "right": []}},
        {"weights": {"left": [1e308, 1e308], "right": []}},
    ],
)
def test_hostile_checkpoints_are_refused(copy: Path, changes: dict[str, Any]) -> None:
    with pytest.raises(ModelFormatError, match=CHECKPOINT):
        learn(edited(copy, **changes))


def test_experience_of_another_world_is_refused(copy: Path) -> None:
    path = copy / EXPERIENCE / "iteration-0001.npz"
    arrays = files.read_npz(path, COLUMNS, optional=OPTIONAL_COLUMNS)
    arrays["types"] = arrays["types"] + 5
    files.write_npz(path, arrays)
    with pytest.raises(ModelFormatError, match=r"iteration-0001\.npz belongs to a different world"):
        learn(copy)


def test_equal_runs_have_equal_bytes(finished: Path, tmp_path: Path) -> None:
    learn(tmp_path, n_jobs=2)
    assert contents(tmp_path) == contents(finished)
    assert files.read_npz(tmp_path / WEIGHTS, ["iteration"])["iteration"] == ITERATIONS


@pytest.mark.parametrize("name", ["notes.txt", "trees/mine.json", "experience/photo.png"])
def test_a_folder_with_files_of_other_work_is_refused_and_left_alone(
    finished: Path, tmp_path: Path, name: str
) -> None:
    foreign = tmp_path / "foreign" / name
    foreign.parent.mkdir(parents=True)
    foreign.write_text("precious", encoding="utf-8")
    agent = SMRFRPI.load(finished, CorridorEnv())

    for write in (agent.save, learn):
        with pytest.raises(RunFolderError, match=f"contains {name}, which is not part of a run; choose"):
            write(tmp_path / "foreign")
    assert foreign.read_text(encoding="utf-8") == "precious"
    assert {path.name for path in (tmp_path / "foreign").iterdir()} <= {
        name.split("/", maxsplit=1)[0],
        ".lock",
    }


def test_foreign_files_that_came_later_are_left_alone(copy: Path) -> None:
    (copy / TREES / "mine.json").write_text("precious", encoding="utf-8")
    learn(copy, ITERATIONS + 1)

    assert (copy / TREES / "mine.json").read_text(encoding="utf-8") == "precious"
