from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
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


FORKING_HOLDER = """
import os, sys, time
from relforest.support.locks import FolderLock
with FolderLock(sys.argv[1]):
    child = os.fork()
    if child == 0:
        if sys.argv[2] == "leaves":
            sys.exit()
        time.sleep(60)
        os._exit(0)
    if sys.argv[2] == "leaves":
        os.waitpid(child, 0)
    print(child, flush=True)
    sys.stdin.read()
"""


@contextmanager
def a_forking_process_holding(folder: Path, child_does: str) -> Iterator[tuple[subprocess.Popen[str], int]]:
    command = [sys.executable, "-W", "ignore", "-c", FORKING_HOLDER, str(folder), child_does]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        child = int(process.stdout.readline())
        try:
            yield process, child
        finally:
            process.kill()
            with suppress(ProcessLookupError):
                os.kill(child, signal.SIGKILL)


def test_a_forked_process_does_not_keep_the_lock_of_a_killed_one(tmp_path: Path) -> None:
    with a_forking_process_holding(tmp_path, "stays") as (process, child):
        with pytest.raises(RunFolderError, match=f"in use by process {process.pid}"), FolderLock(tmp_path):
            pass
        process.kill()
        process.wait()
        # The child lets go of the lock when it first runs.
        for _ in range(200):
            with suppress(RunFolderError), FolderLock(tmp_path):
                os.kill(child, 0)
                break
            time.sleep(0.05)
        else:
            pytest.fail("the lock was not released")


def test_a_forked_process_that_leaves_the_block_leaves_the_lock_alone(tmp_path: Path) -> None:
    with (
        a_forking_process_holding(tmp_path, "leaves") as (process, _),
        pytest.raises(RunFolderError, match=f"in use by process {process.pid}"),
        FolderLock(tmp_path),
    ):
        pass


@pytest.mark.parametrize("content", [b"", b"\x1b[31m", b"no number"])
def test_a_holder_without_a_number_is_another_process(tmp_path: Path, content: bytes) -> None:
    with FolderLock(tmp_path):
        (tmp_path / ".lock").write_bytes(content)
        with pytest.raises(RunFolderError, match="is in use by another process; "), FolderLock(tmp_path):
            pass


def test_a_full_disk_does_not_keep_a_folder_from_being_held(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.pwrite", fail)
    with FolderLock(tmp_path), pytest.raises(RunFolderError, match="another process"), FolderLock(tmp_path):
        pass
    with FolderLock(tmp_path):
        pass


def test_what_cannot_be_a_path_is_refused() -> None:
    with (
        pytest.raises(RunFolderError, match=r"cannot be used as a run folder .*embedded null"),
        FolderLock("a\0b"),
    ):
        pass
