"""Progress of long work: the stage that it is in, and how much of that stage is done.

Code that may take seconds calls `report`, with or without a listener. The command line and estimators with
``verbose=True`` receive the reports of a ``with`` block by `listening`. Reports never influence results.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from contextvars import ContextVar
from dataclasses import dataclass, replace
from time import monotonic
from typing import Final, TypeAlias, final

COMPILING: Final = "compiling"
"""How the name of the stage begins that is reported, once, when kernels are compiled."""
_SECONDS_BETWEEN_LINES: Final = 1.0


@final
@dataclass(frozen=True, slots=True)
class Stage:
    """A moment of long work."""

    name: str  # what is being done, such as "growing trees"
    done: int | None = None  # steps completed; None if unknown, like their total
    total: int | None = None
    within: tuple[str, ...] = ()  # the parts of the work it belongs to, such as ("run 0", "round 2")
    source: int = 0  # number of the worker process that reports; 0 is the process itself

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
    """Pass every report made during the ``with`` block to `listener`, and not to an outer one.

    It is called often, and from several threads if the work uses threads; it should return quickly and must
    not raise.

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
    """Return whether reports are received, for code with reports that are costly to make."""
    return _LISTENER.get() is not None


def report(name: str, done: int | None = None, total: int | None = None) -> None:
    """Report the stage of long work; see `Stage`."""
    listener = _LISTENER.get()
    if listener is not None:
        listener(Stage(name, done, total))


def report_stage(stage: Stage) -> None:
    """Pass on a report from elsewhere, such as another process."""
    listener = _LISTENER.get()
    if listener is not None:
        listener(stage)


def part(name: str) -> AbstractContextManager[None]:
    """Mark the reports of a ``with`` block as those of a part of the work."""
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
