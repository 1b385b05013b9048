"""Entry point of the command ``relforest``.

Only the command that is called is imported, and it imports what is heavy when it runs: help and errors of
usage are answered at once.
"""

from __future__ import annotations

import io
import re
import sys
import textwrap
from collections.abc import Callable, Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from importlib import import_module
from shutil import get_terminal_size
from types import MappingProxyType
from typing import Annotated, Any, Final, TextIO, Union, final

from relforest import __version__
from relforest.cli.early_checks import UsageError, check_options, unknown
from relforest.cli.streams import SafeStream, fill_closed_descriptors, short_warnings
from relforest.support.errors import RelforestError

_FAILED: Final = 1
_MISUSED: Final = 2
_INTERRUPTED: Final = 130
_BROKEN_PIPE: Final = 141
_OPTIONS: Final = ("--help", "--version")
_COLOR: Final = re.compile(r"\x1b\[[0-9;]*m")
_DESCRIPTION: Final = """Learn readable trees from scenes of objects, and policies from experience.

Start with "relforest learn corridor" (a policy for a small world) or "relforest fit --help" (a tree from a
table of your own). "relforest --version" prints the version."""

COMMANDS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "learn": "Learn a policy for a world with SMRF-RPI.",
        "play": "Play episodes of a world, and write a page that shows them.",
        "fit": "Learn a model from a table of labelled scenes.",
        "predict": "Apply a learned model to the scenes of a table.",
        "explain": "Explain a prediction, and what would turn it.",
        "check": "Check what a model or policy does in situations that you give.",
        "show": "Show a learned model in words, as a drawing, a page or code.",
        "experiment": "Run one of the studies, or list them.",
        "report": "Write a page about studies and runs.",
    }
)
"""Name of a command, and of its module and function -> one line about it."""


@final
@dataclass(frozen=True, slots=True)
class Command:
    """What a command accepts, and what it does (returning an exit code)."""

    options: type[Any]
    run: Callable[[Any], int]


def command_named(name: str) -> Command:
    """Import a command: ``fit`` and ``FitOptions`` in ``relforest.cli.fit``, for example."""
    module = import_module(f"relforest.cli.{name}")
    return Command(getattr(module, f"{name.capitalize()}Options"), getattr(module, name))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        Default: those of the process.

    Returns
    -------
    int
        0 = done; 1 = an error, described in one line on standard error; 2 = the arguments are wrong;
        130 = interrupted; 141 = the reader of standard output has gone.
    """
    fill_closed_descriptors()
    out, err = SafeStream(sys.stdout), SafeStream(sys.stderr)
    try:
        with redirect_stdout(out), redirect_stderr(err), short_warnings():
            code = _guarded(list(sys.argv[1:] if arguments is None else arguments))
            out.release()
            if out.error is not None and code == 0:
                code = _BROKEN_PIPE if isinstance(out.error, BrokenPipeError) else _FAILED
                if code == _FAILED:
                    _complain(f"cannot write to standard output: {_in_one_line(out.error)}")
            err.release()
    except KeyboardInterrupt:
        # A second one, while the first was being reported.
        return _INTERRUPTED
    return code


def _guarded(arguments: list[str]) -> int:
    """Run the command line; turn what is not a fault of our own into an exit code and a line."""
    try:
        return _run(arguments)
    except SystemExit as exit_:
        return exit_.code if isinstance(exit_.code, int) else _FAILED
    except KeyboardInterrupt:
        _complain("interrupted")
        return _INTERRUPTED
    except UsageError as error:
        _complain(_in_one_line(error))
        return _MISUSED
    except (RelforestError, OSError) as error:
        _complain(_in_one_line(error))
    except MemoryError as error:
        _complain(": ".join(filter(None, ("not enough memory", _in_one_line(error)))))
    return _FAILED


def _run(arguments: list[str]) -> int:
    name = arguments[0] if arguments else ""
    if name == "--version":
        print(f"relforest {__version__}")
        return 0
    if name in {"-h", "--help"} or name.startswith("--tyro-"):
        _parse(_all_commands(), "relforest", arguments, description=_DESCRIPTION)
    if not name:
        raise UsageError(
            f"a command is missing: choose one of {', '.join(COMMANDS)}, or see relforest --help"
        )
    if name not in COMMANDS:
        raise unknown("option" if name.startswith("-") else "command", name, [*COMMANDS, *_OPTIONS])
    command = command_named(name)
    options = _parse(command.options, f"relforest {name}", arguments[1:])
    check_options(options, arguments[1:])
    return command.run(options)


def _all_commands() -> Any:  # noqa: ANN401 - a union made when the program runs
    import tyro  # noqa: PLC0415

    commands = [
        Annotated[command_named(name).options, tyro.conf.subcommand(name, description=summary)]
        for name, summary in COMMANDS.items()
    ]
    return Union[tuple(commands)]  # noqa: UP007


def _parse(command: Any, prog: str, arguments: list[str], *, description: str | None = None) -> Any:  # noqa: ANN401
    """Read arguments into options; print help if it is asked for, with lines that fit the terminal."""
    import tyro  # noqa: PLC0415

    screen = _Screen(sys.stdout)
    config = (tyro.conf.FlagCreatePairsOff,)
    try:
        with redirect_stdout(screen):
            return tyro.cli(command, prog=prog, description=description, args=arguments, config=config)
    finally:
        width = get_terminal_size().columns
        for line in screen.getvalue().splitlines():
            print("\n".join(_wrapped(line, width)))


@final
class _Screen(io.StringIO):
    """Keeps what is written to a stream, for Tyro, which draws boxes as that stream can show them."""

    def __init__(self, stream: TextIO) -> None:
        super().__init__()
        self._stream = stream

    @property
    def encoding(self) -> str:  # type: ignore[override] # an attribute in typeshed
        """The encoding of the stream."""
        return self._stream.encoding

    def isatty(self) -> bool:
        """Return whether the stream is a terminal."""
        return self._stream.isatty()


def _wrapped(line: str, width: int) -> list[str]:
    """Break a line of prose, or the example of a command, that is too long."""
    if len(_COLOR.sub("", line)) <= width:
        return [line]
    indent = line[: len(line) - len(line.lstrip())]
    if not line.startswith("  relforest "):
        return textwrap.wrap(line, width, subsequent_indent=indent, break_on_hyphens=False)
    parts = textwrap.wrap(line, width - 2, subsequent_indent=f"{indent}    ", break_on_hyphens=False)
    return [*(f"{part} \\" for part in parts[:-1]), parts[-1]]


def _in_one_line(error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        named = error.filename or error.filename2
        return f"{named}: {error.strerror}" if named else error.strerror
    return " ".join(str(error).split())


def _complain(text: str) -> None:
    print(f"relforest: {text}", file=sys.stderr)
