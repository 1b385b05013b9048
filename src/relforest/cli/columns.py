"""Options that name the columns of a table."""

from __future__ import annotations

from collections.abc import Sequence

from relforest.scenes import Attribute, Relation
from relforest.scenes.schema import KINDS, ROLES, as_relation
from relforest.support.errors import InputError


def parse_attributes(texts: Sequence[str]) -> dict[str | Attribute, Sequence[str]]:
    """Read attributes and their columns, written as ``location=x,y`` or ``orientation=theta:angle``.

    Raises
    ------
    InputError
        If a text has another form, or its parts do not go together.
    """
    attributes: dict[str | Attribute, Sequence[str]] = {}
    names = set()
    for attribute, columns in map(_parse_attribute, texts):
        if attribute.name in names:
            raise InputError(
                f"attribute {attribute.name!r} is given twice: give each attribute once, with all its columns"
            )
        names.add(attribute.name)
        attributes[attribute] = columns
    return attributes


def parse_relations(texts: Sequence[str]) -> dict[str | Relation, str]:
    """Read relations and their columns, written as ``touches=contacts`` or ``passes to=to:directed``.

    Raises
    ------
    InputError
        If a text has another form, or a relation is given twice.
    """
    relations: dict[str | Relation, str] = {}
    for text in texts:
        name, equals, rest = (part.strip() for part in text.partition("="))
        column = rest.removesuffix(":directed").strip()
        if not name or not equals or not column:
            raise InputError(
                f"--relation {text!r} is not understood: write NAME=COLUMN, such as touches=contacts, with "
                ":directed at the end if it matters which object is named first"
            )
        if any(name == each.name for each in map(as_relation, relations)):
            raise InputError(f"relation {name!r} is given twice: give each relation once, with its column")
        relations[Relation(name, directed=column != rest)] = column
    return relations


def parse_names(text: str) -> tuple[str, ...]:
    """Read names separated by commas; an empty text gives none."""
    return tuple(name.strip() for name in text.split(",")) if text.strip() else ()


def _parse_attribute(text: str) -> tuple[Attribute, tuple[str, ...]]:
    name, equals, rest = text.partition("=")
    names, colon, meaning = rest.rpartition(":") if ":" in rest else (rest, "", "")
    columns = parse_names(names)
    if not name.strip() or not equals or not columns or not all(columns):
        raise InputError(
            f"--attribute {text!r} is not understood: write NAME=COLUMN or NAME=COLUMN,COLUMN and so on, "
            "such as location=x,y, with :angle at the end for an angle in radians, :category for names, "
            ":location for where objects are"
        )
    if colon and meaning not in (*KINDS, *ROLES):
        known = ", ".join((*KINDS, *ROLES))
        raise InputError(
            f"--attribute {text!r} has the unknown kind or role {meaning!r}: write one of {known}"
        )
    if meaning in ROLES:
        return Attribute(name.strip(), len(columns), role=meaning), columns
    return Attribute(name.strip(), len(columns), meaning or None), columns
