"""Scenes from Parquet files of any size, in batches: no scene is cut in two, and memory stays flat."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain, pairwise
from os import PathLike
from typing import Any, Final, NamedTuple, TypedDict, Unpack, final, overload

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from relforest.scenes.arrays import IntArray, SceneArrays
from relforest.scenes.arrow import ArrowArray, ArrowType
from relforest.scenes.batch import Scenes, scenes_of
from relforest.scenes.columns import open_frame
from relforest.scenes.frames import (
    AttributeColumns,
    FrameLayout,
    arrays_from_frame,
    named_columns,
    stored_values,
)
from relforest.scenes.id_columns import id_column
from relforest.scenes.parquet import own_columns, read_own_part
from relforest.scenes.parquet_source import ParquetSource, Piece, open_source
from relforest.scenes.schema import Relation, Schema
from relforest.scenes.seen_ids import SeenIds
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.options import at_least
from relforest.support.progress import report

BATCH_ROWS: Final = 2**16


class SceneColumns(TypedDict, total=False):
    """The keywords of `Scenes.from_parquet`."""

    scene: str | None
    object: str | None
    attributes: AttributeColumns | None
    arguments: Sequence[str]
    relations: Mapping[str | Relation, str]


@final
@dataclass(frozen=True, slots=True, eq=False)
class SceneBatch:
    """Some successive scenes of a source."""

    scenes: Scenes
    labels: NDArray[Any] | None  # (n_scenes,) as they are stored; None if no column of labels was named
    file: int  # in which these scenes begin


class _Runs(NamedTuple):
    """A piece of a source, and the rows in it where scenes begin."""

    piece: Piece
    starts: IntArray


# What follows the last piece begins with another scene.
_END: Final = _Runs(Piece(-1, 0, pa.table({})), np.zeros(1, dtype=np.int64))


@final
@dataclass(frozen=True, slots=True, eq=False)
class SceneStream:
    """The scenes of a source; made by `open_stream`."""

    source: ParquetSource
    layout: FrameLayout | None  # the columns of the scenes; None = those that `Scenes.to_parquet` wrote
    names: tuple[str, ...]  # of those columns
    key: str  # the column that distinguishes scenes
    schema: Schema
    label: str | None  # the column of labels

    def batches(self, batch_size: int = BATCH_ROWS) -> Iterator[SceneBatch]:
        """Yield all scenes, at most about `batch_size` rows at a time; see `iter_scene_batches`."""
        names = self.names if self.label is None else (*self.names, self.label)
        for piece in self._whole_scenes(names, batch_size):
            with self._locating(piece):
                scenes = scenes_of(self._arrays(piece))
                labels = None
                if self.label is not None:
                    labels = stored_values(piece.table, self.label, scene=self.key)
            yield SceneBatch(scenes, labels, piece.file)

    def count(self) -> int:
        """Return the number of scenes, from a single column."""
        return sum(len(runs.starts) for runs in self._runs([self.key], BATCH_ROWS))

    def types(self, names: Sequence[str]) -> dict[str, ArrowType]:
        """Return the types to read columns with; see `ParquetSource.common_types`."""
        types = self.source.common_types(names)
        if self.layout is not None:
            # As text, no id depends on whether the ids of its batch exceed 64 bits.
            for name in (self.layout.scene, self.layout.object, *self.layout.arguments):
                datatype = types.get(name or "", pa.null())
                if pa.types.is_uint64(datatype) or pa.types.is_decimal(datatype):
                    types[str(name)] = pa.large_string()
        return types

    def _arrays(self, piece: Piece) -> SceneArrays:
        if self.layout is not None:
            return arrays_from_frame(piece.table, self.layout)
        return read_own_part(self._origin(piece), piece.table, self.schema, list(self.names))

    def _whole_scenes(self, names: Sequence[str], n_rows: int) -> Iterator[Piece]:
        """Yield the rows of whole scenes; those of a scene in two files are rows of the first."""
        held: list[Piece] = []  # of a scene that is not complete
        for (piece, starts), following in pairwise(chain(self._runs(names, n_rows), [_END])):
            is_complete = 0 in following.starts[:1]
            end = len(piece.table) if is_complete else int(starts[-1]) if len(starts) else 0
            if end == 0:
                held.append(piece)
                continue
            begin = 0
            if held and held[0].file != piece.file:
                begin = int(starts[0]) if len(starts) else end
                yield _joined([*held, _part(piece, 0, begin)])
                held = []
            if begin < end:
                yield _joined([*held, _part(piece, begin, end)])
            held = [] if is_complete else [_part(piece, end, len(piece.table))]

    def _runs(self, names: Sequence[str], n_rows: int) -> Iterator[_Runs]:
        """Yield all rows and where scenes begin, after a check that none comes back."""
        seen, n_read, n_scenes = SeenIds(), 0, 0
        file, last = -1, None
        for piece in self.source.pieces(self.types(names), n_rows):
            ids = self._keys(piece)
            is_same_table = self.layout is not None or file == piece.file
            starts = _changes(ids)[int(is_same_table and last == ids[0].as_py()) :]
            begun = ids.take(pa.array(starts))
            if self.layout is not None:
                again = seen.add(begun)
                if again is not None:
                    raise InputError(
                        f"scene {begun[again].as_py()!r} comes back in {self._origin(piece)} after rows of "
                        f"other scenes: sort by the scene column, {self.key!r}, so that the rows of each "
                        "scene are together"
                    )
            else:
                n_scenes = n_scenes if is_same_table else 0
                if begun.to_pylist() != list(range(n_scenes, n_scenes + len(begun))):
                    raise ModelFormatError(
                        f"{self._origin(piece)} is damaged: its scenes are not numbered in order"
                    )
                n_scenes += len(begun)
            file, last = piece.file, ids[-1].as_py()
            n_read += len(ids)
            report("rows read", n_read, self.source.n_rows)
            yield _Runs(piece, starts)

    def _keys(self, piece: Piece) -> ArrowArray:
        """Return what distinguishes scenes, row by row."""
        with self._locating(piece):
            ids = id_column(open_frame(piece.table, [self.key]), self.key)
            if ids.null_count:
                row = int(np.flatnonzero(pc.is_null(ids).to_numpy(zero_copy_only=False))[0])
                raise InputError(f"row {row} lacks a scene id (column {self.key!r})")
        return ids

    def _origin(self, piece: Piece) -> str:
        return self.source.files[piece.file].origin

    @contextmanager
    def _locating(self, piece: Piece) -> Iterator[None]:
        """Say where the rows are that an error is about."""
        try:
            yield
        except InputError as error:
            raise InputError(
                f"{error} (in {self._origin(piece)}; rows are counted from its row {piece.row})"
            ) from error


def open_stream(source: ParquetSource, layout: FrameLayout | None, label: str | None = None) -> SceneStream:
    """Check what can be checked before rows are read; see `SceneStream` for the parameters.

    Raises
    ------
    InputError
        If there are no rows, a column is missing, ambiguous, or has different types in different files, or
        categories are open.
    ModelFormatError
        If a file of `Scenes.to_parquet` has invalid metadata, or a schema other than the first one.
    """
    if source.n_rows == 0:
        raise InputError(f"{source.origin} has no rows: at least one scene is needed")
    if layout is None:
        schema, names = own_columns(source.files[0])
        for file in source.files:
            if own_columns(file) != (schema, names):
                raise InputError(
                    f"{file.origin} and {source.files[0].origin} hold scenes of different schemas: read them "
                    "one by one"
                )
        stream = SceneStream(source, None, tuple(names), names[-2], schema, label)
    else:
        relations = [relation for relation, _ in layout.relations]
        schema = Schema([attribute for attribute, _ in layout.attributes], layout.arguments, relations)
        for attribute in schema.attributes:
            if attribute.kind == "category" and not attribute.categories:
                raise InputError(
                    f"the categories of {attribute.name!r} must be known before all rows are read: name them "
                    "with Attribute(..., categories=[...])"
                )
        stream = SceneStream(source, layout, tuple(layout.columns), layout.scene, schema, label)
    stream.types([*stream.names, *([] if label is None else [label])])
    return stream


def scene_stream(
    source: str | PathLike[str], label: str | None = None, **columns: Unpack[SceneColumns]
) -> SceneStream:
    """Open a source; see `iter_scene_batches`."""
    opened = open_source(source)
    return open_stream(opened, named_columns(source, own=opened.is_own, **columns), label)


@overload
def iter_scene_batches(
    source: str | PathLike[str],
    *,
    label: None = None,
    batch_size: int = BATCH_ROWS,
    **columns: Unpack[SceneColumns],
) -> Iterator[Scenes]: ...
@overload
def iter_scene_batches(
    source: str | PathLike[str],
    *,
    label: str,
    batch_size: int = BATCH_ROWS,
    **columns: Unpack[SceneColumns],
) -> Iterator[tuple[Scenes, NDArray[Any]]]: ...
def iter_scene_batches(
    source: str | PathLike[str],
    *,
    label: str | None = None,
    batch_size: int = BATCH_ROWS,
    **columns: Unpack[SceneColumns],
) -> Iterator[Any]:
    """Read scenes from Parquet files that need not fit into memory, batch by batch.

    Parameters
    ----------
    source : path
        A Parquet file, a folder of Parquet files with the same columns, or a pattern such as
        ``"data/part-*.parquet"``. Files are read in the order of their paths. The rows of a scene must be
        together; they may begin in one file and end in the next.
    label : str, optional
        A column with one value per scene, which is returned as it is stored.
    batch_size : int
        Table rows (objects) read at a time. A batch consists of the scenes that end with them; one that goes
        on belongs to the next batch, whatever its size.
    **columns
        ``scene``, ``object``, ``attributes``, ``arguments`` and ``relations`` as for `Scenes.from_parquet`;
        none for files that `Scenes.to_parquet` wrote.

    Returns
    -------
    iterator of Scenes, or of (Scenes, (n_scenes,) array) with ``label``
        All scenes, in order. Memory is that of one batch and 8 bytes per scene so far, by which a scene that
        comes back is noticed.

    Raises
    ------
    InputError
        At once, if there are no files or rows, a file is damaged, or columns are missing or differ between
        files. During the iteration, if the rows of a scene are not together (sort by the scene column), and
        as for `Scenes.from_frame`.
    ModelFormatError
        If a file of `Scenes.to_parquet` was changed or damaged. Every batch is checked before it is returned.

    Notes
    -----
    The scenes are those of `Scenes.from_parquet`, except that unsigned 64-bit and decimal ids become text,
    and that objects which scenes of different batches share are read once for each batch. An attribute that
    is a category must come with its categories.

    Examples
    --------
    >>> for scenes in iter_scene_batches("passes/*.parquet", scene="pass", attributes={"x": "x"}):
    ...     probability = model.predict_proba(scenes)  # doctest: +SKIP
    """
    at_least("batch_size", batch_size, 1)
    stream = scene_stream(source, label, **columns)
    batches = stream.batches(batch_size)
    if label is None:
        return (batch.scenes for batch in batches)
    return ((batch.scenes, batch.labels) for batch in batches)


def _changes(ids: ArrowArray) -> IntArray:
    """Return the row 0, and the rows whose id is not that of the row before."""
    changed = pc.not_equal(ids.slice(1), ids.slice(0, len(ids) - 1)).to_numpy(zero_copy_only=False)
    return np.concatenate([[0], np.flatnonzero(changed) + 1])


def _part(piece: Piece, begin: int, end: int) -> Piece:
    return Piece(piece.file, piece.row + begin, piece.table.slice(begin, end - begin))


def _joined(pieces: Sequence[Piece]) -> Piece:
    tables = [piece.table for piece in pieces]
    return pieces[0]._replace(table=tables[0] if len(tables) == 1 else pa.concat_tables(tables))
