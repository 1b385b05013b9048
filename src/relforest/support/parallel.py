"""Running independent tasks on several cores, with results that do not depend on the number of cores."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextvars import copy_context
from typing import Any, Literal, TypeVar, TypeVarTuple

import joblib
from joblib.parallel import LokyBackend, get_active_backend

from relforest.support.blas import one_blas_thread
from relforest.support.errors import InputError
from relforest.support.options import at_least
from relforest.support.workers import run_in_processes

__all__ = ["checked_jobs", "may_leave_machine", "one_blas_thread", "run_tasks"]

Arguments = TypeVarTuple("Arguments")
Result = TypeVar("Result")


def run_tasks(
    function: Callable[[*Arguments], Result],
    tasks: Sequence[tuple[*Arguments]],
    *,
    n_jobs: int = 1,
    prefer: Literal["threads", "processes"],
    then: Callable[[int, Result], tuple[*Arguments] | None] | None = None,
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

    then : callable, optional
        Called as ``then(number, result)`` in this process as soon as a task is done, for example to save its
        result. A task that it returns continues the work with the same number, and its result replaces the
        earlier one.

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
    results: list[Any] = [None] * len(tasks)

    def finish(number: int, result: Result) -> tuple[Any, ...] | None:
        results[number] = result
        more = None if then is None else then(number, result)
        return None if more is None else (function, *more)

    with one_blas_thread():
        left: dict[int, tuple[Any, ...]] = {number: (function, *task) for number, task in enumerate(tasks)}
        backend, _ = get_active_backend(prefer=prefer)
        client = getattr(backend, "client", None)
        if n_jobs == 1 or (len(tasks) < 2 and client is None):
            for number, first in left.items():
                call: tuple[Any, ...] | None = first
                while call is not None:
                    call = finish(number, call[0](*call[1:]))
        elif isinstance(backend, LokyBackend):
            run_in_processes(_single_threaded, list(left.values()), min(n_jobs, len(tasks)), finish)
        elif client is not None:
            _on_cluster(client, left, finish)
        else:
            while left:
                left = _round(
                    left, finish, n_jobs, prefer, shared=getattr(backend, "supports_sharedmem", False)
                )
    return results


def _on_cluster(
    client: Any,  # noqa: ANN401 - `distributed.Client`, which is optional
    calls: Mapping[int, tuple[Any, ...]],
    finish: Callable[[int, Any], tuple[Any, ...] | None],
) -> None:
    """Run calls and what continues them on a Dask cluster.

    Not by joblib, which would stay here if there is one worker only, and would continue no task before all
    are done.
    """
    from distributed import as_completed  # noqa: PLC0415 - optional

    numbers = {client.submit(_single_threaded, *call, pure=False): number for number, call in calls.items()}
    done = as_completed(numbers)
    for future in done:
        number = numbers.pop(future)
        if (more := finish(number, future.result())) is not None:
            again = client.submit(_single_threaded, *more, pure=False)
            numbers[again] = number
            done.add(again)


def _round(
    calls: Mapping[int, tuple[Any, ...]],
    finish: Callable[[int, Any], tuple[Any, ...] | None],
    n_jobs: int,
    prefer: str,
    *,
    shared: bool,
) -> dict[int, tuple[Any, ...]]:
    """Run calls by joblib, and return how their tasks continue."""
    jobs = [
        # Threads do not inherit the listener of reports, and each needs a context of its own.
        joblib.delayed(copy_context().run)(_numbered, number, *call)
        if shared
        else joblib.delayed(_numbered)(number, *call)
        for number, call in calls.items()
    ]
    parallel = joblib.Parallel(n_jobs=n_jobs, prefer=prefer, return_as="generator_unordered")
    more = {number: finish(number, result) for number, result in parallel(jobs)}
    return {number: call for number, call in sorted(more.items()) if call is not None}


def may_leave_machine() -> bool:
    """Return whether `run_tasks` hands processes to a backend that may have machines without our files."""
    backend, _ = get_active_backend(prefer="processes")
    return not (isinstance(backend, LokyBackend) or getattr(backend, "supports_sharedmem", False))


def checked_jobs(n_jobs: object) -> int:
    """Return a number of workers: a positive integer as it is, -1 as the number of cores."""
    if n_jobs == -1 and not isinstance(n_jobs, bool):
        return int(joblib.cpu_count())
    try:
        return at_least("n_jobs", n_jobs, 1)
    except InputError:
        raise InputError(f"n_jobs must be a positive integer, or -1 for all cores, got {n_jobs!r}") from None


def _numbered(number: int, *call: Any) -> tuple[int, Any]:  # noqa: ANN401 - any task
    return number, _single_threaded(*call)


def _single_threaded(function: Callable[..., Any], *task: Any) -> Any:  # noqa: ANN401 - any task
    # A worker process does not inherit the limit that its parent set.
    with one_blas_thread():
        return function(*task)
