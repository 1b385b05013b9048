"""Calls in a process of their own that may take only so much CPU time, and what they cost.

The operating system enforces the limit (``RLIMIT_CPU``), so that it ends even a solver that never comes back
to Python. It ends the whole process; the next call starts another one.
"""

from __future__ import annotations

import atexit
import math
import os
import resource
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from threading import Lock
from typing import Any, Final, final

from relforest.support.blas import one_blas_thread
from relforest.support.errors import InputError, RelforestError
from relforest.support.files import read_input
from relforest.support.workers import Worker, new_worker

_ONE_THREAD: Final = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
_STATUS: Final = "/proc/{}/status"
_PEAK: Final = "VmHWM:"


@final
class LimitedProcess:
    """A process with one thread for calls that may end it; it ends with this one at the latest.

    Threads may share it: their calls are made one after the other.
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self._name = ""
        self._worker: Worker | None = None
        self._open = ExitStack()
        atexit.register(self.close)

    def call(self, name: str, function: Callable[..., Any], *arguments: object) -> tuple[Any, int]:
        """Call a function, which sets its own limits by `cpu_limit`.

        The function is one of a module; its arguments and its result must be picklable. The process is kept
        for later calls with the same name. Return what was returned, None if a limit ended the process; and
        the largest memory that the process has had so far, 0 if unknown.

        Raises
        ------
        RelforestError
            If the function fails, or the process ends in any other way than by a limit.
        """
        with self._lock:
            return self._called(name, function, arguments)

    def _called(
        self, name: str, function: Callable[..., Any], arguments: tuple[object, ...]
    ) -> tuple[Any, int]:
        if self._worker is None or name != self._name:
            self.close()
            self._name = name
            self._worker = self._open.enter_context(new_worker(environment={**os.environ, **_ONE_THREAD}))
        process, peak = self._worker.process, 0

        def look() -> None:
            nonlocal peak
            peak = max(peak, peak_memory(process.pid))

        try:
            value, peak = self._worker.call(_measured, (function, arguments), look)
        except BaseException as error:
            self.close()
            if process.returncode == -signal.SIGXCPU:
                return None, peak
            if isinstance(error, Exception):
                notes = "\n".join(getattr(error, "__notes__", ()))
                raise RelforestError(f"{name}: {type(error).__name__}: {error}\n{notes}".rstrip()) from error
            raise
        return value, peak

    def close(self) -> None:
        """End the process, if there is one."""
        self._worker = None
        self._open.close()


@contextmanager
def cpu_limit(seconds: float) -> Iterator[None]:
    """End this process, by SIGXCPU, if the ``with`` block takes more CPU time, to the next whole second.

    Raises
    ------
    InputError
        If this machine limits the process to less.
    """
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    soft = math.ceil(cpu_seconds() + seconds)
    if hard != resource.RLIM_INFINITY and hard < soft:
        raise InputError(
            f"work may take {seconds:g} CPU seconds, but its process ends after {hard} in all: raise that "
            "limit (ulimit -t), best to unlimited"
        )
    resource.setrlimit(resource.RLIMIT_CPU, (soft, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_CPU, (hard, hard))


def cpu_seconds() -> float:
    """Return the user and system time of all threads of this process so far.

    Notes
    -----
    The clock of `time.process_time` is coarse on Linux while there is a limit, as it then only moves when the
    limit is checked.
    """
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def peak_memory(process: str | int = "self") -> int:
    """Return the largest memory that a process has had so far, in bytes; 0 if unknown.

    It is given by its number; by default, it is this process.

    Notes
    -----
    ``ru_maxrss`` of a new process may be that of its parent, so it is used only on systems without ``/proc``.
    """
    try:
        lines = read_input(_STATUS.format(process)).decode().splitlines()
    except InputError:
        if process != "self":
            return 0
        unit = 1 if sys.platform == "darwin" else 1024
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit
    # A zombie lacks this line.
    return 1024 * sum(int(line.split()[1]) for line in lines if line.startswith(_PEAK))


def _measured(function: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[Any, int]:
    signal.signal(signal.SIGXCPU, signal.SIG_DFL)
    # That signal would leave an image of the memory on disk.
    resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))
    with one_blas_thread():
        return function(*arguments), peak_memory()
