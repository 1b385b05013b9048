"""Running independent tasks on several cores, with results that do not depend on the number of cores."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextvars import copy_context
from typing import Literal, TypeVar, TypeVarTuple

import joblib
from joblib.parallel import LokyBackend, get_active_backend

from relforest.support.blas import one_blas_thread
from relforest.support.errors import InputError
from relforest.support.options import at_least
from relforest.support.workers import run_in_processes

__all__ = ["checked_jobs", "one_blas_thread", "run_tasks"]

Arguments = TypeVarTuple("Arguments")
Result = TypeVar("Result")


def run_tasks(
    function: Callable[[*Arguments], Result],
    tasks: Sequence[tuple[*Arguments]],
    *,
    n_jobs: int = 1,
    prefer: Literal["threads", "processes"],
) -> list[Result]:
    """Call ``function(*task)`` for every task and return the results in the order of the tasks.

    Every task runs with a single BLAS thread, whatever ``n_jobs``, so sums are taken in the same order. A
    task must draw its random numbers from its own stream (`relforest.support.rng.stream`).

    Parameters
    ----------
    function : callable
        For processes, a function of a module.
    tasks : sequence of tuple
        The positional arguments of each call.
    n_jobs : int
        How many tasks run at the same time; 1 runs them in this thread, -1 uses all cores.
    prefer : {"threads", "processes"}
        Threads suit functions that spend their time in kernels. Processes end with this one, however it ends.
        An active ``joblib.parallel_config`` with another backend, such as Dask's, overrides the choice.

    Returns
    -------
    list

    Raises
    ------
    InputError
        If ``n_jobs`` is neither -1 nor a positive integer.

    Notes
    -----
    Reports of the tasks (`relforest.support.progress`) reach the listener of the caller.
    """
    n_jobs = checked_jobs(n_jobs)
    with one_blas_thread():
        if n_jobs == 1 or len(tasks) < 2:
            return [function(*task) for task in tasks]
        calls = [(function, task) for task in tasks]
        backend, _ = get_active_backend(prefer=prefer)
        if isinstance(backend, LokyBackend):
            return run_in_processes(_single_threaded, calls, min(n_jobs, len(tasks)))
        if getattr(backend, "supports_sharedmem", False):
            # Threads do not inherit the listener of reports, and each needs a context of its own.
            jobs = [joblib.delayed(copy_context().run)(_single_threaded, *call) for call in calls]
        else:
            jobs = [joblib.delayed(_single_threaded)(*call) for call in calls]
        return list(joblib.Parallel(n_jobs=n_jobs, prefer=prefer)(jobs))


def checked_jobs(n_jobs: object) -> int:
    """Return a number of workers: a positive integer as it is, -1 as the number of cores."""
    if n_jobs == -1 and not isinstance(n_jobs, bool):
        return int(joblib.cpu_count())
    try:
        return at_least("n_jobs", n_jobs, 1)
    except InputError:
        raise InputError(f"n_jobs must be a positive integer, or -1 for all cores, got {n_jobs!r}") from None


def _single_threaded(function: Callable[[*Arguments], Result], task: tuple[*Arguments]) -> Result:
    # A worker process does not inherit the limit that its parent set.
    with one_blas_thread():
        return function(*task)
