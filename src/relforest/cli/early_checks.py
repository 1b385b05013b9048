"""Checks of options that every command shares, made before anything heavy is imported."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import fields
from difflib import get_close_matches
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

from relforest.cli.outputs import check_free
from relforest.support.errors import InputError, RelforestError
from relforest.support.options import at_least, in_range

_LEAST: Final[Mapping[str, int]] = {
    "attempts": 1,
    "episodes": 1,
    "iterations": 1,
    "max_points": 1,
    "permutations": 1,
    "runs": 1,
    "seed": 0,
    "test_episodes": 1,
    "trees": 1,
}
"""The smallest value of each option that is an integer, in whatever command."""

_READ: Final = {"model", "table"}
_WILD: Final = frozenset("*?[")


class UsageError(RelforestError):
    """The command line itself is wrong, whatever the files that it names hold."""


def check_options(options: Any, arguments: Sequence[str]) -> None:  # noqa: ANN401 - of any command
    """Check what needs no more than a look: ranges of numbers, and paths.

    The options were read from `arguments`.

    Raises
    ------
    UsageError
        If a number is out of its range or a path is empty or impossible.
    InputError
        If a file to be read is missing, or the one to be written cannot be; see `check_free`.
    """
    given = {field.name: getattr(options, field.name) for field in fields(options)}
    with naming_options(given):
        for name, value in given.items():
            if name in _LEAST and value is not None:
                at_least(name, value, _LEAST[name])
        if "alpha" in given:
            in_range("alpha", given["alpha"], 0, 1, open_low=True, open_high=True)
    if given.get("jobs", 1) < 1 and given["jobs"] != -1:
        raise UsageError(f"--jobs must be a positive integer, or -1 for all cores, got {given['jobs']}")
    paths = {name: value for name, value in given.items() if isinstance(value, Path)}
    _check_not_empty({option_name(name) for name in paths}, arguments)
    for name, path in paths.items():
        if "\0" in str(path):
            raise UsageError(f"{option_name(name)} {str(path)!r}: a path cannot contain a null character")
        if name in _READ:
            # A pattern, such as data/*.parquet, is no file; the command says if nothing matches it.
            if name != "table" or _WILD.isdisjoint(str(path)):
                _check_present(path)
        # A folder may be what is wanted; otherwise, the command refuses it.
        elif name == "out" and "force" in given and not path.is_dir():
            check_free(path, force=given["force"])


def unknown(what: str, name: str, choices: Iterable[str]) -> UsageError:
    """Return an error about a name, with the most similar of the names that exist, or all of them."""
    similar = get_close_matches(name, choices := tuple(choices), 1)
    hint = f"did you mean {similar[0]}?" if similar else f"choose one of {', '.join(choices)}"
    return UsageError(f"unknown {what} {name!r}: {hint}")


def option_name(parameter: str) -> str:
    """Return an option as it is written on the command line."""
    # "from" is a word of Python, so that its parameter ends in "_".
    return f"--{parameter.rstrip('_').replace('_', '-')}"


@contextmanager
def naming_options(parameters: Iterable[str], **renamed: str) -> Iterator[None]:
    """Turn an `InputError` about a parameter into a `UsageError` about the option that sets it.

    The parameters have options of the same name; the keywords name the options of others.
    """
    try:
        yield
    except InputError as error:
        # The parameter, perhaps said to be that of something: "max_iterations of LSPI must be ...".
        first, _, rest = re.sub(r"^(\w+) of \w+ ", r"\1 ", str(error)).partition(" ")
        name = renamed.get(first, first if first in parameters else "")
        if not name:
            raise
        raise UsageError(f"{option_name(name)} {rest}") from error


def _check_not_empty(flags: Collection[str], arguments: Sequence[str]) -> None:
    # `Path("")` is the current folder, so only the arguments themselves tell.
    empty = [flag for flag, value in pairwise(["", *arguments]) if not value]
    empty += [argument[:-1] for argument in arguments if argument.startswith("--") and argument.endswith("=")]
    for flag in empty:
        if flag.replace("_", "-") in flags:
            raise UsageError(f"{flag} is empty: give a path")
        if not flag.startswith("-"):
            raise UsageError("an argument is empty: give a path")


def _check_present(path: Path) -> None:
    try:
        path.stat()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}; check the path") from error
