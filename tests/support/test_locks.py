from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from relforest.support.errors import RunFolderError
from relforest.support.locks import FolderLock

HOLDER = """
import sys
from relforest.support.locks import FolderLock
with FolderLock(sys.argv[1]):
    print("held", flush=True)
    sys.stdin.read()
"""


@contextmanager
def another_process_holding(folder: Path) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-c", HOLDER, str(folder)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "held\n"
        try:
            yield process
        finally:
            process.kill()


def test_a_folder_held_by_another_process_is_refused_with_its_number(tmp_path: Path) -> None:
    with (
        another_process_holding(tmp_path) as process,
        pytest.raises(RunFolderError, match=rf"{tmp_path.name} is in use by process {process.pid}; "),
        FolderLock(tmp_path),
    ):
        pass


def test_a_killed_process_holds_nothing(tmp_path: Path) -> None:
    with another_process_holding(tmp_path) as process:
        process.send_signal(signal.SIGKILL)
        process.wait()

    with FolderLock(tmp_path):
        assert (tmp_path / ".lock").read_text() == f"{os.getpid()}\n"


def test_the_same_process_cannot_hold_a_folder_twice(tmp_path: Path) -> None:
    with FolderLock(tmp_path):
        with pytest.raises(RunFolderError, match=f"in use by process {os.getpid()}"), FolderLock(tmp_path):
            pass
        with pytest.raises(RunFolderError, match="in use"), FolderLock(tmp_path):
            pass


def test_a_lock_object_is_not_reentrant_but_can_be_used_again(tmp_path: Path) -> None:
    lock = FolderLock(tmp_path)
    with lock, pytest.raises(RunFolderError, match="already held by this object"), lock:
        pass
    with lock:
        assert (tmp_path / ".lock").exists()


def test_a_released_lock_leaves_no_number_behind(tmp_path: Path) -> None:
    with FolderLock(tmp_path):
        pass

    assert (tmp_path / ".lock").read_bytes() == b""


def test_an_error_inside_the_block_releases_the_lock(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), FolderLock(tmp_path):
        _ = 1 / 0

    with FolderLock(tmp_path):
        pass


def test_the_folder_is_made(tmp_path: Path) -> None:
    with FolderLock(tmp_path / "runs" / "corridor"):
        assert (tmp_path / "runs" / "corridor").is_dir()


def test_a_file_in_place_of_the_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "runs").write_text("not a folder")

    with (
        pytest.raises(RunFolderError, match="runs cannot be used as a run folder"),
        FolderLock(tmp_path / "runs"),
    ):
        pass


def test_a_file_system_without_locks_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(descriptor: int, operation: int) -> None:
        del descriptor, operation
        raise OSError(37, "No locks available")

    monkeypatch.setattr("fcntl.flock", refuse)
    with (
        pytest.raises(RunFolderError, match="cannot be locked \\(No locks available\\)"),
        FolderLock(tmp_path),
    ):
        pass
