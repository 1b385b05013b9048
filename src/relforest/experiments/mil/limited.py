"""Doing the steps of a job in a process with limited CPU time, while its memory is observed."""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from select import select
from typing import Final, final

from relforest.experiments.mil.steps import STOPPED, Job, Step
from relforest.experiments.mil.worker import PREPARATION, peak_memory
from relforest.support.errors import InputError, RelforestError
from relforest.support.progress import is_heard, report
from relforest.support.workers import start

_START: Final = (
    "import json; asked = json.loads(sys.stdin.read()); sys.path[:] = asked['path']; "
    "from relforest.experiments.mil.worker import serve; serve(asked['job'], asked['prepared'])"
)
_ONE_THREAD: Final = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
_LOOK_SECONDS: Final = 0.1
_SHOWN: Final = 4000


@final
@dataclass(frozen=True, slots=True)
class _Ended:
    """How a process ended: exit status, standard error, peak memory, whether it was prepared."""

    status: int
    errors: str
    peak_bytes: int
    was_prepared: bool


def run_job(job: Job, name: str) -> list[Step]:
    """Do what is left of a job and return all its steps.

    Parameters
    ----------
    job : Job
    name : str
        Name for messages.

    Returns
    -------
    list of Step
        In order; those missing at the end come after a step that was stopped.

    Raises
    ------
    InputError
        If this machine limits processes to less CPU time than a step may take.
    RelforestError
        If a process fails for any reason but a step that exceeds its limit.
    """
    steps = job.saved()
    if not job.is_over(steps):
        _check_limit(job, name)
    while not job.is_over(steps):
        ended = _run(job)
        steps = job.saved()
        if ended.status == -signal.SIGXCPU and not ended.was_prepared:
            raise RelforestError(
                f"{name}: the process took more than {PREPARATION:.0f} CPU seconds before its first step, "
                "to read data, compile and solve a small problem; run it again, compiled code is kept"
            )
        if ended.status == -signal.SIGXCPU:
            steps.append(Step(STOPPED, None, ended.peak_bytes))
            job.save(steps)
        elif ended.status != 0 or not job.is_over(steps):
            raise RelforestError(
                f"{name}, step {len(steps)} (of 0 to {job.n_steps - 1}): the process "
                f"{_ending(ended.status)}\n"
                f"{ended.errors[-_SHOWN:]}"
            )
    return steps


def _check_limit(job: Job, name: str) -> None:
    hard = _hard_limit()
    if hard is not None and hard < job.cpu_limit:
        raise InputError(
            f"{name}: a step may take {job.cpu_limit:g} CPU seconds, but processes started from here end "
            f"after {hard}: raise that limit (ulimit -t), best to unlimited"
        )


def _hard_limit() -> int | None:
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    return None if hard == resource.RLIM_INFINITY else hard


def _run(job: Job) -> _Ended:
    with (
        _pipe() as (news, sending),
        start(
            _START,
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            pass_fds=(sending,),
            env={**os.environ, **_ONE_THREAD},
        ) as process,
    ):
        asked = {"path": sys.path, "job": job.to_dict(), "prepared": sending}
        message: bytes | None = json.dumps(asked).encode()
        peak = 0
        while True:
            try:
                _, errors = process.communicate(message, timeout=_LOOK_SECONDS)
            except subprocess.TimeoutExpired:
                message = None
                peak = max(peak, peak_memory(process.pid))
                if is_heard():
                    report("steps", len(job.saved()), job.n_steps)
            except BaseException:
                process.kill()
                raise
            else:
                was_prepared = bool(select([news], [], [], 0)[0])
                return _Ended(process.returncode, errors.decode(errors="replace"), peak, was_prepared)


@contextmanager
def _pipe() -> Iterator[tuple[int, int]]:
    ends = os.pipe()
    try:
        yield ends
    finally:
        for end in ends:
            os.close(end)


def _ending(status: int) -> str:
    """Describe how a process ended."""
    if status == -signal.SIGKILL:
        hard = _hard_limit()
        limit = "" if hard is None else f" after {hard} CPU seconds in all (ulimit -t), or"
        return f"was killed, perhaps{limit} for lack of memory"
    if status < 0:
        return f"was ended by the signal {signal.Signals(-status).name}"
    return "ended early" if status == 0 else f"failed with exit status {status}"
