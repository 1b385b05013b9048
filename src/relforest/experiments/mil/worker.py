"""The process in which the steps of a job are done, timed, and stopped when they take too long.

A limit that the operating system enforces (``RLIMIT_CPU``) ends even a solver that never comes back to
Python. It ends the whole process, so steps are saved one by one, and another process continues.
"""

from __future__ import annotations

import math
import os
import resource
import signal
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Final

from relforest.experiments.mil.steps import DONE, STOPPED, Job, Step
from relforest.support.errors import InputError
from relforest.support.files import read_input
from relforest.support.parallel import one_blas_thread

PREPARATION: Final = 600.0
"""CPU seconds for what is done once: reading data, compiling, a first small problem."""
_STATUS: Final = "/proc/{}/status"
_PEAK: Final = "VmHWM:"


def serve(document: Mapping[str, Any], prepared: int) -> None:
    """Do what is left of a job in a process started for it.

    Parameters
    ----------
    document : mapping
        `Job.to_dict`.
    prepared : int
        File descriptor of a pipe that a byte is written to when the first step is about to begin.
    """
    signal.signal(signal.SIGXCPU, signal.SIG_DFL)
    # That signal would leave an image of the memory on disk.
    resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))
    job = Job.from_dict(document)
    # Behind the limit of each step, as a hard limit cannot be raised again.
    _set_hard_limit(2 * (PREPARATION + job.n_steps * (job.cpu_limit + 1)))
    work_through(job, lambda: os.write(prepared, b"."))


def work_through(job: Job, on_prepared: Callable[[], object] = lambda: None) -> None:
    """Do what is left of a job; a step over the limit ends the process, or is recognised by its time.

    Parameters
    ----------
    job : Job
    on_prepared : callable
        Called when the preparation is over: from then on, only a step can exceed its limit.
    """
    steps = job.saved()
    with one_blas_thread():
        with cpu_limit(PREPARATION):
            task_of = job.prepare(job.asked)
        on_prepared()
        while not job.is_over(steps):
            task = task_of(len(steps))
            with cpu_limit(job.cpu_limit):
                begin = cpu_seconds()
                result = task.run()
                seconds = cpu_seconds() - begin
            # The operating system counts whole seconds.
            if seconds > job.cpu_limit:
                steps.append(Step(STOPPED, None, peak_memory()))
            else:
                values = task.judge(result)
                steps.append(Step(DONE, seconds, peak_memory(), values))
            job.save(steps)


@contextmanager
def cpu_limit(seconds: float) -> Iterator[None]:
    """End this process, by SIGXCPU, if the ``with`` block takes more CPU time, to the next whole second."""
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    soft = math.ceil(cpu_seconds() + seconds)
    if hard != resource.RLIM_INFINITY:
        soft = min(soft, hard)
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

    Parameters
    ----------
    process : str or int
        Its number; by default this process.

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


def _set_hard_limit(seconds: float) -> None:
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    wanted = math.ceil(cpu_seconds() + seconds)
    if hard == resource.RLIM_INFINITY or wanted < hard:
        resource.setrlimit(resource.RLIMIT_CPU, (wanted, wanted))
