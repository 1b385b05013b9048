from __future__ import annotations

import json
import os
import shutil
from pathlib import Path
from typing import Any

import pytest

from relforest.runs.manifest import Manifest, checked_folder, differences, held, versions
from relforest.support.errors import InputError, RunFolderError
from relforest.support.locks import FolderLock

TEMPORARY = ".run.json.0123456789abcdef.tmp"


def manifest(**content: Any) -> Manifest:
    return Manifest("run.json", "some-run", {"task": "corridor", "count": 3, **content}, growing="count")


def claim(folder: Path, wanted: Manifest, *, finished: bool = False) -> None:
    with held(folder, wanted, is_finished=lambda: finished):
        pass


def stored(folder: Path) -> Any:
    return json.loads((folder / "run.json").read_text())


def test_a_new_folder_gets_its_manifest_and_the_versions_first(tmp_path: Path) -> None:
    with held(tmp_path / "a" / "b", manifest(), is_finished=lambda: False):
        assert stored(tmp_path / "a" / "b") == {
            "format": "some-run",
            "version": 1,
            "task": "corridor",
            "count": 3,
            "versions": versions(),
        }
    assert set(versions()) == {"python", "numpy", "scipy", "numba", "scikit-learn", "relforest"}


def test_a_held_folder_is_locked(tmp_path: Path) -> None:
    with (
        held(tmp_path, manifest(), is_finished=lambda: False),
        pytest.raises(RunFolderError, match="in use"),
    ):
        claim(tmp_path, manifest())
    claim(tmp_path, manifest())


def test_the_same_work_changes_nothing(tmp_path: Path) -> None:
    claim(tmp_path, manifest())
    before = (tmp_path / "run.json").stat()
    claim(tmp_path, manifest())
    after = (tmp_path / "run.json").stat()

    assert (after.st_ino, after.st_mtime_ns) == (before.st_ino, before.st_mtime_ns)


@pytest.mark.parametrize("left", [[], [".lock"], [TEMPORARY], [".lock", TEMPORARY]])
def test_what_an_interruption_leaves_before_the_manifest_is_no_obstacle(
    tmp_path: Path, left: list[str]
) -> None:
    for name in left:
        (tmp_path / name).touch()
    claim(tmp_path, manifest())

    assert {path.name for path in tmp_path.iterdir()} == {"run.json", ".lock"}


@pytest.mark.parametrize("name", ["notes.txt", ".hidden", "metrics.jsonl", "run-00"])
def test_a_folder_with_other_things_is_refused_and_not_touched(tmp_path: Path, name: str) -> None:
    (tmp_path / name).mkdir()

    with pytest.raises(
        RunFolderError, match=f"contains '{name}' but not run.json, .*choose a new or empty folder"
    ):
        claim(tmp_path, manifest())
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "out").touch()
    with pytest.raises(RunFolderError, match="out is not a folder; choose another name"):
        claim(tmp_path / "out", manifest())


def test_other_work_is_refused_with_every_difference(tmp_path: Path) -> None:
    claim(tmp_path, manifest(seed=0, options={"alpha": 0.05}))
    before = stored(tmp_path)

    with pytest.raises(RunFolderError) as caught:
        claim(tmp_path, manifest(task="blocks", seed=1, options={"alpha": 0.1}))

    message = str(caught.value)
    assert "task ('corridor' there, 'blocks' here)" in message
    assert "seed (0 there, 1 here)" in message
    assert "options.alpha (0.05 there, 0.1 here)" in message
    assert "choose another folder" in message
    assert stored(tmp_path) == before


def test_the_growing_count_may_rise_but_not_fall(tmp_path: Path) -> None:
    claim(tmp_path, manifest(count=3))
    claim(tmp_path, manifest(count=5))
    assert stored(tmp_path)["count"] == 5

    with pytest.raises(RunFolderError, match=r"count \(5 there, 4 here\)"):
        claim(tmp_path, manifest(count=4))
    assert stored(tmp_path)["count"] == 5


