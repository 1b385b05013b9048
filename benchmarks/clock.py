"""CPU time of single-threaded work."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import TypeVar

import numpy as np

Argument = TypeVar("Argument")


def median_seconds(
    work: Callable[[Argument], object], arguments: Iterable[Argument], *, calls: int = 1, warm: bool = True
) -> float:
    """Return the median CPU time of ``work(argument)`` over arguments, in seconds a call.

    Parameters
    ----------
    work : callable
        What to time. Run it inside `relforest.support.parallel.one_blas_thread`: all threads are counted.
    arguments : iterable
        Each is timed once, with ``calls`` calls in a row.
    calls : int
        Enough that a measurement lasts some hundred microseconds.
    warm : bool
        Call once with the first argument before the clock starts, so that compiling is not counted.
    """
    several = list(arguments)
    if warm:
        work(several[0])
    seconds = []
    for argument in several:
        before = time.process_time()
        for _ in range(calls):
            work(argument)
        seconds.append((time.process_time() - before) / calls)
    return float(np.median(seconds))
