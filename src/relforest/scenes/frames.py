"""Scenes from long data frames, one row per object, of any library that narwhals supports."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from types import MappingProxyType
from typing import Any, cast, final

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from relforest.scenes.arrays import FloatArray, IntArray, SceneArrays
from relforest.scenes.arrow import ArrowArray, is_numeric, is_text, to_codes
from relforest.scenes.attribute_columns import attribute_columns
from relforest.scenes.columns import Codes, Frame, Locate, arrow_column, encode, open_frame
from relforest.scenes.id_columns import id_column
from relforest.scenes.ids import plain
from relforest.scenes.label_text import parsed_labels
from relforest.scenes.lookup import bind_arguments, index_objects
from relforest.scenes.relations import Relations, pairs_of_column, relation_columns, with_pairs
from relforest.scenes.schema import Attribute, Relation, Schema
from relforest.support.errors import InputError

AttributeColumns = Mapping[str | Attribute, str | Sequence[str]]


@final
@dataclass(frozen=True, slots=True)
class FrameLayout:
    """The columns of a long table that make up scenes."""

    scene: str
    object: str | None
    attributes: tuple[tuple[Attribute, tuple[str, ...]], ...]
    arguments: tuple[str, ...] = ()
    relations: tuple[tuple[Relation, str], ...] = ()

    @property
    def columns(self) -> list[str]:
        """All columns."""
        components = [name for _, names in self.attributes for name in names]
        related = [name for _, name in self.relations]
        ids = [self.scene, *([] if self.object is None else [self.object])]
        return [*ids, *self.arguments, *related, *components]


def frame_layout(
    scene: str,
    object_column: str | None,
    attributes: AttributeColumns,
    arguments: Sequence[str],
    relations: tuple[tuple[Relation, str], ...] = (),
) -> FrameLayout:
    """Check the keywords of `Scenes.from_frame`; of the relations, those that are columns."""
    parameters = _parameter_names(arguments, object_column)
    if relations and object_column is None:
        raise InputError("relations contain object ids: name the column of object ids with object=")
    return FrameLayout(scene, object_column, _attribute_layout(attributes), parameters, relations)


def named_columns(
    origin: str | PathLike[str],
    scene: str | None = None,
    object: str | None = None,  # noqa: A002 - the keyword of `Scenes.from_parquet`
    attributes: AttributeColumns | None = None,
    arguments: Sequence[str] = (),
    relations: Relations = MappingProxyType({}),
    *,
    own: bool,
) -> FrameLayout | None:
    """Return the columns named by the keywords of `Scenes.from_parquet`, or None for a file's own.

    Raises
    ------
    InputError
        If keywords are missing that a file needs which is not `own`, written by `Scenes.to_parquet`.
    """
    columns = relation_columns(relations)
    if len(columns) < len(relations):
        raise InputError("relations of files are columns: name them, as in relations={'touches': 'contacts'}")
    if own and scene is None and object is None and attributes is None and not arguments and not columns:
        return None
    if scene is None or attributes is None:
        raise InputError(
            f"{origin} was not written by Scenes.to_parquet, or keywords were given: name its columns "
            "with scene= and attributes= (and object=, arguments=, relations=) as for from_frame"
        )
    return frame_layout(scene, object, attributes, arguments, columns)


def arrays_from_frame(frame: object, layout: FrameLayout) -> SceneArrays:
    """Read scenes from a long table; see `Scenes.from_frame`."""
    relations = [relation for relation, _ in layout.relations]
    Schema([attribute for attribute, _ in layout.attributes], layout.arguments, relations)  # names that clash
    table = open_frame(frame, layout.columns)
    scenes = _scene_codes(table, layout.scene)
    object_ids = None if layout.object is None else id_column(table, layout.object)
    matrix, attributes = attribute_columns(table, layout.attributes, _locator(scenes, object_ids))
    is_object = np.ones(len(table), dtype=np.bool_)
    if object_ids is not None:
        is_object = pc.is_valid(object_ids).to_numpy(zero_copy_only=False)
        _check_placeholders(scenes, is_object, matrix)
    # The objects of a scene together, in row order.
    order = np.argsort(scenes.codes, kind="stable")
    rows = order[is_object[order]]
    counts = np.bincount(scenes.codes[rows], minlength=len(scenes))
    starts = np.cumsum(counts) - counts
    objects = _object_codes(object_ids, rows, counts)
    index = index_objects(scenes.ids, scenes.codes[rows], objects)
    bound = [
        bind_arguments(index, parameter, _constant_values(id_column(table, parameter), scenes, parameter))
        for parameter in layout.arguments
    ]
    parts = SceneArrays(
        Schema(attributes, layout.arguments, relations),
        matrix[rows],
        np.arange(len(rows)),
        starts,
        counts,
        np.column_stack([np.empty((len(scenes), 0), dtype=np.int64), *bound]),
        scenes.ids,
        objects.ids[objects.codes],
    )
    position = np.full(len(table), -1)
    position[rows] = parts.rows
    related = [
        pairs_of_column(table, column, index, scenes.codes, position) for _, column in layout.relations
    ]
    return with_pairs(parts, related)


def scene_values(frame: object, column: str, *, scene: str) -> NDArray[Any]:
    """Return one value per scene, such as a label, from a long table.

    Parameters
    ----------
    frame : pandas, polars or pyarrow table
        One row per object, as for `Scenes.from_frame`.
    column : str
        The column of values; constant within a scene.
    scene : str
        The column of scene ids.

    Returns
    -------
    (n_scenes,) array
        In order of the scenes' first appearance, aligned with `Scenes.from_frame`. Strings become
        integers, booleans or floats if all of them are such values in their usual spelling.

    Raises
    ------
    InputError
        If a value is missing or differs within a scene, or the column mixes types.
    """
    array = stored_values(frame, column, scene=scene)
    return parsed_labels(array) if array.dtype == object else array


def stored_values(frame: object, column: str, *, scene: str) -> NDArray[Any]:
    """Return the values of `scene_values` as they are stored: strings stay strings."""
    table = open_frame(frame, [scene, column])
    scenes = _scene_codes(table, scene)
    values = arrow_column(table, column)
    if values is None or not (is_numeric(values.type) or is_text(values.type)):
        found = "mixed types" if values is None else values.type
        raise InputError(f"column {column!r} contains {found}: it must contain numbers, booleans or strings")
    chosen = _constant_values(values, scenes, column)
    missing = np.flatnonzero(pc.is_null(chosen).to_numpy(zero_copy_only=False))
    if missing.size:
        name = plain(scenes.ids[missing[0]])
        raise InputError(f"column {column!r} lacks a value in scene {name!r}: fill it in or drop the scene")
    return cast("NDArray[Any]", chosen.to_numpy(zero_copy_only=False))


def _attribute_layout(attributes: AttributeColumns) -> tuple[tuple[Attribute, tuple[str, ...]], ...]:
    """Pair each attribute with its columns."""
    if not isinstance(attributes, Mapping) or not attributes:
        raise InputError(
            "attributes must map at least one attribute to its columns, such as "
            f"{{'location': ['x', 'y']}}, got {attributes!r}"
        )
    layout = []
    for key, value in attributes.items():
        columns = (value,) if isinstance(value, str) else tuple(value or ())
        name = key.name if isinstance(key, Attribute) else key
        if not columns:
            raise InputError(f"attribute {name!r} is not mapped to a column: name one column per component")
        attribute = key if isinstance(key, Attribute) else Attribute(key, len(columns))
        if attribute.dim != len(columns):
            raise InputError(
                f"attribute {name!r} has dim {attribute.dim}, but is mapped to {len(columns)} columns"
            )
        layout.append((attribute, columns))
    return tuple(layout)


def _parameter_names(arguments: Sequence[str], object_column: str | None) -> tuple[str, ...]:
    if isinstance(arguments, str):
        raise InputError(f"arguments must be a sequence of column names, got a string: write [{arguments!r}]")
    if arguments and object_column is None:
        raise InputError("arguments contain object ids: name the column of object ids with object=")
    return tuple(arguments)


def _scene_codes(table: Frame, scene: str) -> Codes:
    scenes = encode(id_column(table, scene))
    missing = np.flatnonzero(scenes.codes < 0)
    if missing.size:
        raise InputError(
            f"row {missing[0]} lacks a scene id (column {scene!r}): every row belongs to a scene"
        )
    return scenes


def _locator(scenes: Codes, object_ids: ArrowArray | None) -> Locate:
    def locate(row: int) -> str:
        where = f"scene {plain(scenes.ids[scenes.codes[row]])!r}"
        return (
            f"row {row} ({where})" if object_ids is None else f"{where}, object {object_ids[row].as_py()!r}"
        )

    return locate


def _object_codes(object_ids: ArrowArray | None, rows: IntArray, counts: IntArray) -> Codes:
    """Return the identifiers of the objects in `rows`, scene after scene: their own, or their numbers."""
    if object_ids is None:
        within = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
        return Codes(within, np.arange(counts.max(initial=0)))
    encoded = encode(object_ids)
    return Codes(encoded.codes[rows], encoded.ids)


def _check_placeholders(scenes: Codes, is_object: NDArray[np.bool_], matrix: FloatArray) -> None:
    """Check that a row without object id, which represents an empty scene, has no values and no company."""
    sizes = np.bincount(scenes.codes, minlength=len(scenes))
    with_values = ~np.isnan(matrix).all(axis=1)
    wrong = np.flatnonzero(~is_object & (with_values | (sizes[scenes.codes] > 1)))
    if wrong.size:
        raise InputError(
            f"row {wrong[0]} of scene {plain(scenes.ids[scenes.codes[wrong[0]]])!r} lacks an object id: "
            "give the object an id (only a scene without objects is a single row without id and values)"
        )


def _constant_values(values: ArrowArray, scenes: Codes, column: str) -> ArrowArray:
    """Return the value of each scene as an arrow array, after checking that it has only one."""
    codes, _ = to_codes(values)
    _, first = np.unique(scenes.codes, return_index=True)
    differs = np.flatnonzero(codes != codes[first][scenes.codes])
    if differs.size:
        row = int(differs[0])
        scene = scenes.codes[row]
        raise InputError(
            f"column {column!r} has the values {values[int(first[scene])].as_py()!r} and "
            f"{values[row].as_py()!r} in scene {plain(scenes.ids[scene])!r}: it must be the same in all "
            "rows of a scene"
        )
    return values.take(pa.array(first))
