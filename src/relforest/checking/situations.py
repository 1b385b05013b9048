"""Situations that must be understood, as people write them, and what was found in them."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from os import PathLike
from typing import Any, final

from relforest.support.errors import InputError
from relforest.support.files import MAX_DOCUMENT_BYTES, read_input


@final
@dataclass(frozen=True, slots=True)
class Situation:
    """Objects, and what must hold when they are there.

    Parameters
    ----------
    name : str
        What must hold, in words.
    objects : sequence of mappings
        As in the records of `relforest.Scenes.from_dicts`.
    expect : mapping of str to value
        What must hold, see `check_model` and `check_policy`; at least one thing.
    fields : mapping of str to value
        What else is known, which differs between models and policies.
    origin : str
        Where it was written down, for messages.
    """

    name: str
    objects: Sequence[Mapping[str, Any]]
    expect: Mapping[str, Any]
    fields: Mapping[str, Any]
    origin: str = ""

    @contextmanager
    def checked(self, *known: str) -> Iterator[None]:
        """Allow these fields only, and name the situation in every `InputError` of the ``with`` block."""
        try:
            _check_known(self.fields, known)
            yield
        except InputError as error:
            origin = f"{self.origin}, " if self.origin else ""
            raise InputError(f"{origin}situation {self.name!r}: {error}") from error


@final
@dataclass(frozen=True, slots=True)
class Verdict:
    """What was found in a situation.

    Parameters
    ----------
    name : str
        Of the situation.
    faults : tuple of str
        What does not hold, and why; empty if all is well.
    """

    name: str
    faults: tuple[str, ...]

    def __str__(self) -> str:
        """Return a line, and what does not hold below it."""
        lines = [f"{'FAILED' if self.faults else 'ok    '}  {self.name}"]
        lines += [line for fault in self.faults for line in fault.splitlines()]
        return "\n        ".join(lines)


def read_situations(path: str | PathLike[str]) -> tuple[Situation, ...]:
    """Read a TOML file of situations, each of them a table ``[[situation]]``.

    Raises
    ------
    InputError
        If the file is missing or no TOML, or a situation lacks its name, objects or what to expect.
    """
    data = read_input(path, max_bytes=MAX_DOCUMENT_BYTES)
    try:
        document = tomllib.loads(data.decode("utf-8"))
    except RecursionError as error:
        raise InputError(f"{path} is nested too deeply: write situations as in the documentation") from error
    except ValueError as error:
        raise InputError(f"{path} is not a TOML file: {error}") from error
    tables = document.pop("situation", None)
    if document or not isinstance(tables, list) or not tables:
        found = f", and {next(iter(document))!r} is not understood" if document else ""
        raise InputError(f"{path} must consist of tables [[situation]], at least one{found}")
    situations = tuple(_situation(number, table, str(path)) for number, table in enumerate(tables, start=1))
    names = [each.name for each in situations]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{path}: two situations are named {name!r}: give each its own name")
    return situations


def _situation(number: int, table: Any, origin: str) -> Situation:  # noqa: ANN401 - not checked yet
    where = f"{origin}, situation number {number}"
    if not isinstance(table, dict):
        raise InputError(f"{where} is {table!r:.100}: write a table [[situation]]")
    fields = dict(table)
    name, objects, expect = (fields.pop(key, None) for key in ("name", "objects", "expect"))
    if not isinstance(name, str) or not name.strip() or not name.isprintable():
        raise InputError(f"{where} needs a name that says what must hold in words, got {name!r:.100}")
    where = f"{origin}, situation {name!r}"
    if not isinstance(objects, list):
        raise InputError(f"{where} needs a list of objects, got {objects!r:.100}")
    if not isinstance(expect, dict) or not expect:
        raise InputError(f"{where} needs a table 'expect' of what must hold, got {expect!r:.100}")
    return Situation(name, objects, expect, fields, origin)


def _check_known(fields: Iterable[str], known: Sequence[str]) -> None:
    for name in fields:
        if name not in known:
            others = ", ".join(known)
            raise InputError(f"{name!r} is not understood here: write name, objects, {others} or expect")
