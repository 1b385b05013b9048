"""One BLAS thread for as long as any thread of the process asks for it."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, final

import scipy.linalg  # noqa: F401, its BLAS, which kernels call, must be loaded before the libraries are listed
from threadpoolctl import ThreadpoolController

__all__ = ["one_blas_thread"]


@final
class _Limit:
    """How many blocks ask for one thread, and what to restore when the last of them ends."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._count = 0
        self._libraries: list[Any] | None = None
        self._restored: list[tuple[Any, int]] = []

    def enter(self) -> None:
        """Set the limit if no other block has."""
        with self._lock:
            if self._count == 0:
                if self._libraries is None:
                    # To look for them takes longer than a small fit.
                    self._libraries = ThreadpoolController().select(user_api="blas").lib_controllers
                self._restored = [(library, library.get_num_threads()) for library in self._libraries]
                for library, n_threads in self._restored:
                    _set_threads(library, 1, n_threads)
            self._count += 1

    def leave(self) -> None:
        """Restore the numbers of threads if no other block needs the limit."""
        with self._lock:
            self._count -= 1
            if self._count == 0:
                for library, n_threads in self._restored:
                    _set_threads(library, n_threads, 1)

    def after_fork(self) -> None:
        """Free the lock in a child process, in which no thread is left that could."""
        self._lock = threading.Lock()


def _set_threads(library: Any, n_threads: int, current: int) -> None:  # noqa: ANN401  # threadpoolctl is untyped
    if n_threads != current:
        # New versions of threadpoolctl ignore every thread but the first that sets a limit, so the last to
        # leave could not lift it.
        getattr(library, "_real_set_num_threads", library.set_num_threads)(n_threads)


_LIMIT = _Limit()
os.register_at_fork(after_in_child=_LIMIT.after_fork)


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Keep NumPy's and SciPy's BLAS to one thread inside the ``with`` block, in the whole process.

    Blocks may overlap, in one thread or several: the first to begin sets the limit, and the last to end
    restores the numbers of threads that the first one found.
    """
    _LIMIT.enter()
    try:
        yield
    finally:
        _LIMIT.leave()
