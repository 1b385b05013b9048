from __future__ import annotations

import io
import sys
from collections.abc import Callable
from typing import final

import pytest

from cli.command_lines import CommandLine
from relforest import __version__
from relforest.cli.app import COMMANDS, command_named, main
from relforest.cli.early_checks import UsageError
from relforest.support.errors import InputError


@final
class Broken(io.StringIO):
    """A stream on which writing fails."""

    def __init__(self, error: BaseException) -> None:
        super().__init__()
        self._error = error

    def write(self, _: str) -> int:
        raise self._error


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch) -> Callable[[BaseException], None]:
    """Return a function that makes ``relforest play`` raise an error."""

    def prepare(error: BaseException) -> None:
        def fail(_: object) -> int:
            raise error

        monkeypatch.setattr("relforest.cli.play.play", fail)

    return prepare


def test_help_lists_every_command(run: CommandLine) -> None:
    outcome = run("--help")

    assert outcome.code == 0
    for name, summary in COMMANDS.items():
        assert name in outcome.out
        assert summary in outcome.out
    assert "--version" in outcome.out


@pytest.mark.parametrize("name", list(COMMANDS))
def test_every_command_explains_all_its_options_with_an_example(run: CommandLine, name: str) -> None:
    outcome = run(name, "--help")

    assert outcome.code == 0
    assert f"For example:\n  relforest {name}" in outcome.out
    options = command_named(name).options
    for field in options.__dataclass_fields__:
        assert f"\n    {field}\n        " in (options.__doc__ or ""), f"{field} is not explained"


def test_the_version_is_printed(run: CommandLine) -> None:
    assert run("--version").out == f"relforest {__version__}\n"


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ((), "a command is missing: choose one of learn, play, "),
        (("fti",), "unknown command 'fti': did you mean fit?"),
        (("teach",), "unknown command 'teach': choose one of learn, play, "),
        (("--seed", "3"), "unknown option '--seed': choose one of learn, "),
        (("--versoin",), "unknown option '--versoin': did you mean --version?"),
        (("fit",), "Required options"),
        (("fit", "t.csv", "--label", "y", "--out", "m.json", "--alpha", "small"), "could not convert"),
        (("learn", "corridor", "--features", "pixels"), "--features"),
    ],
)
def test_wrong_usage_is_explained_with_code_2(
    run: CommandLine, arguments: tuple[str, ...], complaint: str
) -> None:
    outcome = run(*arguments)

    assert outcome.code == 2
    assert complaint in outcome.err
    assert outcome.out == ""


@pytest.mark.parametrize(
    ("error", "code", "line"),
    [
        (InputError("not this\n  file"), 1, "relforest: not this file\n"),
        (UsageError("not so"), 2, "relforest: not so\n"),
        (FileNotFoundError(2, "No such file", "a.csv"), 1, "relforest: a.csv: No such file\n"),
        (OSError(28, "No space left on device"), 1, "relforest: No space left on device\n"),
        (OSError("strange"), 1, "relforest: strange\n"),
        (KeyboardInterrupt(), 130, "relforest: interrupted\n"),
        (
            MemoryError("Unable to allocate 9 TiB"),
            1,
            "relforest: not enough memory: Unable to allocate 9 TiB\n",
        ),
        (MemoryError(), 1, "relforest: not enough memory\n"),
        (SystemExit("a reason"), 1, ""),
    ],
)
def test_errors_are_one_line_on_standard_error(
    run: CommandLine, failing: Callable[[BaseException], None], error: BaseException, code: int, line: str
) -> None:
    failing(error)
    outcome = run("play", "arch")

    assert (outcome.code, outcome.err, outcome.out) == (code, line, "")


def test_faults_of_our_own_keep_their_traceback(failing: Callable[[BaseException], None]) -> None:
    failing(ZeroDivisionError("a bug"))

    with pytest.raises(ZeroDivisionError, match="a bug"):
        main(["play", "arch"])


@pytest.mark.parametrize(
    ("error", "code", "line"),
    [
        (BrokenPipeError(), 141, ""),
        (OSError(28, "No space left"), 1, "relforest: cannot write to standard output: No space left\n"),
    ],
)
def test_a_broken_standard_output_is_reported_after_the_work(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], error: OSError, code: int, line: str
) -> None:
    done = []

    def work(_: object) -> int:
        sys.stdout.write("result")
        done.append(True)
        return 0

    monkeypatch.setattr("relforest.cli.play.play", work)
    stream = Broken(error)
    monkeypatch.setattr(sys, "stdout", stream)

    assert main(["play", "arch"]) == code
    assert done
    assert stream.closed
    assert capsys.readouterr().err == line


def test_an_error_of_the_work_counts_more_than_a_broken_standard_output(
    monkeypatch: pytest.MonkeyPatch, failing: Callable[[BaseException], None]
) -> None:
    failing(UsageError("not so"))
    monkeypatch.setattr(sys, "stdout", Broken(OSError(28, "No space left")))

    assert main(["play", "arch"]) == 2


def test_help_fits_the_terminal(run: CommandLine, monkeypatch: pytest.MonkeyPatch) -> None:
    for columns in (60, 80, 120):
        monkeypatch.setenv("COLUMNS", str(columns))
        for name in ("", *COMMANDS):
            lines = run(*([name] if name else []), "--help").out.splitlines()
            assert max(map(len, lines)) <= columns
            assert "For example:" in lines or not name


def test_a_second_interrupt_is_heeded_too(
    monkeypatch: pytest.MonkeyPatch, failing: Callable[[BaseException], None]
) -> None:
    failing(KeyboardInterrupt())
    monkeypatch.setattr(sys, "stderr", Broken(KeyboardInterrupt()))

    assert main(["play", "arch"]) == 130


def test_arguments_are_those_of_the_process_by_default(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["relforest", "--version"])

    assert main() == 0
    assert capsys.readouterr().out.startswith("relforest ")
