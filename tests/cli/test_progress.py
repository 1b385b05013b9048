from __future__ import annotations

import io
import time

import pytest
from rich.console import Console

from relforest.cli import progress
from relforest.cli.progress import note, working
from relforest.support.progress import Stage, report, report_stage


def test_notes_are_plain_lines_on_standard_error(capsys: pytest.CaptureFixture[str]) -> None:
    text = "[bold]no markup[/bold] " + "long " * 100
    note(text)
    printed = capsys.readouterr()

    assert printed.err.rstrip("\n") == text
    assert printed.out == ""


def test_short_work_prints_nothing_where_there_is_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    with working("learning") as show:
        report("growing trees", 1, 4)
        show(Stage("iterations", 1, 2))

    assert capsys.readouterr().err == ""


def test_long_work_prints_a_line_every_ten_seconds(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = iter([100.0, 105.0, 111.0, 112.0, 121.5])
    monkeypatch.setattr(progress, "monotonic", lambda: next(clock))
    with working("learning"):
        for done in range(4):
            report("growing trees", done, 4)

    assert capsys.readouterr().err == "growing trees: 1 of 4 (11 s)\ngrowing trees: 3 of 4 (22 s)\n"


@pytest.mark.parametrize("encoding", ["utf-8", "ascii"])
def test_a_terminal_shows_the_latest_stage_of_every_process(encoding: str) -> None:
    raw = io.BytesIO()
    stream = io.TextIOWrapper(raw, encoding=encoding)
    with working("loading", Console(file=stream, force_terminal=True, width=100)) as show:
        show(Stage("iterations", 3, 4))
        report("growing [trees]", 1, 8)
        report("growing [trees]", 2, 8)
        report_stage(Stage("testing", 5, 9, ("run 1",), source=2))
        time.sleep(0.3)
    stream.flush()
    text = raw.getvalue().decode(encoding)

    assert "iterations: 3 of 4" in text
    assert "growing [trees]: 2 of 8" in text
    assert "run 1, testing: 5 of 9" in text
    assert "0:00" in text


def test_a_terminal_that_cannot_move_its_cursor_gets_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "dumb")
    stream = io.StringIO()
    with working("loading", Console(file=stream, force_terminal=True)):
        report("growing trees", 1, 8)

    assert stream.getvalue() == ""


def test_compiling_is_announced_at_once(capsys: pytest.CaptureFixture[str]) -> None:
    with working("loading"):
        report("compiling, the first time only")

    assert capsys.readouterr().err == "compiling, the first time only\n"
