"""Work in threads that can be interrupted."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

_SIZE: Final = 200


def in_threads(
    work: Callable[[int, int, NDArray[np.bool_]], None], n: int, n_jobs: int, *, size: int = _SIZE
) -> None:
    """Call ``work(begin, end, stop)`` for parts of n things such as scenes, `size` each, in `n_jobs` threads.

    If the call is interrupted (Ctrl-C) or a part fails, ``stop[0]`` becomes true. Kernels and other long work
    look at it again and again, so that they end at once.
    """
    stop = np.zeros(1, dtype=np.bool_)
    # Even a single thread is not the calling one: while that runs a kernel, it does not see an interrupt.
    with ThreadPoolExecutor(n_jobs) as pool:
        try:
            parts = [
                # In the caller's context, to which reports of progress go.
                pool.submit(copy_context().run, work, begin, min(begin + size, n), stop)
                for begin in range(0, n, size)
            ]
            for part in parts:
                part.result()
        finally:
            # Leaving the ``with`` block waits for all threads.
            stop[0] = True
