from __future__ import annotations

import io

import pytest
from rich.console import Console

from relforest.cli.progress import iteration_bar, note, working


def test_notes_are_plain_lines_on_standard_error(capsys: pytest.CaptureFixture[str]) -> None:
    text = "[bold]no markup[/bold] " + "long " * 100
    note(text)
    printed = capsys.readouterr()

    assert printed.err.rstrip("\n") == text
    assert printed.out == ""


def test_nothing_moves_where_there_is_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    with working("learning"):
        pass
    stream = io.StringIO()
    with iteration_bar(Console(file=stream)) as bar:
        bar.advance(bar.add_task("iterations", total=2))

    assert capsys.readouterr().err == ""
    assert stream.getvalue() == ""


def test_a_terminal_shows_how_far_the_work_is() -> None:
    stream = io.StringIO()
    with iteration_bar(Console(file=stream, force_terminal=True, width=100)) as bar:
        bar.advance(bar.add_task("iterations", total=4), 3)

    assert "iterations" in stream.getvalue()
    assert "3/4" in stream.getvalue()
