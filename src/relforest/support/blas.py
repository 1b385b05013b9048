"""Limiting BLAS to one thread, for blocks that may overlap in several threads."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, final

import scipy.linalg  # noqa: F401, its BLAS, which kernels call, must be loaded before the libraries are listed
from threadpoolctl import ThreadpoolController


@final
class _Limit:
    """The number of blocks that require the limit, and the settings to restore after the last one."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._count = 0
        self._libraries: list[Any] | None = None
        self._restored: list[tuple[Any, int]] = []

    def enter(self) -> None:
        """Set the limit, unless another block has."""
        with self._lock:
            if self._count == 0:
                if self._libraries is None:
                    # Searching for them takes longer than a small fit.
                    self._libraries = ThreadpoolController().select(user_api="blas").lib_controllers
                self._restored = [(library, library.get_num_threads()) for library in self._libraries]
                for library, n_threads in self._restored:
                    _set_threads(library, 1, n_threads)
            self._count += 1

    def leave(self) -> None:
        """Restore the numbers of threads, unless another block requires the limit."""
        with self._lock:
            self._count -= 1
            if self._count == 0:
                for library, n_threads in self._restored:
                    _set_threads(library, n_threads, 1)

    def after_fork(self) -> None:
        """Replace the lock in a child process, where its owner may not exist."""
        self._lock = threading.Lock()


def _set_threads(library: Any, n_threads: int, current: int) -> None:  # noqa: ANN401  # threadpoolctl is untyped
    if n_threads != current:
        # Recent versions of threadpoolctl let only one thread change limits, but the last block to end may be
        # in another.
        getattr(library, "_real_set_num_threads", library.set_num_threads)(n_threads)


_LIMIT = _Limit()
os.register_at_fork(after_in_child=_LIMIT.after_fork)


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Limit NumPy's and SciPy's BLAS to one thread during the ``with`` block, in the whole process.

    Blocks may overlap in one thread or several: the first one sets the limit, and the last one to end
    restores the previous numbers of threads.
    """
    _LIMIT.enter()
    try:
        yield
    finally:
        _LIMIT.leave()
