"""Which columns of a table mean what, and scenes and labels read from tables."""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes import Attribute, Scenes, Schema, read_table, scene_values
from relforest.scenes.arrow import ArrowTable
from relforest.scenes.parquet import arrays_from_table, is_own
from relforest.scenes.schema import KINDS
from relforest.support.errors import InputError, ModelFormatError


@final
@dataclass(frozen=True, slots=True)
class Columns:
    """The columns of a long table, one row per object, that scenes are made of.

    Parameters
    ----------
    scene : str
        Scene ids.
    object : str or None
        Object ids; None = objects are numbered within their scene.
    attributes : tuple of (Attribute, columns)
        One column per component.
    arguments : tuple of str
        Ids of the objects bound to the action arguments.
    """

    scene: str
    object: str | None
    attributes: tuple[tuple[Attribute, tuple[str, ...]], ...]
    arguments: tuple[str, ...] = ()


@final
@dataclass(frozen=True, slots=True, eq=False)
class SceneTable:
    """A table and the scenes read from it.

    Parameters
    ----------
    scenes : Scenes
    columns : Columns
        Where they were.
    table : pyarrow.Table
    scene_key : str
        The column that tells the scenes apart, whether or not two of them have the same id.
    """

    scenes: Scenes
    columns: Columns
    table: ArrowTable
    scene_key: str


def check_schema(origin: Path, scenes: Scenes, schema: Schema) -> None:
    """Check that the scenes of a file are of the kind that a tree was learned from.

    Raises
    ------
    InputError
        If they have other attributes or arguments.
    """
    if scenes.schema != schema:
        raise InputError(
            f"{origin} has scenes with {_described(scenes.schema)}, but the tree is for scenes with "
            f"{_described(schema)}: give it a file with the same"
        )


def parse_attributes(texts: Sequence[str]) -> tuple[tuple[Attribute, tuple[str, ...]], ...]:
    """Read attributes written as ``location=x,y`` or ``orientation=theta:angle``.

    Raises
    ------
    InputError
        If a text has another form, or its parts do not go together.
    """
    attributes = tuple(map(_parse_attribute, texts))
    names = [attribute.name for attribute, _ in attributes]
    for name in names:
        if names.count(name) > 1:
            raise InputError(
                f"attribute {name!r} is given twice: give each attribute once, with all its columns"
            )
    return attributes


def parse_names(text: str) -> tuple[str, ...]:
    """Read names separated by commas; an empty text holds none."""
    return tuple(name.strip() for name in text.split(",")) if text.strip() else ()


def read_scenes(path: Path, columns: Columns | None, *, remedy: str) -> SceneTable:
    """Read scenes from a CSV or Parquet file.

    Parameters
    ----------
    path : path
    columns : Columns, optional
        Not needed for a Parquet file written by `Scenes.to_parquet`, which may have further columns.
    remedy : str
        What to do where they are missing and needed, for the message.

    Raises
    ------
    InputError
        If the file cannot be read, or its columns cannot be found or used.
    ModelFormatError
        If the file says that `Scenes.to_parquet` wrote it, but was changed since.
    """
    table = read_table(path)
    if is_own(table) and columns is None:
        return _read_own(path, table)
    if is_own(table) and columns is not None:
        # Only the file's own numbering can tell scenes of the same id apart.
        with suppress(ModelFormatError):
            own = _read_own(path, table)
            if own.columns == columns or columns.scene not in table.column_names:
                return own
    if columns is None:
        raise InputError(
            f"{path} was not written by Scenes.to_parquet: {remedy} (it has {listed(table.column_names)})"
        )
    scenes = Scenes.from_frame(
        table,
        scene=columns.scene,
        object=columns.object,
        attributes=dict(columns.attributes),
        arguments=columns.arguments,
    )
    return SceneTable(scenes, columns, table, columns.scene)


def _as_numbers(labels: NDArray[Any], column: str) -> NDArray[Any]:
    """Return labels of another type, such as decimals, as numbers."""
    try:
        return labels.astype(np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(
            f"column {column!r} holds values that are no labels ({error}): labels are booleans, 0 and 1, "
            "-1 and +1, or two strings"
        ) from error


def read_labels(source: SceneTable, column: str) -> NDArray[Any]:
    """Return the label of every scene, (n_scenes,): booleans, integers or strings.

    Raises
    ------
    InputError
        If the column is missing, a label is missing or differs within a scene, or the labels are not
        booleans, 0 and 1, -1 and +1, or two strings, both of them present.
    """
    labels = scene_values(source.table, column, scene=source.scene_key)
    if labels.dtype.kind == "O" and not all(isinstance(label, str) for label in labels):
        labels = _as_numbers(labels, column)
    if labels.dtype.kind == "f" and (labels == np.round(labels)).all():
        labels = labels.astype(np.int64)
    classes = np.unique(labels)
    known = labels.dtype.kind in "bO" or set(classes.tolist()) <= {0, 1} or set(classes.tolist()) <= {-1, 1}
    if not known or len(classes) > 2:
        raise InputError(
            f"column {column!r} holds the labels {listed(classes.tolist())}: labels are booleans, 0 and 1, "
            "-1 and +1, or two strings"
        )
    if len(classes) < 2:
        raise InputError(
            f"column {column!r} has the label {classes.tolist()[0]!r} in all {len(labels)} scenes: there "
            "must be scenes of both classes to learn from"
        )
    return labels


def listed(values: Sequence[object]) -> str:
    """Return the first few values, for messages."""
    shown = ", ".join(repr(value) for value in values[:8])
    return f"{shown} and {len(values) - 8} more" if len(values) > 8 else shown


def _described(schema: Schema) -> str:
    attributes = ", ".join(
        f"{attribute.name} ({'angle' if attribute.kind == 'angle' else f'{attribute.dim}-D'})"
        for attribute in schema.attributes
    )
    return f"the attributes {attributes} and the arguments {', '.join(schema.parameters) or '(none)'}"


def _parse_attribute(text: str) -> tuple[Attribute, tuple[str, ...]]:
    name, equals, rest = text.partition("=")
    names, colon, kind = rest.rpartition(":") if ":" in rest else (rest, "", "")
    columns = parse_names(names)
    if not name.strip() or not equals or not columns or not all(columns):
        raise InputError(
            f"--attribute {text!r} is not understood: write NAME=COLUMN or NAME=COLUMN,COLUMN and so on, "
            "such as location=x,y, with :angle at the end for an angle in radians"
        )
    if colon and kind not in KINDS:
        raise InputError(
            f"--attribute {text!r} has the unknown kind {kind!r}: write one of {', '.join(KINDS)}"
        )
    return Attribute(name.strip(), len(columns), kind or None), columns


def _read_own(path: Path, table: ArrowTable) -> SceneTable:
    names = _stored_names(table)
    kept = [name for name in table.column_names if name in names]
    scenes = Scenes(*arrays_from_table(table.select(kept), str(path)))
    width = 2
    attributes = []
    for attribute in scenes.schema.attributes:
        attributes.append((attribute, tuple(names[width : width + attribute.dim])))
        width += attribute.dim
    columns = Columns(names[0], names[1], tuple(attributes), tuple(names[width:-2]))
    return SceneTable(scenes, columns, table, names[-2])


def _stored_names(table: ArrowTable) -> list[str]:
    """Return the columns that `Scenes.to_parquet` wrote; all of them if it is not told, or not well."""
    try:
        names = json.loads(table.schema.metadata[b"relforest"])["columns"]
    except (ValueError, KeyError, TypeError, RecursionError):
        return list(table.column_names)
    return [name for name in names if isinstance(name, str)] if isinstance(names, list) else []
