"""`Scenes`: a columnar, immutable batch of scenes that may share their objects."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from types import EllipsisType, MappingProxyType
from typing import Any, Final, NoReturn, final

import numpy as np
from numpy.typing import ArrayLike

from relforest.scenes.arrays import FloatArray, IntArray, SceneArrays, check_arrays, compact, recoded
from relforest.scenes.derived import add_attribute
from relforest.scenes.frames import AttributeColumns, arrays_from_frame, frame_layout, named_columns
from relforest.scenes.ids import IdArray
from relforest.scenes.mean_object import needs_mean, with_mean_object
from relforest.scenes.padded import arrays_from_padded
from relforest.scenes.parquet import check_unchanged, is_own, read_own, sealed, to_table, write_table
from relforest.scenes.parquet_source import open_parquet
from relforest.scenes.records import arrays_from_dicts, arrays_to_dicts
from relforest.scenes.relations import Relations, relation_columns, relation_tables, with_tables
from relforest.scenes.schema import Attribute, Relation, Schema
from relforest.support.errors import InputError
from relforest.support.notebook import drawn

_Key = int | np.integer | slice | ArrayLike
_NO_RELATIONS: Final[Mapping[Any, Any]] = MappingProxyType({})


@final
@dataclass(frozen=True, slots=True, eq=False, init=False, repr=False)
class Scenes:
    """A batch of scenes, each a set of objects with the attributes of one schema.

    Usually made by `from_frame`, `from_dicts`, `from_parquet` or `from_padded`; the constructor is the fast
    path for code that already has the arrays. It checks shapes, types and bounds but does not copy: do not
    modify the arrays afterwards.

    Parameters
    ----------
    schema : Schema
        The meaning of the columns of ``matrix`` and ``arguments``.
    matrix : (n_rows, schema.width) float64
        One row per object; NaN where undefined. Angles are brought to (-pi, pi].
    rows : (n_refs,) int64
        Object rows, scene after scene. Several scenes may contain the same row.
    starts, counts : (n_scenes,) int64
        Scene ``i`` contains the objects ``rows[starts[i] : starts[i] + counts[i]]``.
    arguments : (n_scenes, k) int64, optional
        Object rows bound to the parameters of the schema, -1 = none. May be omitted if ``k`` is 0.
    scene_ids : (n_scenes,) array, optional
        Integers or strings. Default: 0, 1, 2, ...
    object_ids : (n_rows,) array, optional
        Integers or strings, different within a scene. Default: the row numbers.

    Raises
    ------
    InputError
        If a shape or type is wrong, a row number lies outside the matrix, or a value is infinite.

    Notes
    -----
    ``len``, ``shape`` and indexing by integers, masks and slices follow the rules of scikit-learn for an
    array of samples, so that cross-validation and train-test splits accept scenes.
    """

    schema: Schema
    matrix: FloatArray
    rows: IntArray
    starts: IntArray
    counts: IntArray
    arguments: IntArray
    scene_ids: IdArray
    object_ids: IdArray
    pairs: IntArray
    """What `relations` shows: number of the relation and two object rows, sorted, (n_pairs, 3)."""

    _repr_html_ = drawn

    def __init__(
        self,
        schema: Schema,
        matrix: FloatArray,
        rows: IntArray,
        starts: IntArray,
        counts: IntArray,
        arguments: IntArray | None = None,
        scene_ids: IdArray | None = None,
        object_ids: IdArray | None = None,
    ) -> None:
        if arguments is None:
            arguments = np.empty((len(starts), 0), dtype=np.int64)
        if scene_ids is None:
            scene_ids = np.arange(len(starts))
        if object_ids is None:
            object_ids = np.arange(len(matrix))
        parts = SceneArrays(schema, matrix, rows, starts, counts, arguments, scene_ids, object_ids)
        _fill(self, check_arrays(parts))

    def __reduce__(self) -> tuple[Callable[[SceneArrays], Scenes], tuple[SceneArrays]]:
        """Copy and pickle through the same checks as the constructor's; copies are read-only too."""
        return scenes_of, (self.parts,)

    @property
    def parts(self) -> SceneArrays:
        """The arrays, in the order of the constructor, and the pairs."""
        return SceneArrays(*(getattr(self, name) for name in SceneArrays._fields))

    @property
    def values(self) -> dict[str, FloatArray]:
        """Attribute name -> (n_rows, dim) view of ``matrix``."""
        return {name: self.matrix[:, self.schema.columns(name)] for name in self.schema.names}

    @property
    def relations(self) -> dict[str, IntArray]:
        """Relation name -> (n, 2) object rows, without direction in both orders, which hold in all scenes."""
        return {
            relation.name: self.pairs[self.pairs[:, 0] == number, 1:]
            for number, relation in enumerate(self.schema.relations)
        }

    @property
    def shape(self) -> tuple[int]:
        """That of an array of scenes: (n_scenes,)."""
        return (len(self),)

    def __len__(self) -> int:
        """Return the number of scenes."""
        return len(self.starts)

    def __repr__(self) -> str:
        """Return counts, attributes and arguments on one line."""
        low, high = (int(self.counts.min()), int(self.counts.max())) if len(self) else (0, 0)
        size = f"{low} objects" if low == high else f"{low} to {high} objects"
        size = "no objects" if high == 0 else size if len(self) == 1 else f"{size} each"
        scenes = "1 scene" if len(self) == 1 else f"{len(self)} scenes"
        return f"Scenes({scenes}, {size}; {self.schema.in_words})"

    def objects(self, scene: int) -> IntArray:
        """Return the positions in ``matrix`` of the objects of one scene, (counts[scene],)."""
        start = self.starts[scene]
        return self.rows[start : start + self.counts[scene]]

    def take(self, indices: ArrayLike) -> Scenes:
        """Return the scenes at the given positions, in that order; a position may repeat.

        The object rows are shared with this batch, not copied.

        Parameters
        ----------
        indices : (m,) int64 or (n_scenes,) bool
            Positions (negative ones count from the end), or a mask.

        Raises
        ------
        IndexError
            If a position does not exist, or the mask has another length.
        """
        chosen = self._positions(indices)
        return _unchecked(
            self.parts._replace(
                starts=self.starts[chosen],
                counts=self.counts[chosen],
                arguments=self.arguments[chosen],
                scene_ids=self.scene_ids[chosen],
            )
        )

    def __getitem__(self, key: _Key | tuple[_Key, EllipsisType]) -> Scenes:
        """Return the scene or scenes at ``key`` as `Scenes`; see `take`."""
        if isinstance(key, tuple) and len(key) == 2 and key[1] is Ellipsis:
            key = key[0]
        if isinstance(key, slice):
            return self.take(np.arange(len(self))[key])
        return self.take(np.atleast_1d(np.asarray(key)))

    def __iter__(self) -> Iterator[Scenes]:
        """Iterate over the scenes, each as `Scenes` of length 1."""
        return (self.take(np.array([position])) for position in range(len(self)))

    def __array__(self, dtype: object = None, copy: object = None) -> NoReturn:
        """Refuse conversion to an array: NumPy would unpack the scenes endlessly."""
        raise TypeError(
            "Scenes cannot be converted to an array: use scenes.matrix, scenes.values[name] or scenes.take"
        )

    @classmethod
    def from_frame(
        cls,
        frame: object,
        *,
        scene: str,
        object: str | None = None,  # noqa: A002 - reads well where it is called
        attributes: AttributeColumns,
        arguments: Sequence[str] = (),
        relations: Relations = _NO_RELATIONS,
    ) -> Scenes:
        """Make scenes from a long table with one row per object.

        Parameters
        ----------
        frame : pandas, polars or pyarrow table
            Any eager table that narwhals supports. The rows of a scene need not be adjacent.
        scene : str
            Column of scene ids: integers, strings, dates or times (these become ISO 8601 text). Scenes are
            in order of first appearance.
        object : str, optional
            Column of object ids, different within a scene. A row with a null id represents a scene without
            objects. Default: objects are numbered within their scene.
        attributes : mapping of str or Attribute to str or sequence of str
            The column or columns of each attribute. A plain name gets the defaults of `Attribute` with one
            dimension per column. Nulls and NaN are undefined components; one of them makes the attribute
            undefined for questions. Text must spell numbers, except for attributes declared with
            ``kind="category"``. Angles are brought to (-pi, pi].
        arguments : sequence of str
            Columns with the id of one of the scene's objects, or null for none, constant within a scene.
            They become the parameters of the schema.
        relations : mapping of str or Relation to str or table
            A column with the ids of what each object is related to, as lists or as text like ``"a;b"``; or
            pairs as for `with_relations`.

        Raises
        ------
        InputError
            If columns are missing or contain values that are not numbers or ids, ids are repeated or may
            have lost digits as floats, an argument differs within a scene or is not one of its objects, or
            the table is empty. The message names scene, object and column.

        Examples
        --------
        >>> import pandas as pd
        >>> frame = pd.DataFrame({"pass": [7, 7, 9], "player": ["a", "b", "a"], "x": [0.0, 1.0, 2.0]})
        >>> Scenes.from_frame(frame, scene="pass", object="player", attributes={"abscissa": "x"})
        Scenes(2 scenes, 1 to 2 objects each; attributes abscissa (1))
        """
        columns = relation_columns(relations)
        layout = frame_layout(scene, object, attributes, arguments, columns)
        return scenes_of(with_tables(arrays_from_frame(frame, layout), relation_tables(relations)))

    @classmethod
    def from_dicts(cls, records: Iterable[Mapping[str, Any]], schema: Schema | None = None) -> Scenes:
        """Make scenes from one dictionary per scene.

        Parameters
        ----------
        records : iterable of mappings
            ``{"id": 7, "objects": [{"id": "a", "location": [0.0, 1.0]}, ...], "arguments": {"passer":
            "a"}, "relations": {"touches": [["a", "b"]]}}``. The ids may be omitted everywhere (scenes and
            objects are then numbered from 0), and so may ``arguments`` and ``relations``. An attribute or
            component that is missing or None is undefined.
        schema : Schema, optional
            Default: attributes, arguments and relations in order of first appearance, dimensions from the
            values.

        Raises
        ------
        InputError
            If a record does not have this form or does not fit the schema; the message names scene, object
            and attribute.
        """
        return scenes_of(arrays_from_dicts(records, schema))

    @classmethod
    def from_padded(
        cls,
        observation: Mapping[str, ArrayLike],
        *,
        schema: Schema | None = None,
        mask: str = "mask",
        arguments: str = "arguments",
    ) -> Scenes:
        """Make scenes from padded arrays, as in Gymnasium's `Dict` observations.

        Parameters
        ----------
        observation : mapping of str to array
            The mask, (n_scenes, n_slots), marks the slots that hold an object; each attribute is an array
            (n_scenes, n_slots) or (n_scenes, n_slots, dim), each relation of the schema an array of 0 and 1
            (n_scenes, n_slots, n_slots). All without the first axis for a single scene.
        schema : Schema, optional
            Default: one attribute for each array, with the defaults of `Attribute`.
        mask : str
            Name of the mask.
        arguments : str
            Name of the integer array (n_scenes, k) of slots bound to the parameters of ``schema``, -1 = none.

        Raises
        ------
        InputError
            If shapes do not agree, an array is missing or unknown, or an argument is an empty slot.

        Notes
        -----
        Objects have their slot as id; the content of empty slots is ignored.
        """
        return scenes_of(arrays_from_padded(observation, schema=schema, mask=mask, arguments=arguments))

    @classmethod
    def from_parquet(
        cls,
        path: str | PathLike[str],
        *,
        scene: str | None = None,
        object: str | None = None,  # noqa: A002 - reads well where it is called
        attributes: AttributeColumns | None = None,
        arguments: Sequence[str] = (),
        relations: Mapping[str | Relation, str] = _NO_RELATIONS,
    ) -> Scenes:
        """Read scenes from a Parquet file.

        Parameters
        ----------
        path : path
            A file written by `to_parquet`, which needs no keywords, or any long table; or a folder of Parquet
            files with the same columns. Only the named columns are read.
        scene, object, attributes, arguments, relations
            As for `from_frame`; relations are columns.

        Raises
        ------
        InputError
            If the file is missing or damaged, or keywords are missing; and as for `from_frame`.
        ModelFormatError
            If the file was written by `to_parquet` of a newer version, or was changed or damaged since.
        """
        file = open_parquet(path)
        layout = named_columns(path, scene, object, attributes, arguments, relations, own=is_own(file))
        if layout is None:
            return scenes_of(read_own(file))
        table = file.read(layout.columns)
        if is_own(file):
            check_unchanged(file, table)
        return scenes_of(arrays_from_frame(table, layout))

    def to_parquet(self, path: str | PathLike[str]) -> None:
        """Write the scenes to a Parquet file, whole or not at all.

        The file is a long table (see `from_frame`) that other tools can read; `from_parquet` returns the
        same scenes, ids and shared objects, as `compact` would. Checksums reveal damage.

        Raises
        ------
        InputError
            If two objects of a scene have the same id, an argument is bound to an object of another scene, or
            the file cannot be written.
        """
        write_table(path, sealed(to_table(self.parts)))

    def to_dicts(self) -> list[dict[str, Any]]:
        """Return one dictionary of plain JSON values per scene, as `from_dicts` reads them."""
        return arrays_to_dicts(self.parts)

    def derive(
        self, attribute: str | Attribute, function: Callable[..., ArrayLike], *, of: str | Sequence[str]
    ) -> Scenes:
        """Return the scenes with one more attribute, computed from others.

        Parameters
        ----------
        attribute : str or Attribute
            The new attribute; a plain name gets the defaults of `Attribute`.
        function : callable
            Takes one (n_rows, dim) array per name in ``of`` and returns (n_rows,) or (n_rows, d) numbers, NaN
            where undefined; `relforest.scenes.extent_ratio` is an example.
        of : str or sequence of str
            The attributes passed to the function.

        Raises
        ------
        InputError
            If the name is taken, a source is unknown, or the result has the wrong shape or infinite values.
        """
        return scenes_of(add_attribute(self.parts, attribute, function, of))

    def with_relations(self, relations: Relations) -> Scenes:
        """Return the scenes with more relations between their objects.

        Parameters
        ----------
        relations : mapping of str or Relation to table
            Pairs as ids (scene, object, object): a sequence of them, or a table with these three columns.
            Without direction, name each pair once, or all pairs in both orders.

        Raises
        ------
        InputError
            If a name is taken, ids are unknown, an object is related to itself, or a pair is given twice.

        Examples
        --------
        >>> scenes = Scenes.from_dicts([{"id": 7, "objects": [{"id": "a", "x": 0.0}, {"id": "b", "x": 2.0}]}])
        >>> scenes.with_relations({"touches": [(7, "a", "b")]}).relations["touches"].tolist()
        [[0, 1], [1, 0]]
        """
        return scenes_of(with_tables(self.parts, relations))

    def with_matrix(self, matrix: FloatArray) -> Scenes:
        """Return the same scenes with other attribute values: the fast path for simulated worlds.

        Parameters
        ----------
        matrix : (n_rows, schema.width) float64
            Finite or NaN, angles in (-pi, pi]; neither is checked. Not copied, but made read-only.

        Raises
        ------
        InputError
            If it has another shape or type.
        """
        if matrix.shape != self.matrix.shape or matrix.dtype != np.float64:
            raise InputError(
                f"the new matrix must be float64 {self.matrix.shape}, got {matrix.dtype} {matrix.shape}"
            )
        return _unchecked(self.parts._replace(matrix=matrix))

    def recoded(self, schema: Schema) -> Scenes:
        """Return the same scenes with the categories of another schema, that of a model.

        If the schema has a mean object, see `with_mean_object`, the scenes get theirs.

        Raises
        ------
        InputError
            If the schemas differ in more than categories, or an object has a category that the other lacks.
        """
        scenes = self.with_mean_object() if needs_mean(self.schema, schema) else self
        return scenes if scenes.schema == schema else scenes_of(recoded(scenes.parts, schema))

    def with_mean_object(self) -> Scenes:
        """Return the scenes with a last argument, ``"mean object"``: the mean of the other objects.

        Each of its attributes is the mean of theirs, the action's arguments left out; it is undefined where
        none is defined, and for categories. What depends on a sum over objects, such as to which side a scale
        tips, is then a relation to one object.
        """
        return scenes_of(with_mean_object(self.parts))

    def __eq__(self, other: object) -> bool:
        """Return whether both batches have the same scenes in the same layout; undefined values are equal."""
        if not isinstance(other, Scenes):
            return NotImplemented
        return self.schema == other.schema and all(
            np.array_equal(mine, theirs, equal_nan=mine.dtype.kind == "f")
            for mine, theirs in zip(self.parts[1:], other.parts[1:], strict=True)
        )

    __hash__ = None  # type: ignore[assignment]  # compared by value, and values are arrays

    def compact(self) -> Scenes:
        """Return the same scenes without unused object rows, which `take` keeps."""
        return scenes_of(compact(self.parts))

    def _positions(self, indices: ArrayLike) -> IntArray:
        array = np.asarray(indices)
        if array.ndim != 1 or (array.dtype.kind not in "iub" and array.size):
            raise IndexError(
                f"scenes are indexed by a 1-D array of integers or a mask, got {array.dtype} {array.shape}"
            )
        if array.dtype.kind == "b":
            if len(array) != len(self):
                raise IndexError(f"the mask has {len(array)} entries for {len(self)} scenes")
            return np.flatnonzero(array)
        positions = array.astype(np.int64)
        if len(positions) and (positions.min() < -len(self) or positions.max() >= len(self)):
            raise IndexError(
                f"scene positions must lie in 0 to {len(self) - 1} (or be negative), got {array!r:.100}"
            )
        return positions


def checked_scenes(scenes: object) -> Scenes:
    """Return scenes as they are; `InputError` for anything else."""
    if not isinstance(scenes, Scenes):
        raise InputError(
            f"expected Scenes, got {type(scenes).__name__}: use Scenes.from_frame or Scenes.from_dicts"
        )
    return scenes


def scenes_of(parts: SceneArrays) -> Scenes:
    """Return scenes made of arrays, after the checks of the constructor."""
    return _unchecked(check_arrays(parts))


def _unchecked(parts: SceneArrays) -> Scenes:
    scenes: Scenes = object.__new__(Scenes)
    _fill(scenes, parts)
    return scenes


def _fill(scenes: Scenes, parts: SceneArrays) -> None:
    """Set the fields of a frozen instance and make its arrays read-only."""
    for name, value in zip(SceneArrays._fields, parts, strict=True):
        if isinstance(value, np.ndarray):
            value.flags.writeable = False
        object.__setattr__(scenes, name, value)
