"""What commands show on standard error while they work: notes and the stage of long work."""

# Rich is imported when something is shown, so that --help answers at once.
# ruff: noqa: PLC0415

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock
from time import monotonic
from typing import TYPE_CHECKING, Final, final

from relforest.support.progress import COMPILING, Stage, listening

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

_SECONDS_BETWEEN_LINES: Final = 10.0
_REFRESHES: Final = 8
_BAR_WIDTH: Final = 30

Show = Callable[[Stage], None]


def note(text: str, console: Console | None = None) -> None:
    """Print a line of plain text to standard error, above the live lines of `console`."""
    (console or _stderr()).print(text, markup=False, highlight=False, soft_wrap=True)


@contextmanager
def working(text: str, console: Console | None = None) -> Iterator[Show]:
    """Show the stage of the work in the ``with`` block.

    A terminal shows `text` and below it the latest report of every process, with a bar and the time in that
    stage. Otherwise, a report is printed as a line every ten seconds.

    Yields
    ------
    callable
        Replaces `text` by a stage.
    """
    console = console or _stderr()
    if not console.is_terminal or console.is_dumb_terminal:
        with listening(_Lines(console).hear):
            yield lambda _stage: None
        return
    from rich.live import Live

    board = _Board(Stage(text))
    with (
        Live(get_renderable=board.picture, console=console, refresh_per_second=_REFRESHES, transient=True),
        listening(board.hear),
    ):
        yield board.head


def _stderr() -> Console:
    from rich.console import Console

    return Console(stderr=True)


@final
class _Lines:
    """Prints a report every ten seconds, and that kernels are compiled at once."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._begin = self._latest = monotonic()
        self._lock = Lock()

    def hear(self, stage: Stage) -> None:
        now = monotonic()
        with self._lock:
            if stage.name.startswith(COMPILING):
                note(stage.name, self._console)
            elif now - self._latest >= _SECONDS_BETWEEN_LINES:
                self._latest = now
                note(f"{stage} ({now - self._begin:.0f} s)", self._console)


@final
class _Board:
    """The latest stage of every process; reports only store it, and the terminal redraws at its own rate."""

    def __init__(self, head: Stage) -> None:
        from rich.spinner import Spinner

        # ASCII, so that every encoding has it.
        self._spinner = Spinner("line")
        self._stages: dict[int, tuple[Stage, float]] = {}
        self._head, self._begin = head, monotonic()

    def head(self, stage: Stage) -> None:
        self._head = stage

    def hear(self, stage: Stage) -> None:
        before, since = self._stages.get(stage.source, (None, 0.0))
        if before is None or (before.within, before.name) != (stage.within, stage.name):
            since = monotonic()
        self._stages[stage.source] = stage, since

    def picture(self) -> RenderableType:
        from rich.progress_bar import ProgressBar
        from rich.table import Table
        from rich.text import Text

        table = Table.grid(padding=(0, 1))
        table.add_column(width=1)
        table.add_column(no_wrap=True, overflow="ellipsis")
        table.add_column(width=_BAR_WIDTH)
        table.add_column(no_wrap=True)
        now = monotonic()
        for stage, since in [(self._head, self._begin), *self._stages.copy().values()]:
            bar = ProgressBar(stage.total, stage.done or 0, width=_BAR_WIDTH) if stage.total else ""
            seconds = int(now - since)
            table.add_row(self._spinner, Text(str(stage)), bar, f"{seconds // 60}:{seconds % 60:02d}")
        return table
