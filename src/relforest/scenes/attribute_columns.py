"""Columns of attributes: numbers as they are, categories as their places in the attribute's list."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from relforest.scenes.arrays import FloatArray
from relforest.scenes.arrow import ArrowArray
from relforest.scenes.columns import Frame, Locate, arrow_column, listed
from relforest.scenes.id_columns import id_column
from relforest.scenes.number_columns import number_columns
from relforest.scenes.schema import Attribute
from relforest.support.errors import InputError

Layout = Sequence[tuple[Attribute, Sequence[str]]]


def attribute_columns(table: Frame, layout: Layout, locate: Locate) -> tuple[FloatArray, list[Attribute]]:
    """Return the values of attributes (n, total dim), NaN where undefined, and the attributes.

    A category without a list of categories gets those of its column, sorted. `locate` describes the place of
    a row in messages.

    Raises
    ------
    InputError
        If a value is not a number, is infinite, or is not a category of its attribute.
    """
    names = [name for attribute, columns in layout if attribute.kind != "category" for name in columns]
    numbers = iter(number_columns(table, names, locate).T if names else ())
    attributes, columns = [], []
    for attribute, own in layout:
        if attribute.kind == "category":
            texts = _texts(table, own[0])
            attribute = closed(attribute, pc.unique(texts).drop_null().to_pylist())  # noqa: PLW2901
            columns.append(_places(texts, attribute, own[0], locate))
        else:
            columns += [next(numbers) for _ in own]
        attributes.append(attribute)
    return np.column_stack(columns), attributes


def closed(attribute: Attribute, texts: Iterable[str]) -> Attribute:
    """Return a category whose list of categories is known: its own, or these texts, sorted."""
    if attribute.kind != "category" or attribute.categories:
        return attribute
    found = list(texts)
    if not found:
        raise InputError(
            f"attribute {attribute.name!r} is undefined everywhere, so its categories are unknown: name them "
            "with Attribute(..., categories=[...])"
        )
    return attribute.with_categories(sorted(found, key=_order))


def category_text(value: object) -> str | None:
    """Return the name of a category given as text or as a whole number; None if it is anything else."""
    if isinstance(value, (bool, np.bool_)):
        return str(bool(value))
    if isinstance(value, (float, np.floating)) and value == round(value):
        return str(int(value))
    return str(value) if isinstance(value, (str, int, np.integer)) else None


def place_of(text: str, attribute: Attribute, where: str) -> int:
    """Return the place of a category in the attribute's list.

    Raises
    ------
    InputError
        If it is not in the list; the message names the place in the data.
    """
    if text not in attribute.categories:
        raise InputError(
            f"{attribute.name!r} is {text!r} in {where}, which is not one of its categories "
            f"{listed(attribute.categories)}: correct it, or leave it undefined"
        )
    return attribute.categories.index(text)


def _texts(table: Frame, name: str) -> ArrowArray:
    """Return a column of categories as text."""
    column = arrow_column(table, name)
    if column is not None and pa.types.is_boolean(column.type):
        return pc.if_else(column, pa.scalar("True", pa.large_string()), pa.scalar("False", pa.large_string()))
    return pc.cast(id_column(table, name), pa.large_string())


def _places(texts: ArrowArray, attribute: Attribute, name: str, locate: Locate) -> FloatArray:
    found = pc.index_in(texts, value_set=pa.array(attribute.categories, pa.large_string()))
    unknown = np.flatnonzero(pc.and_(pc.is_valid(texts), pc.is_null(found)).to_numpy(zero_copy_only=False))
    if unknown.size:
        row = int(unknown[0])
        place_of(texts[row].as_py(), attribute, f"column {name!r}, {locate(row)}")
    places: FloatArray = pc.cast(found, pa.float64()).to_numpy(zero_copy_only=False)
    return places


def _order(text: str) -> tuple[bool, int, str]:
    """Sort whole numbers by value, before all other texts."""
    number = text.removeprefix("-").isdecimal() and text.isascii()
    return not number, int(text) if number else 0, text
