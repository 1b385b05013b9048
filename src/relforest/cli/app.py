"""Entry point of the command ``relforest``."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated, Any, Final, Union, final

import tyro

from relforest import __version__
from relforest.cli.experiment import ExperimentOptions, experiment
from relforest.cli.fit import FitOptions, fit
from relforest.cli.learn import LearnOptions, learn
from relforest.cli.play import PlayOptions, play
from relforest.cli.predict import PredictOptions, predict
from relforest.cli.show import ShowOptions, show
from relforest.support.errors import RelforestError

_INTERRUPTED: Final = 130
_BROKEN_PIPE: Final = 141
_CONFIG: Final = (tyro.conf.FlagCreatePairsOff,)
_DESCRIPTION: Final = """Learn readable trees from scenes of objects, and policies from experience.

Start with "relforest learn corridor" (a policy for a small world) or "relforest fit --help" (a tree from a
table of your own)."""


@final
@dataclass(frozen=True, slots=True)
class Command:
    """What a command accepts, what it does (returning an exit code), and one line about it."""

    options: type[Any]
    run: Callable[[Any], int]
    summary: str


COMMANDS: Final = MappingProxyType(
    {
        "learn": Command(LearnOptions, learn, "Learn a policy for a world with SMRF-RPI."),
        "play": Command(PlayOptions, play, "Play episodes of a world, and write a page that shows them."),
        "fit": Command(FitOptions, fit, "Learn a tree from a table of labelled scenes."),
        "predict": Command(PredictOptions, predict, "Apply a learned tree to the scenes of a table."),
        "show": Command(ShowOptions, show, "Show a learned tree in words and as a drawing."),
        "experiment": Command(ExperimentOptions, experiment, "Run one of the studies, or list them."),
    }
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        Default: those of the process.

    Returns
    -------
    int
        0 = done; 1 = an error, told in one line on standard error; 130 = interrupted.

    Raises
    ------
    SystemExit
        With code 2 if the arguments are not understood, with code 0 after ``--help`` and ``--version``.
    """
    try:
        code = _run(list(sys.argv[1:] if arguments is None else arguments))
        sys.stdout.flush()
    except KeyboardInterrupt:
        print("relforest: interrupted", file=sys.stderr)
        return _INTERRUPTED
    except BrokenPipeError:
        # Whoever read our output has stopped; closed, it is not flushed once more when Python exits.
        with suppress(BrokenPipeError):
            sys.stdout.close()
        return _BROKEN_PIPE
    except (RelforestError, OSError) as error:
        print(f"relforest: {_in_one_line(error)}", file=sys.stderr)
        return 1
    return code


def _run(arguments: list[str]) -> int:
    if arguments == ["--version"]:
        print(f"relforest {__version__}")
        return 0
    name = arguments[0] if arguments else ""
    if name not in COMMANDS:
        _explain(arguments)
    command = COMMANDS[name]
    options = tyro.cli(command.options, prog=f"relforest {name}", args=arguments[1:], config=_CONFIG)
    return command.run(options)


def _explain(arguments: list[str]) -> None:
    """Print help, or say what is wrong with arguments that name no command, and exit."""
    commands = [
        Annotated[command.options, tyro.conf.subcommand(name, description=command.summary)]
        for name, command in COMMANDS.items()
    ]
    choices: Any = Union[tuple(commands)]  # noqa: UP007 - made when the program runs
    tyro.cli(choices, prog="relforest", description=_DESCRIPTION, args=arguments, config=_CONFIG)


def _in_one_line(error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        named = error.filename or error.filename2
        return f"{named}: {error.strerror}" if named else error.strerror
    return " ".join(str(error).split())
