"""What long work says while it runs: the stage it is in and how much of that is done.

Code that may take seconds calls `report`; it neither knows nor cares whether anyone listens. A face of the
library (the command line, an estimator with ``verbose=True``) hears the reports of its own ``with`` block by
`listening`. Reports never influence results.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import TypeAlias, final


@final
@dataclass(frozen=True, slots=True)
class Stage:
    """A moment of long work.

    Parameters
    ----------
    name : str
        What is being done, such as ``growing trees``.
    done, total : int, optional
        Steps completed, and how many there are; None where that is unknown.
    """

    name: str
    done: int | None = None
    total: int | None = None

    def __str__(self) -> str:
        """Return the stage on one line."""
        if self.done is None:
            return self.name
        return (
            f"{self.name}: {self.done}" if self.total is None else f"{self.name}: {self.done} of {self.total}"
        )


Listener: TypeAlias = Callable[[Stage], None]

_LISTENER: ContextVar[Listener | None] = ContextVar("relforest progress listener", default=None)


@contextmanager
def listening(listener: Listener) -> Iterator[None]:
    """Pass every report made during the ``with`` block to `listener`, and to no one else."""
    token = _LISTENER.set(listener)
    try:
        yield
    finally:
        _LISTENER.reset(token)


def is_heard() -> bool:
    """Whether anyone listens, for code to which a report is costly."""
    return _LISTENER.get() is not None


def report(name: str, done: int | None = None, total: int | None = None) -> None:
    """Say which stage long work is in; see `Stage`."""
    listener = _LISTENER.get()
    if listener is not None:
        listener(Stage(name, done, total))
