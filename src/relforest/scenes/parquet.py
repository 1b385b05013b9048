"""Scenes as Parquet files that other tools read as a long table and that come back exactly.

A row of the table is one object in one scene (or a scene without objects). Two more columns number the
scenes and the object rows, so that repeated scenes and shared objects survive; the file's metadata contain
the schema and digests.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from typing import Any, Final

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray
from pyarrow import parquet

from relforest.scenes.arrays import FloatArray, IntArray, SceneArrays, compact, occurrences
from relforest.scenes.arrow import ArrowArray, ArrowTable
from relforest.scenes.attribute_columns import attribute_columns
from relforest.scenes.columns import Codes, encode, open_frame
from relforest.scenes.digests import block_digests, document_digest, is_unchanged
from relforest.scenes.id_columns import id_column
from relforest.scenes.ids import IdArray
from relforest.scenes.lookup import bind_arguments, index_objects
from relforest.scenes.relations import pairs_of_column, with_pairs
from relforest.scenes.schema import Schema
from relforest.scenes.table_file import TableFile
from relforest.support.errors import InputError, ModelFormatError, RelforestError
from relforest.support.files import check_document, write_bytes

FORMAT: Final = "relforest-scenes"
VERSION: Final = 2
"""The newest version; scenes without relations are still written as version 1, which older releases read."""
_KEY: Final = b"relforest"
_DIGESTS: Final = "digests"


def write_table(path: str | PathLike[str], table: ArrowTable) -> None:
    """Write an arrow table as a Parquet file, whole or not at all."""
    sink = pa.BufferOutputStream()
    parquet.write_table(table, sink, compression="zstd", write_page_checksum=True)
    try:
        if not os.fspath(path):
            raise InputError("the path to write to is empty: give the name of a file")
        write_bytes(path, sink.getvalue().to_pybytes())
    except RelforestError:
        raise
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise InputError(f"cannot write to {str(path)!r}: {reason}") from error


def to_table(parts: SceneArrays) -> ArrowTable:
    """Return scenes as a long arrow table with the schema in its metadata; see `Scenes.to_parquet`.

    Raises
    ------
    InputError
        If two objects of a scene have the same id, or an argument is not an object of its scene: ids would
        be ambiguous.
    """
    parts = compact(parts)
    scenes = np.repeat(np.arange(len(parts.starts)), parts.counts)
    objects = encode(_id_array("object_ids", parts.object_ids))
    index_objects(parts.scene_ids, scenes, Codes(objects.codes[parts.rows], objects.ids))
    # A scene without objects gets a row of its own, with -1 in place of the object row.
    empty = np.flatnonzero(parts.counts == 0)
    order = np.argsort(np.concatenate([scenes, empty]), kind="stable")
    scenes = np.concatenate([scenes, empty])[order]
    rows = np.concatenate([parts.rows, np.full(len(empty), -1)])[order]
    object_ids = _id_array("object_ids", parts.object_ids)
    columns = [
        _id_array("scene_ids", parts.scene_ids).take(pa.array(scenes)),
        _take(object_ids, rows),
        *(_take(_values(parts.schema, number, column), rows) for number, column in enumerate(parts.matrix.T)),
        *(_take(object_ids, column[scenes]) for column in parts.arguments.T),
        *_related(parts, object_ids, rows >= 0),
        pa.array(scenes),
        pa.array(rows, mask=rows < 0),
    ]
    names = column_names(parts.schema)
    version = VERSION if parts.schema.relations else 1
    document = {"format": FORMAT, "version": version, "schema": parts.schema.to_dict(), "columns": names}
    return pa.table(columns, names=names).replace_schema_metadata({_KEY: json.dumps(document).encode()})


def _values(schema: Schema, number: int, column: FloatArray) -> ArrowArray:
    """Return a column of the matrix as an arrow array: numbers, or the names of categories."""
    attribute = schema.attribute_of(number)
    if attribute.kind != "category":
        return pa.array(column)
    undefined = np.isnan(column)
    places = np.where(undefined, 0, column).astype(np.int64)
    return _take(pa.array(attribute.categories, pa.large_string()), np.where(undefined, -1, places))


def _related(
    parts: SceneArrays, object_ids: ArrowArray, is_object: NDArray[np.bool_]
) -> Iterator[ArrowArray]:
    """Yield a column for each relation of compact scenes: a list of the objects that each one is related to.

    `is_object` (n_rows,) tells which rows of the table are objects rather than scenes without any.
    """
    places, _, numbers = occurrences(parts)
    for relation in range(len(parts.schema.relations)):
        own = parts.pairs[numbers, 0] == relation
        lengths = np.zeros(len(is_object), dtype=np.int64)
        lengths[is_object] = np.bincount(places[own], minlength=len(parts.rows))
        ends = np.concatenate([[0], np.cumsum(lengths)])
        ids = object_ids.take(pa.array(parts.pairs[numbers[own], 2]))
        yield pa.LargeListArray.from_arrays(pa.array(ends), ids)


def sealed(table: ArrowTable) -> ArrowTable:
    """Return a table of `to_table` with digests in its metadata, which reveal damage to a file."""
    document = json.loads(table.schema.metadata[_KEY])
    digests: dict[str, Any] = {name: block_digests(table[name]) for name in table.column_names}
    digests[""] = document_digest(document)
    return table.replace_schema_metadata({_KEY: json.dumps(document | {_DIGESTS: digests}).encode()})


def is_own(file: TableFile) -> bool:
    """Return whether a table was made by `to_table`."""
    return _KEY in file.metadata


def own_columns(file: TableFile) -> tuple[Schema, list[str]]:
    """Return the schema of a file of `to_table`, and its columns, see `column_names`.

    Raises
    ------
    ModelFormatError
        If the metadata are invalid.
    """
    document = check_document(_parsed(file), format=FORMAT, version=VERSION, origin=file.origin)
    schema = Schema.from_dict(document.get("schema"))
    names = document.get("columns")
    if names != column_names(schema) or any(file.names.count(name) != 1 for name in names):
        raise ModelFormatError(f"{file.origin} is damaged: its columns are not those of its schema")
    return schema, names


def read_own(file: TableFile) -> SceneArrays:
    """Read a table of `to_table`; the file may have other columns too.

    Raises
    ------
    ModelFormatError
        If the metadata or the numbering of scenes and objects is invalid, or a digest is wrong.
    """
    schema, names = own_columns(file)
    with _damage_named(file.origin):
        table = file.read(names)
        check_unchanged(file, table)
        if len(table) == 0:
            none = np.empty(0, dtype=np.int64)
            arguments = np.empty((0, schema.n_parameters), dtype=np.int64)
            return SceneArrays(schema, np.empty((0, schema.width)), none, none, none, arguments, none, none)
        scenes, rows = (_numbering(table.column(name)) for name in names[-2:])
        return _read_rows(table, schema, names, (scenes, rows))


def read_own_part(origin: str, table: ArrowTable, schema: Schema, names: list[str]) -> SceneArrays:
    """Read some whole scenes of a table of `to_table`, one after the other, from all its columns.

    Objects that these scenes share with others are read again with those. Raises as `read_own` does.
    """
    with _damage_named(origin):
        scenes, stored = (_numbering(table.column(name)) for name in names[-2:])
        rows = np.full(len(stored), -1)
        rows[stored >= 0] = np.unique(stored[stored >= 0], return_inverse=True)[1]
        return _read_rows(table, schema, names, (scenes - scenes[0], rows))


@contextmanager
def _damage_named(origin: str) -> Iterator[None]:
    try:
        yield
    except (InputError, pa.ArrowException) as error:
        raise ModelFormatError(f"{origin} is damaged: {error}") from error


def check_unchanged(file: TableFile, table: ArrowTable, block: int | None = None) -> None:
    """Check columns, or one block of them, from a file of `Scenes.to_parquet` against their digests.

    See `is_unchanged` for blocks.

    Raises
    ------
    ModelFormatError
        If one was changed since.
    """
    document = _parsed(file)
    digests = document.pop(_DIGESTS, None) if isinstance(document, dict) else None
    if digests is None:
        # Until it is sealed, a table has none.
        return
    known = digests if isinstance(digests, dict) else {}
    checked = [name for name in table.column_names if name in known]
    changed = [name for name in checked if not is_unchanged(table[name], known[name], block)]
    if changed or known.get("") != document_digest(document):
        what = f"column {changed[0]!r}" if changed else "its metadata"
        raise ModelFormatError(
            f"{file.origin} is damaged, or {what} was changed after Scenes.to_parquet wrote it: restore it, "
            "or drop the metadata with table.replace_schema_metadata() if the change is intended"
        )


def _read_rows(
    table: ArrowTable, schema: Schema, names: list[str], numbering: tuple[IntArray, IntArray]
) -> SceneArrays:
    frame = open_frame(table, names)
    scene_ids, objects = id_column(frame, names[0]), encode(id_column(frame, names[1]))
    scenes, rows = numbering
    is_object = objects.codes >= 0
    first = _check_numbering(scenes, rows, is_object)
    if scene_ids.null_count:
        raise InputError("a scene lacks an id")
    scene_ids = scene_ids.take(pa.array(first)).to_numpy(zero_copy_only=False)
    rows = rows[is_object]
    _, seen = np.unique(rows, return_index=True)
    counts = np.bincount(scenes[is_object], minlength=len(first))
    codes = Codes(objects.codes[is_object], objects.ids)
    index = index_objects(scene_ids, scenes[is_object], codes)
    arguments = np.full((len(first), schema.n_parameters), -1, dtype=np.int64)
    others = 2 + schema.width
    related = others + schema.n_parameters
    for column, name in enumerate(names[others:related]):
        found = bind_arguments(index, name, id_column(frame, name).take(pa.array(first)))
        arguments[:, column] = np.append(rows, -1)[found]
    columns = iter(names[2 : 2 + schema.width])
    layout = [(each, [next(columns) for _ in range(each.dim)]) for each in schema.attributes]
    matrix = attribute_columns(frame, layout, "row {}".format)[0][is_object][seen]
    starts = np.cumsum(counts) - counts
    object_ids = codes.ids[codes.codes[seen]]
    parts = SceneArrays(schema, matrix, rows, starts, counts, arguments, scene_ids, object_ids)
    position = np.where(is_object, np.cumsum(is_object) - 1, -1)
    given = []
    for name in names[related:-2]:
        found = pairs_of_column(frame, name, index, scenes, position)
        given.append(np.column_stack([found[:, 0], rows[found[:, 1:]]]))
    return with_pairs(parts, given)


def _check_numbering(scenes: IntArray, rows: IntArray, is_object: NDArray[np.bool_]) -> IntArray:
    """Return the first table row of each scene, after checking the numbering of scenes and objects."""
    steps = np.diff(scenes, prepend=-1)
    first = np.flatnonzero(steps)
    object_rows = np.unique(rows[is_object])
    alone = np.diff(first, append=len(scenes)) == 1
    in_order = (
        np.isin(steps, (0, 1)).all()
        and steps[0] == 1
        and np.array_equal(object_rows, np.arange(len(object_rows)))
        and np.array_equal(is_object, rows >= 0)
        and (is_object[first] | alone).all()
        and is_object[steps == 0].all()
    )
    if not in_order:
        raise InputError("its scenes and objects are not numbered in order")
    return first


def _numbering(column: ArrowArray) -> IntArray:
    """Return a column of whole numbers with -1 for nulls."""
    numbers: IntArray = pc.fill_null(pc.cast(column, pa.int64()), -1).to_numpy()
    return numbers


def _parsed(file: TableFile) -> Any:  # noqa: ANN401 - not checked yet
    try:
        return json.loads(file.metadata[_KEY])
    except (ValueError, RecursionError) as error:
        raise ModelFormatError(f"{file.origin} has unreadable metadata: {error}") from error


def column_names(schema: Schema) -> list[str]:
    """Return the names of ids, attributes, arguments, relations and numbering, made unique by underscores."""
    wanted = ["scene", "object"]
    for attribute in schema.attributes:
        several = [f"{attribute.name}_{component}" for component in range(attribute.dim)]
        wanted += [attribute.name] if attribute.dim == 1 else several
    names: list[str] = []
    related = [relation.name for relation in schema.relations]
    for name in (*wanted, *schema.parameters, *related, "scene_number", "object_row"):
        free = name
        while free in names:
            free += "_"
        names.append(free)
    return names


def _id_array(what: str, ids: IdArray) -> ArrowArray:
    try:
        return pa.array(ids, pa.large_string()) if ids.dtype == object else pa.array(ids)
    except UnicodeEncodeError as error:
        raise InputError(f"{what} hold {error.object!r}, which cannot be written as text") from error


def _take(values: ArrowArray, rows: IntArray) -> ArrowArray:
    """Return ``values[rows]`` as an arrow array, null where a row is -1."""
    return values.take(pa.array(rows, mask=rows < 0))
