"""The lines of ARFF files: statements of the head, declared attributes, rows of values."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final, Literal, cast, final

from relforest.datasets.readers.fields import FieldError

Datatype = Literal["numeric", "nominal", "string", "date", "relational"]

_DATATYPES: Final = {
    "numeric": "numeric",
    "real": "numeric",
    "integer": "numeric",
    "string": "string",
    "date": "date",
    "relational": "relational",
}
_SINGLE: Final = r"'([^'\\]*(?:\\.[^'\\]*)*)'"
_DOUBLE: Final = r'"([^"\\]*(?:\\.[^"\\]*)*)"'
_STATEMENT: Final = re.compile(r"[ \t]*([^\s%]*)[ \t]*(.*)")
_DECLARATION: Final = re.compile(rf"(?:{_SINGLE}|{_DOUBLE}|([^\s'\"]\S*))[ \t]+(\S.*)")
_VALUES: Final = re.compile(rf"\{{((?:[^'\"}}%]|{_SINGLE}|{_DOUBLE})*)\}}[ \t]*(?:%.*)?")
_FIELD: Final = re.compile(rf"[ \t]*(?:{_SINGLE}|{_DOUBLE}|([^\s,'\"{{}}%]*))")
_SEPARATOR: Final = re.compile(r"[ \t]*,|[ ]*\t")
_END: Final = re.compile(r"[ \t]*(?:%.*)?$")
_SPECIAL: Final = re.compile(r"[\s'\"%{}?]")
_ESCAPE: Final = re.compile(r"\\(.)")
_CONTROLS: Final = {"n": "\n", "r": "\r", "t": "\t"}


@final
@dataclass(frozen=True, slots=True)
class Attribute:
    """A declared attribute."""

    name: str  # without quotes
    datatype: Datatype
    values: tuple[str, ...] = ()  # those of a nominal attribute, in the order of declaration
    members: tuple[Attribute, ...] = ()  # those of a relational attribute


def split_statement(line: str) -> tuple[str, str]:
    """Return the first word of a line in lower case, empty for a blank line or a comment, and the rest."""
    found = _STATEMENT.match(line)
    return (found[1].lower(), found[2]) if found else ("", "")


def parse_attribute(text: str) -> Attribute:
    """Parse the text after ``@attribute``: a name, possibly quoted, and a type.

    Raises
    ------
    FieldError
        If the declaration is invalid.
    """
    found = _DECLARATION.match(text)
    if found is None:
        raise FieldError("@attribute needs a name (in quotes if it has spaces) and a type")
    single, double, plain, datatype = found[1], found[2], found[3], found[4]
    name = plain or _unescaped(double if single is None else single)
    if datatype.startswith("{"):
        listed = _VALUES.fullmatch(datatype)
        if listed is None:
            raise FieldError(f"the values of attribute {name!r} must be enclosed in {{ and }}")
        return Attribute(name, "nominal", tuple(split_fields(listed[1])))
    word = split_statement(datatype)[0]
    if word not in _DATATYPES:
        raise FieldError(
            f"attribute {name!r} has the type {word!r}: it must be numeric, string, relational or a list of "
            "values in braces, such as {a,b}"
        )
    return Attribute(name, cast("Datatype", _DATATYPES[word]))


def split_fields(line: str) -> list[str]:
    """Return the values of a row, without quotes; none for a blank line or a comment.

    Raises
    ------
    FieldError
        If a value is missing (``?``), the row is sparse or weighted, or quotes are not closed.
    """
    if not _SPECIAL.search(line):
        return line.split(",") if line else []
    if _END.match(line):
        return []
    fields: list[str] = []
    position = 0
    while True:
        found = _FIELD.match(line, position)
        single, double, plain = found.groups() if found else (None, None, "")
        if plain == "?":
            raise FieldError("a value is missing (?): fill it in, or remove the bag or the instance")
        fields.append(_unescaped(double if single is None else single) if plain is None else plain)
        position = found.end() if found else position
        if _END.match(line, position):
            return fields
        separator = _SEPARATOR.match(line, position)
        if separator is None:
            raise FieldError(_complaint(line[position:].lstrip()))
        position = separator.end()


def _unescaped(text: str | None) -> str:
    return _ESCAPE.sub(lambda found: _CONTROLS.get(found[1], found[1]), text or "")


def _complaint(rest: str) -> str:
    if rest.startswith("{"):
        return "sparse rows and weights, in { and }, are not supported: write all values, without weights"
    if rest.startswith(("'", '"')):
        return "a quote is not closed, or is inside a value: close it, or write it as \\' or \\\""
    return f"a comma is missing before {rest[:20]!r}: values with spaces need quotes"
