"""Work on scenes in threads that can be interrupted."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

_BATCH: Final = 200


def in_batches(
    evaluate: Callable[[int, int, NDArray[np.bool_]], None], n: int, n_jobs: int, size: int = _BATCH
) -> None:
    """Call ``evaluate(begin, end, stop)`` for parts of n scenes, each of `size`, in `n_jobs` threads.

    If the call is interrupted (Ctrl-C), ``stop[0]`` becomes true. Kernels look at it again and again, so that
    they end at once, however large the scenes are.
    """
    stop = np.zeros(1, dtype=np.bool_)
    # Even a single thread is not the calling one: while that runs a kernel, it does not see an interrupt.
    with ThreadPoolExecutor(n_jobs) as pool:
        try:
            parts = [
                pool.submit(copy_context().run, evaluate, begin, min(begin + size, n), stop)
                for begin in range(0, n, size)
            ]
            for part in parts:
                part.result()
        finally:
            # Leaving the ``with`` block waits for all threads.
            stop[0] = True
