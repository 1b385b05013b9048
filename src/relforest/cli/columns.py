"""The meaning of table columns, and scenes and labels read from tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes import Attribute, Scenes, Schema, scene_values
from relforest.scenes.arrow import ArrowTable
from relforest.scenes.columns import listed
from relforest.scenes.dialect import ANY_DIALECT, Dialect
from relforest.scenes.frames import FrameLayout, arrays_from_frame, frame_layout
from relforest.scenes.parquet import check_unchanged, is_own, own_columns, read_own
from relforest.scenes.parquet_source import ParquetSource
from relforest.scenes.scene_stream import SceneStream, open_stream
from relforest.scenes.schema import KINDS
from relforest.scenes.table_file import TableFile
from relforest.scenes.tables import open_table
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
    """Scenes and the table columns they were read from.

    Parameters
    ----------
    scenes : Scenes
    columns : Columns
        The meaning of the columns.
    table : pyarrow.Table
        The columns that were read.
    scene_key : str
        The column that distinguishes scenes, even where two have the same id.
    """

    scenes: Scenes
    columns: Columns
    table: ArrowTable
    scene_key: str


def check_schema(origin: Path, scenes: Scenes | SceneStream, schema: Schema) -> None:
    """Check that the scenes of a file have the schema that a model was learned from, but for categories.

    Raises
    ------
    InputError
        If they have other attributes or arguments.
    """
    if not scenes.schema.resembles(schema):
        raise InputError(
            f"{origin} contains scenes with {_described(scenes.schema)}, but the model needs scenes with "
            f"{_described(schema)}: use a file that has them"
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
    """Read names separated by commas; an empty text gives none."""
    return tuple(name.strip() for name in text.split(",")) if text.strip() else ()


def read_scenes(
    path: Path,
    columns: Columns | None,
    *,
    remedy: str,
    label: str | None = None,
    dialect: Dialect = ANY_DIALECT,
) -> SceneTable:
    """Read scenes from a CSV or Parquet file.

    Parameters
    ----------
    path : path
    columns : Columns, optional
        Not needed for a Parquet file written by `Scenes.to_parquet`, which may have further columns.
    remedy : str
        What to do if ``columns`` is needed and missing, for the message.
    label : str, optional
        One more column to read, for `read_labels`.
    dialect : Dialect
        How a CSV file is written.

    Raises
    ------
    InputError
        If the file cannot be read, or its columns cannot be found or used.
    ModelFormatError
        If `Scenes.to_parquet` wrote the file and it was changed since.
    """
    file = open_table(path, dialect)
    labels = [] if label is None else [label]
    if is_own(file):
        own = _own_columns(file, columns)
        if own is not None:
            # Only the file's own numbering distinguishes scenes with the same id.
            scene_key = own_columns(file)[1][-2]
            table = file.read([scene_key, *labels])
            return SceneTable(Scenes(*read_own(file)), own, table, scene_key)
    columns = _required(columns, file, str(path), remedy)
    layout = _layout(columns)
    table = file.read([*layout.columns, *labels])
    if is_own(file):
        check_unchanged(file, table)
    return SceneTable(Scenes(*arrays_from_frame(table, layout)), columns, table, columns.scene)


def open_scenes(source: ParquetSource, columns: Columns | None, *, remedy: str) -> SceneStream:
    """Return the scenes of Parquet files, to be read in batches; see `read_scenes`."""
    if source.is_own and _own_columns(source.files[0].table, columns) is not None:
        return open_stream(source, None)
    file = source.files[0].table
    return open_stream(source, _layout(_required(columns, file, source.origin, remedy)))


def _required(columns: Columns | None, file: TableFile, origin: str, remedy: str) -> Columns:
    if columns is None:
        raise InputError(
            f"{origin} was not written by Scenes.to_parquet: {remedy} (it has {listed(file.names)})"
        )
    return columns


def _layout(columns: Columns) -> FrameLayout:
    return frame_layout(columns.scene, columns.object, dict(columns.attributes), columns.arguments)


def _as_numbers(labels: NDArray[Any], column: str) -> NDArray[Any]:
    """Return labels of another type, such as decimals, as numbers."""
    try:
        return labels.astype(np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(
            f"column {column!r} holds values that are not labels: labels are booleans, 0 and 1, -1 and "
            "+1, or two strings"
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
            f"column {column!r} has the label {classes.tolist()[0]!r} in all {len(labels)} scenes: "
            "learning needs scenes of both classes"
        )
    return labels


def _described(schema: Schema) -> str:
    attributes = ", ".join(
        f"{attribute.name} ({f'{attribute.dim}-D' if attribute.kind == 'euclidean' else attribute.kind})"
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
            "such as location=x,y, with :angle at the end for an angle in radians, :category for names"
        )
    if colon and kind not in KINDS:
        raise InputError(
            f"--attribute {text!r} has the unknown kind {kind!r}: write one of {', '.join(KINDS)}"
        )
    return Attribute(name.strip(), len(columns), kind or None), columns


def _own_columns(file: TableFile, columns: Columns | None) -> Columns | None:
    """Return the columns that `Scenes.to_parquet` wrote, or None if scenes are read from other ones."""
    try:
        schema, names = own_columns(file)
    except ModelFormatError:
        if columns is None:
            raise
        return None
    components = iter(names[2:])
    attributes = tuple(
        (attribute, tuple(next(components) for _ in range(attribute.dim))) for attribute in schema.attributes
    )
    own = Columns(names[0], names[1], attributes, tuple(names[2 + schema.width : -2]))
    return own if columns is None or columns == own or columns.scene not in file.names else None
