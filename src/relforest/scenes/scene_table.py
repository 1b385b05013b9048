"""Scenes read from table files of any format, together with the columns that they came from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import final

from relforest.scenes.arrow import ArrowTable
from relforest.scenes.batch import Scenes, scenes_of
from relforest.scenes.columns import listed
from relforest.scenes.dialect import ANY_DIALECT, Dialect
from relforest.scenes.frames import FrameLayout, arrays_from_frame
from relforest.scenes.parquet import check_unchanged, is_own, own_columns, read_own
from relforest.scenes.parquet_source import ParquetSource
from relforest.scenes.scene_stream import SceneStream, open_stream
from relforest.scenes.schema import Schema
from relforest.scenes.table_file import TableFile
from relforest.scenes.tables import open_table
from relforest.support.errors import InputError, ModelFormatError


@final
@dataclass(frozen=True, slots=True, eq=False)
class SceneTable:
    """Scenes and the table columns they were read from."""

    scenes: Scenes
    layout: FrameLayout
    table: ArrowTable  # the columns that were read
    scene_key: str  # the column that distinguishes scenes, even where two have the same id


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


def read_scenes(
    path: Path,
    layout: FrameLayout | None,
    *,
    remedy: str,
    label: str | None = None,
    dialect: Dialect = ANY_DIALECT,
) -> SceneTable:
    """Read scenes, and perhaps the column of their labels, from a CSV or Parquet file.

    A Parquet file written by `Scenes.to_parquet`, which may have further columns, needs no `layout`; `remedy`
    says in a message what to do if another one lacks it.

    Raises
    ------
    InputError
        If the file cannot be read, or its columns cannot be found or used.
    ModelFormatError
        If `Scenes.to_parquet` wrote the file and it was changed since.
    """
    file = open_table(path, dialect)
    labels = [] if label is None else [label]
    own = _own_layout(file, layout) if is_own(file) else None
    if own is not None:
        # Only the file's own numbering distinguishes scenes with the same id.
        scene_key = own_columns(file)[1][-2]
        table = file.read([scene_key, *labels])
        return SceneTable(scenes_of(read_own(file)), own, table, scene_key)
    layout = _required(layout, file, str(path), remedy)
    table = file.read([*layout.columns, *labels])
    if is_own(file):
        check_unchanged(file, table)
    return SceneTable(scenes_of(arrays_from_frame(table, layout)), layout, table, layout.scene)


def open_scenes(source: ParquetSource, layout: FrameLayout | None, *, remedy: str) -> SceneStream:
    """Return the scenes of Parquet files, to be read in batches; see `read_scenes`."""
    file = source.files[0]
    if source.is_own and _own_layout(file, layout) is not None:
        return open_stream(source, None)
    return open_stream(source, _required(layout, file, source.origin, remedy))


def _required(layout: FrameLayout | None, file: TableFile, origin: str, remedy: str) -> FrameLayout:
    if layout is None:
        raise InputError(
            f"{origin} was not written by Scenes.to_parquet: {remedy} (it has {listed(file.names)})"
        )
    return layout


def _described(schema: Schema) -> str:
    attributes = ", ".join(
        f"{attribute.name} ({f'{attribute.dim}-D' if attribute.kind == 'euclidean' else attribute.kind})"
        for attribute in schema.attributes
    )
    arguments = ", ".join(schema.parameters) or "(none)"
    related = "".join(f" and the relation {relation.name}" for relation in schema.relations)
    return f"the attributes {attributes} and the arguments {arguments}{related}"


def _own_layout(file: TableFile, layout: FrameLayout | None) -> FrameLayout | None:
    """Return the columns that `Scenes.to_parquet` wrote, or None if scenes are read from other ones."""
    try:
        schema, names = own_columns(file)
    except ModelFormatError:
        if layout is None:
            raise
        return None
    components = iter(names[2:])
    attributes = tuple(
        (attribute, tuple(next(components) for _ in range(attribute.dim))) for attribute in schema.attributes
    )
    arguments = tuple(names[2 + schema.width :][: schema.n_parameters])
    relations = tuple(zip(schema.relations, names[2 + schema.width + len(arguments) :], strict=False))
    own = FrameLayout(names[0], names[1], attributes, arguments, relations)
    return own if layout is None or layout == own or layout.scene not in file.names else None