def test_without_a_growing_count_every_difference_is_refused(tmp_path: Path) -> None:
    fixed = Manifest("study.json", "some-study", {"count": 3})
    claim(tmp_path, fixed)
    claim(tmp_path, fixed)
    with pytest.raises(RunFolderError, match=r"count \(3 there, 4 here\)"):
        claim(tmp_path, Manifest("study.json", "some-study", {"count": 4}))


def test_other_versions_are_refused_unless_nothing_is_left_to_compute(tmp_path: Path) -> None:
    claim(tmp_path, manifest())
    document = stored(tmp_path)
    document["versions"]["numpy"] = "1.0.0"
    (tmp_path / "run.json").write_text(json.dumps(document))

    claim(tmp_path, manifest(), finished=True)
    assert stored(tmp_path) == document
    for wanted, finished in ((manifest(), False), (manifest(count=5), True)):
        with pytest.raises(RunFolderError, match=r"versions\.numpy \('1\.0\.0' there, .*same versions"):
            claim(tmp_path, wanted, finished=finished)


def test_versions_that_an_old_folder_does_not_name_are_no_difference(tmp_path: Path) -> None:
    claim(tmp_path, manifest())
    document = stored(tmp_path)
    del document["versions"]["scikit-learn"]
    (tmp_path / "run.json").write_text(json.dumps(document))
    claim(tmp_path, manifest())

    document["versions"]["scikit-learn"] = "0.1"
    (tmp_path / "run.json").write_text(json.dumps(document))
    with pytest.raises(RunFolderError, match=r"other versions: versions\.scikit-learn \('0\.1' there"):
        claim(tmp_path, manifest())


@pytest.mark.parametrize("text", ["", "{", '{"format": "other", "version": 1}', "[]"])
def test_a_damaged_manifest_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "run.json").write_text(text)
    with pytest.raises(RunFolderError, match="restore that file or choose another folder"):
        claim(tmp_path, manifest())
    assert (tmp_path / "run.json").read_text() == text


def test_a_folder_that_somebody_fills_meanwhile_is_noticed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    enter = FolderLock.__enter__

    def slow_enter(lock: FolderLock) -> FolderLock:
        entered = enter(lock)
        (tmp_path / "foreign").touch()
        return entered

    monkeypatch.setattr(FolderLock, "__enter__", slow_enter)
    with pytest.raises(RunFolderError, match="'foreign'"):
        claim(tmp_path, manifest())


@pytest.mark.parametrize("name", ["", "runs/a\0b"])
def test_names_that_no_folder_can_have_are_refused(name: str) -> None:
    with pytest.raises(InputError, match="must not be empty or contain a null character"):
        checked_folder(name)


def test_a_folder_inside_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()

    with pytest.raises(RunFolderError, match="file is not a folder; choose another name"):
        claim(tmp_path / "file" / "deep" / "out", manifest())


def test_work_begins_only_where_its_results_can_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(RunFolderError, match=f"cannot write to the folder {tmp_path}: choose another"):
        claim(tmp_path / "a" / "out", manifest())
    # What is finished may be looked at.
    claim(tmp_path / "finished", manifest(), finished=True)

    assert {path.name for path in tmp_path.iterdir()} == {"finished"}


def test_work_does_not_begin_on_a_full_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    usage = shutil.disk_usage(tmp_path)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage._replace(free=1000))

    with pytest.raises(RunFolderError, match=r"no space is left for .*out: make room"):
        claim(tmp_path / "out", manifest())
    assert not (tmp_path / "out").exists()


def test_differences_name_nested_entries() -> None:
    there = {"episodes": 500, "settings": {"alpha": 0.05, "lspi": {"epsilon": 1.0}}, "old": 1}
    here = {"episodes": 500, "settings": {"alpha": 0.1, "lspi": {"epsilon": 2.0}}, "new": 2}
    assert differences(there, here) == [
        "settings.alpha (0.05 there, 0.1 here)",
        "settings.lspi.epsilon (1.0 there, 2.0 here)",
        "old (1 there, None here)",
        "new (None there, 2 here)",
    ]
    assert differences(there, dict(there)) == []
