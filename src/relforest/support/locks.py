"""A lock on a run folder, so that two processes never write into the same run."""

from __future__ import annotations

import fcntl
import os
from pathlib import Path
from types import TracebackType
from typing import Self, final

from relforest.support.errors import RunFolderError

_LOCK_NAME = ".lock"
_LONGEST_PID = 32


@final
class FolderLock:
    """Hold a folder for this process during a ``with`` block.

    The folder is made if it does not exist. The operating system drops the lock when the process ends,
    however it ends, so a killed run never blocks its own continuation. The file ``.lock`` stays in the
    folder; it holds the number of the process while the lock is held and is empty otherwise.

    Parameters
    ----------
    folder : path
        The folder to hold.

    Raises
    ------
    RunFolderError
        On entering the block, if a living process holds the folder or it cannot be used as one.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self._folder = Path(folder)
        self._descriptor = -1

    def __enter__(self) -> Self:
        """Take the lock at once or raise."""
        if self._descriptor >= 0:
            raise RunFolderError(f"the lock on {self._folder} is already held by this object")
        descriptor = self._open()
        try:
            self._take(descriptor)
        except BaseException:
            os.close(descriptor)
            raise
        self._descriptor = descriptor
        return self

    def __exit__(
        self,
        exception_type: type[BaseException] | None,
        exception: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Drop the lock."""
        descriptor, self._descriptor = self._descriptor, -1
        try:
            os.ftruncate(descriptor, 0)
        finally:
            os.close(descriptor)

    def _open(self) -> int:
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            return os.open(self._folder / _LOCK_NAME, os.O_RDWR | os.O_CREAT, 0o666)
        except OSError as error:
            raise RunFolderError(
                f"{self._folder} cannot be used as a run folder ({error.strerror}); choose another one"
            ) from error

    def _take(self, descriptor: int) -> None:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            owner = os.pread(descriptor, _LONGEST_PID, 0).decode("ascii", "replace").strip() or "unknown"
            raise RunFolderError(
                f"the folder {self._folder} is in use by process {owner}; "
                "wait until it has finished, stop it, or choose another folder"
            ) from None
        except OSError as error:
            raise RunFolderError(
                f"the folder {self._folder} cannot be locked ({error.strerror}); "
                "choose a folder on a file system with locks"
            ) from error
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, f"{os.getpid()}\n".encode("ascii"), 0)
