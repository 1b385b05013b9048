"""What is told on standard error while a command works: notes, spinners and bars."""

# rich is imported when there is something to say, so that --help answers at once.
# ruff: noqa: PLC0415

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress


def note(text: str, console: Console | None = None) -> None:
    """Print a line of plain text to standard error, above a bar or spinner of ``console`` if there is one."""
    from rich.console import Console

    (console or Console(stderr=True)).print(text, markup=False, highlight=False, soft_wrap=True)


@contextmanager
def working(text: str) -> Iterator[None]:
    """Show a spinner during the ``with`` block; nothing where standard error is no terminal."""
    from rich.console import Console

    with Console(stderr=True).status(text):
        yield


def iteration_bar(console: Console) -> Progress:
    """Return a bar for many steps with the time that has passed; invisible where there is no terminal."""
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        SpinnerColumn,
        TextColumn,
        TimeElapsedColumn,
    )

    return Progress(
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=console,
        transient=True,
        disable=not console.is_terminal,
    )
