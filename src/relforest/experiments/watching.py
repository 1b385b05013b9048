"""Looking at what other processes have written while this one waits for them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Thread

_SECONDS = 0.3


@contextmanager
def watching(look: Callable[[], None]) -> Iterator[None]:
    """Call `look` from a thread every few tenths of a second during the ``with`` block, and once at its end.

    Parameters
    ----------
    look : callable
        Must not raise; it is never called twice at the same time.
    """
    over = Event()

    def keep_looking() -> None:
        while not over.wait(_SECONDS):
            look()

    thread = Thread(target=keep_looking, daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
        look()
