from __future__ import annotations

import io
import sys
from collections.abc import Callable
from types import MappingProxyType

import pytest

from cli.command_lines import CommandLine
from relforest import __version__
from relforest.cli import app
from relforest.cli.app import COMMANDS, Command, main
from relforest.support.errors import InputError


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch) -> Callable[[BaseException], None]:
    """Return a function that makes ``relforest show`` raise an error."""
    show = COMMANDS["show"]

    def prepare(error: BaseException) -> None:
        def fail(_: object) -> int:
            raise error

        commands = MappingProxyType({**COMMANDS, "show": Command(show.options, fail, show.summary)})
        monkeypatch.setattr(app, "COMMANDS", commands)

    return prepare


def test_help_lists_every_command(run: CommandLine) -> None:
    outcome = run("--help")

    assert outcome.code == 0
    for name, command in COMMANDS.items():
        assert name in outcome.out
        assert command.summary in outcome.out


@pytest.mark.parametrize("name", list(COMMANDS))
def test_every_command_explains_all_its_options_with_an_example(run: CommandLine, name: str) -> None:
    outcome = run(name, "--help")

    assert outcome.code == 0
    assert f"For example:\n  relforest {name}" in outcome.out
    options = COMMANDS[name].options
    for field in options.__dataclass_fields__:
        assert f"\n    {field}\n        " in (options.__doc__ or ""), f"{field} is not explained"


def test_the_version_is_printed(run: CommandLine) -> None:
    assert run("--version").out == f"relforest {__version__}\n"


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ((), "Missing subcommand"),
        (("fti",), "Unrecognized options"),
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
        (FileNotFoundError(2, "No such file", "a.csv"), 1, "relforest: a.csv: No such file\n"),
        (OSError(28, "No space left on device"), 1, "relforest: No space left on device\n"),
        (OSError("strange"), 1, "relforest: strange\n"),
        (KeyboardInterrupt(), 130, "relforest: interrupted\n"),
    ],
)
def test_errors_are_one_line_on_standard_error(
    run: CommandLine, failing: Callable[[BaseException], None], error: BaseException, code: int, line: str
) -> None:
    failing(error)
    outcome = run("show", "tree.json")

    assert (outcome.code, outcome.err, outcome.out) == (code, line, "")


def test_faults_of_our_own_keep_their_traceback(failing: Callable[[BaseException], None]) -> None:
    failing(ZeroDivisionError("a bug"))

    with pytest.raises(ZeroDivisionError, match="a bug"):
        main(["show", "tree.json"])


def test_a_reader_that_stops_early_is_no_error(
    monkeypatch: pytest.MonkeyPatch, failing: Callable[[BaseException], None]
) -> None:
    failing(BrokenPipeError())
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stdout", stream)

    assert main(["show", "tree.json"]) == 141
    assert stream.closed


def test_arguments_are_those_of_the_process_by_default(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["relforest", "--version"])

    assert main() == 0
    assert capsys.readouterr().out.startswith("relforest ")
