"""A lock on a run folder, so that two processes never write into the same run."""

from __future__ import annotations

import fcntl
import os
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Final, Self, final
from weakref import WeakSet

from relforest.support.errors import InputError, RunFolderError
from relforest.support.files import make_folder

LOCK: Final = ".lock"
_LONGEST_PID: Final = 32


@final
class FolderLock:
    """Hold a folder for this process during a ``with`` block.

    The folder is created if it does not exist. The operating system releases the lock when the process ends,
    however it ends, so a killed run never blocks its own continuation. Child processes, even forked ones, do
    not hold the lock. The file ``.lock`` stays in the folder; it contains the process id while the lock is
    held and is empty otherwise.

    Parameters
    ----------
    folder : path
        The folder to hold.

    Raises
    ------
    RunFolderError
        On entering the block, if a running process holds the folder or it cannot be used as a folder.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self._folder = Path(folder)
        self._descriptor = -1

    def __enter__(self) -> Self:
        """Acquire the lock without waiting, or raise."""
        if self._descriptor >= 0:
            raise RunFolderError(f"the lock on {self._folder} is already held by this object")
        descriptor = self._open()
        try:
            self._take(descriptor)
        except BaseException:
            os.close(descriptor)
            raise
        self._descriptor = descriptor
        _HELD.add(self)
        return self

    def __exit__(
        self,
        exception_type: type[BaseException] | None,
        exception: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Release the lock."""
        descriptor, self._descriptor = self._descriptor, -1
        # A forked process that leaves the block holds nothing.
        if descriptor >= 0:
            _HELD.discard(self)
            _note(descriptor, "")
            os.close(descriptor)

    def let_go(self) -> None:
        """Close the file in a forked process; its parent keeps the lock."""
        descriptor, self._descriptor = self._descriptor, -1
        os.close(descriptor)

    def _open(self) -> int:
        try:
            make_folder(self._folder)
            return os.open(self._folder / LOCK, os.O_RDWR | os.O_CREAT, 0o666)
        except (OSError, InputError) as error:
            reason = error.strerror if isinstance(error, OSError) else error
            raise RunFolderError(
                f"{self._folder} cannot be used as a run folder ({reason}); choose another one"
            ) from error

    def _take(self, descriptor: int) -> None:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            owner = os.pread(descriptor, _LONGEST_PID, 0).strip()
            process = f"process {owner.decode()}" if owner.isdigit() else "another process"
            raise RunFolderError(
                f"the folder {self._folder} is in use by {process}; "
                "wait until it has finished, stop it, or choose another folder"
            ) from None
        except OSError as error:
            raise RunFolderError(
                f"the folder {self._folder} cannot be locked ({error.strerror}); "
                "choose a folder on a file system with locks"
            ) from error
        _note(descriptor, f"{os.getpid()}\n")


_HELD: Final[WeakSet[FolderLock]] = WeakSet()


def _note(descriptor: int, owner: str) -> None:
    """Record who holds the lock, for messages; a full disk must not prevent locking."""
    with suppress(OSError):
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, owner.encode("ascii"), 0)


def _let_go_all() -> None:
    for lock in tuple(_HELD):
        lock.let_go()
    _HELD.clear()


# A forked process inherits open files and would keep the lock after its parent is killed.
os.register_at_fork(after_in_child=_let_go_all)
