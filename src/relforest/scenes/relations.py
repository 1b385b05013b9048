"""Relations by identifiers: a column that lists what each object is related to, or a table of pairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final, cast

import narwhals as nw
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from relforest.scenes.arrays import IntArray, SceneArrays, gather
from relforest.scenes.arrow import ArrowArray
from relforest.scenes.columns import Codes, Frame, arrow_column, encode, open_frame
from relforest.scenes.id_columns import id_column
from relforest.scenes.ids import plain
from relforest.scenes.lookup import ObjectIndex, index_objects, places_of
from relforest.scenes.schema import Relation, Schema, as_relation
from relforest.support.errors import InputError

Relations = Mapping[str | Relation, object]
"""Relations, or their names, and the column or the table of each."""

SEPARATOR: Final = ";"
"""Stands between the identifiers in a column of text."""


def relation_columns(relations: Relations) -> tuple[tuple[Relation, str], ...]:
    """Return those of the relations that are given by the name of a column."""
    return tuple(
        (as_relation(key), value) for key, value in _checked(relations).items() if isinstance(value, str)
    )


def relation_tables(relations: Relations) -> dict[str | Relation, object]:
    """Return those of the relations that are given by pairs."""
    return {key: value for key, value in _checked(relations).items() if not isinstance(value, str)}


def with_tables(parts: SceneArrays, relations: Relations) -> SceneArrays:
    """Return the arrays with more relations, given by pairs; see `Scenes.with_relations`."""
    if not _checked(relations):
        return parts
    added = tuple(map(as_relation, relations))
    schema = Schema(parts.schema.attributes, parts.schema.parameters, (*parts.schema.relations, *added))
    rows = gather(parts.rows, parts.starts, parts.counts)
    ids = encode(pa.array(parts.object_ids, from_pandas=True))
    owner = np.repeat(np.arange(len(parts.starts)), parts.counts)
    index = index_objects(parts.scene_ids, owner, Codes(ids.codes[rows], ids.ids))
    given = []
    for relation, table in zip(added, relations.values(), strict=True):
        scenes, *positions = _pairs_of_table(relation.name, table, index)
        given.append(np.column_stack([scenes, *(rows[each] for each in positions)]))
    return with_pairs(parts._replace(schema=schema), given)


def with_pairs(parts: SceneArrays, given: Sequence[IntArray]) -> SceneArrays:
    """Return the arrays with the pairs of the last relations of their schema, after those that they have.

    Parameters
    ----------
    parts : SceneArrays
    given : sequence of (n, 3) int64
        For each of these relations scene, first and second object row. Of a relation without direction, each
        pair in one order, or all pairs in both.

    Raises
    ------
    InputError
        If an object is related to itself, a pair is given twice in a scene, or only some pairs of a relation
        without direction are given in both orders.
    """
    relations, pairs = parts.schema.relations, [parts.pairs]
    for number, own in enumerate(given, start=len(relations) - len(given)):
        _check_different(parts, relations[number].name, own)
        found = np.unique(own[:, 1:], axis=0)
        if not relations[number].directed:
            found, n_times = np.unique(np.concatenate([found, found[:, ::-1]]), axis=0, return_counts=True)
            if len(found) and n_times.min() < n_times.max():
                once = [_name(parts, row) for row in found[n_times == 1][0]]
                name = relations[number].name
                raise InputError(
                    f"relation {name!r} names some pairs in both orders, but that of {once[0]} and {once[1]} "
                    "in one: name all pairs once, or all in both orders, or declare it as "
                    f"Relation({name!r}, directed=True)"
                )
        pairs.append(np.column_stack([np.full(len(found), number), found]))
    return parts._replace(pairs=np.concatenate(pairs))


def pairs_of_column(
    table: Frame, column: str, index: ObjectIndex, scenes: IntArray, objects: IntArray
) -> IntArray:
    """Read which objects each object is related to.

    Parameters
    ----------
    table : Frame
    column : str
        Contains lists of identifiers, or text in which they are separated by `SEPARATOR`.
    index : ObjectIndex
    scenes, objects : (n_rows,) int64
        Of each row of the table: its scene, and the position of its object in the index, -1 for none.

    Returns
    -------
    (n, 3) int64
        Scene, and positions of two objects.

    Raises
    ------
    InputError
        If something else is in the column, or an object is not in the same scene.
    """
    row, ids = _listed(table, column)
    found = index.find(scenes[row], places_of(ids, index.object_ids))
    wrong = np.flatnonzero((found < 0) | (objects[row] < 0))
    if wrong.size:
        scene = int(scenes[row[wrong[0]]])
        raise InputError(
            f"column {column!r} names {ids[int(wrong[0])].as_py()!r} in row {row[wrong[0]]}, which is not an "
            f"object of scene {plain(index.scene_ids[scene])!r} (it has {index.describe(scene)}): list the "
            f"ids of its objects, or separate them with {SEPARATOR!r}"
        )
    return np.column_stack([scenes[row], objects[row], found])


def _checked(relations: object) -> Relations:
    if not isinstance(relations, Mapping):
        raise InputError(
            "relations must map names to pairs (scene, object, object) or to a column, such as "
            f"{{'touches': [(7, 'a', 'b')]}}, got {relations!r:.100}"
        )
    return relations


def _listed(table: Frame, column: str) -> tuple[IntArray, ArrowArray]:
    """Return the rows and the identifiers of the entries of a column."""
    lists = arrow_column(table, column)
    if lists is None or not (pa.types.is_list(lists.type) or pa.types.is_large_list(lists.type)):
        texts = pc.cast(id_column(table, column), pa.large_string())
        lists = pc.split_pattern(texts, SEPARATOR)
    row = pc.list_parent_indices(lists).to_numpy(zero_copy_only=False).astype(np.int64)
    entries = pc.list_flatten(lists)
    if pa.types.is_large_string(entries.type) or pa.types.is_string(entries.type):
        entries = pc.utf8_trim_whitespace(entries)
        filled = pc.fill_null(pc.not_equal(entries, ""), fill_value=False).to_numpy(zero_copy_only=False)
        row, entries = row[filled], entries.filter(pa.array(filled))
    if not len(row):
        return row, pa.array([], pa.large_string())
    return row, id_column(open_frame(pa.table({column: entries}), [column]), column)


def _pairs_of_table(name: str, given: object, index: ObjectIndex) -> tuple[IntArray, IntArray, IntArray]:
    """Return the scene and the positions in the index of the objects of each pair."""
    if len(np.unique(index.scene_ids)) < len(index.scene_ids):
        raise InputError(
            f"the pairs of relation {name!r} name scenes by their ids, but two scenes have the same one: "
            "give them different ids"
        )
    table = _pair_table(name, given)
    if table is None:
        none = np.empty(0, dtype=np.int64)
        return none, none, none
    ids = [id_column(table, column) for column in table.columns]
    scenes = places_of(ids[0], index.scene_ids)
    unknown = np.flatnonzero(scenes < 0)
    if unknown.size:
        raise InputError(
            f"relation {name!r} names the scene {ids[0][int(unknown[0])].as_py()!r}, which does not exist: "
            "name pairs by the ids (scene, object, object)"
        )
    positions = []
    for each in ids[1:]:
        found = index.find(scenes, places_of(each, index.object_ids))
        unknown = np.flatnonzero(found < 0)
        if unknown.size:
            scene = int(scenes[unknown[0]])
            raise InputError(
                f"relation {name!r} names {each[int(unknown[0])].as_py()!r}, which is not an object of scene "
                f"{plain(index.scene_ids[scene])!r} (it has {index.describe(scene)}): name two objects of "
                "the same scene"
            )
        positions.append(found)
    return scenes, positions[0], positions[1]


def _pair_table(name: str, given: object) -> Frame | None:
    """Return a table of three columns, None if it has no rows."""
    if isinstance(given, (Sequence, np.ndarray)) and not isinstance(given, str):
        triples = [tuple(each) if isinstance(each, (Sequence, np.ndarray)) else () for each in given]
        odd = next((number for number, each in enumerate(triples) if len(each) != 3), None)
        if odd is not None:
            raise InputError(
                f"relation {name!r} has the pair {given[odd]!r:.100}: write (scene, object, object)"
            )
        columns = [[plain(value) for value in column] for column in zip(*triples, strict=True)]
        try:
            arrays = [pa.array(column) for column in columns]
        except (pa.ArrowException, OverflowError, TypeError) as error:
            raise InputError(f"the ids in the pairs of relation {name!r} mix types: {error}") from error
        given = pa.table(dict(zip(("scene", "object", "related object"), arrays, strict=False)))
    try:
        table = nw.from_native(cast("Any", given), eager_only=True)
    except (TypeError, nw.exceptions.NarwhalsError) as error:
        raise InputError(
            f"the pairs of relation {name!r} must be a list or table of (scene, object, object), got "
            f"{type(given).__name__}"
        ) from error
    if len(table) == 0:
        return None
    if len(table.columns) != 3:
        raise InputError(
            f"the table of relation {name!r} must have three columns, scene, object and object in this "
            f"order: it has {', '.join(table.columns)}"
        )
    return cast("Frame", table)


def _check_different(parts: SceneArrays, name: str, given: IntArray) -> None:
    def said(pair: IntArray) -> str:
        where = f"relation {name!r} of scene {plain(parts.scene_ids[pair[0]])!r}"
        return f"{where} names {_name(parts, pair[1])} and {_name(parts, pair[2])}"

    alone = given[given[:, 1] == given[:, 2]]
    if len(alone):
        raise InputError(f"{said(alone[0])}, the same one: name two objects")
    different, n_times = np.unique(given, axis=0, return_counts=True)
    if len(different) < len(given):
        raise InputError(f"{said(different[n_times > 1][0])} twice: name each pair once")


def _name(parts: SceneArrays, row: int) -> str:
    return f"object {plain(parts.object_ids[row])!r}"
