"""What long work says while it runs: the stage it is in and how much of that is done.

Code that may take seconds calls `report`; it neither knows nor cares whether anyone listens. Whoever shows
progress (the command line, an estimator with ``verbose=True``) hears the reports of a ``with`` block by
`listening`. Reports never influence results.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from contextvars import ContextVar
from dataclasses import dataclass, replace
from time import monotonic
from typing import Final, TypeAlias, final

_SECONDS_BETWEEN_LINES: Final = 1.0


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
    within : tuple of str
        The parts of the work that the stage belongs to, the largest first, such as ``("run 0", "round 2")``.
    source : int
        Number of the worker process that reports; 0 is the process itself.
    """

    name: str
    done: int | None = None
    total: int | None = None
    within: tuple[str, ...] = ()
    source: int = 0

    def __str__(self) -> str:
        """Return the stage on one line."""
        name = ", ".join((*self.within, self.name))
        if self.done is None:
            return name
        return f"{name}: {self.done}" if self.total is None else f"{name}: {self.done} of {self.total}"


Listener: TypeAlias = Callable[[Stage], None]

_LISTENER: ContextVar[Listener | None] = ContextVar("relforest progress listener", default=None)


@contextmanager
def listening(listener: Listener) -> Iterator[None]:
    """Pass every report made during the ``with`` block to `listener`, and to no one else.

    Parameters
    ----------
    listener : callable
        Called with a `Stage`, often and from several threads at once where work is done in threads. It should
        return quickly and must not raise.

    Examples
    --------
    >>> with listening(lambda stage: print(stage)):
    ...     report("growing trees", 3, 10)
    growing trees: 3 of 10
    """
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


def report_stage(stage: Stage) -> None:
    """Pass on a report that was made elsewhere, such as in another process."""
    listener = _LISTENER.get()
    if listener is not None:
        listener(stage)


def part(name: str) -> AbstractContextManager[None]:
    """Say during a ``with`` block of which part of the work the reports are."""
    listener = _LISTENER.get()
    if listener is None:
        return nullcontext()
    return listening(lambda stage: listener(replace(stage, within=(name, *stage.within))))


def printed_to_stderr(verbose: bool) -> AbstractContextManager[None]:  # noqa: FBT001 - the option of estimators
    """Print the reports of a ``with`` block to standard error if `verbose`, at most one line a second."""
    if not verbose:
        return nullcontext()
    latest = -_SECONDS_BETWEEN_LINES

    def show(stage: Stage) -> None:
        nonlocal latest
        now = monotonic()
        if now - latest >= _SECONDS_BETWEEN_LINES:
            latest = now
            sys.stderr.write(f"{stage}\n")

    return listening(show)
