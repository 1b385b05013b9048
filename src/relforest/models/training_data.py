"""Training data from a table: its scenes, and what is to be predicted of each of them."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Final, Literal, Unpack, final, get_args

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from relforest.models.model import Label
from relforest.models.model_file import check_names
from relforest.scenes import Scenes, scene_values
from relforest.scenes.columns import listed, open_frame
from relforest.scenes.dialect import ANY_DIALECT, Dialect
from relforest.scenes.frames import FrameLayout, named_columns, stored_values
from relforest.scenes.ids import plain
from relforest.scenes.label_text import parsed_label
from relforest.scenes.labels import class_labels
from relforest.scenes.number_columns import number_columns
from relforest.scenes.scene_stream import SceneColumns
from relforest.scenes.scene_table import SceneTable, read_scenes
from relforest.support.errors import InputError
from relforest.support.options import one_of

Target = Literal["auto", "classes", "numbers"]
MOST_CLASSES: Final = 10
"""Whole numbers of more different values are learned as numbers unless classes are asked for."""

_REMEDY: Final = "name its columns with scene= and attributes= (and object=, arguments=)"


@final
@dataclass(frozen=True, slots=True, eq=False)
class TrainingData:
    """Scenes and what is to be predicted of them.

    Parameters
    ----------
    scenes : Scenes
    y : (n_scenes,) array
        The place of each scene's label in `classes`, int64; or numbers, float64.
    label : str
        The column of what is to be predicted.
    classes : tuple of labels, or None
        Of two, the second one is the positive class; None for numbers.
    columns : FrameLayout
        The columns that the scenes were read from.
    """

    scenes: Scenes
    y: NDArray[Any]
    label: str
    classes: tuple[Label, ...] | None
    columns: FrameLayout


def read_training_data(
    path: str | PathLike[str],
    label: str,
    *,
    target: Target = "auto",
    positive: Label | None = None,
    dialect: Dialect = ANY_DIALECT,
    remedy: str = _REMEDY,
    **columns: Unpack[SceneColumns],
) -> TrainingData:
    """Read scenes, and what is to be predicted of them, from a table.

    Parameters
    ----------
    path : path
        A CSV or Parquet file, or a folder of Parquet files; see `relforest.scenes.read_table`.
    label : str
        The column of what is to be predicted, with one value per scene.
    target : {"auto", "classes", "numbers"}
        What it holds. By default, numbers are numbers if some are not whole, or if there are more than
        `MOST_CLASSES` different ones; anything else are classes.
    positive : label, optional
        The positive one of two classes, as a value or as written in the table. By default, the one that sorts
        last.
    dialect : Dialect
        How a CSV file is written.
    remedy : str
        What to do if columns are needed and missing, for the message.
    **columns
        ``scene``, ``object``, ``attributes``, ``arguments`` and ``relations`` as for
        `relforest.Scenes.from_parquet`; none for files that `Scenes.to_parquet` wrote, with a label column
        added.

    Raises
    ------
    InputError
        If the file cannot be read, its columns cannot be found or used, a label is missing or differs within
        a scene, all are the same, `positive` is not one of two classes, or a model of these names could not
        be written.
    ModelFormatError
        If `Scenes.to_parquet` wrote the file and it was changed since.

    Examples
    --------
    >>> from relforest.models import read_training_data
    >>> data = read_training_data(
    ...     "passes.parquet", "completed", scene="pass", attributes={"location": ["x", "y"]}
    ... )  # doctest: +SKIP
    >>> model = rf.SMRFTreeClassifier().fit(data.scenes, data.y)  # doctest: +SKIP
    >>> rf.save(model, "tree.json", data)  # doctest: +SKIP
    """
    one_of("target", target, get_args(Target))
    layout = named_columns(path, own=True, **columns)
    source = read_scenes(Path(path), layout, remedy=remedy, label=label, dialect=dialect)
    values = scene_values(source.table, label, scene=source.scene_key)
    classes: tuple[Label, ...] | None = None
    y: NDArray[Any]
    if target == "numbers" or (target == "auto" and _are_numbers(values, source, label)):
        if positive is not None:
            raise InputError(f"positive is for two classes, but column {label!r} holds numbers: omit it")
        y = _numbers(source, label)
        _check_different(np.unique(y).tolist(), label, len(y), "numbers that differ")
    else:
        classes, y = _classes(values, label, positive)
    check_names(label, classes, source.layout, str(path))
    return TrainingData(source.scenes, y, label, classes, source.layout)


def _are_numbers(values: NDArray[Any], source: SceneTable, label: str) -> bool:
    """Return whether values are numbers rather than classes."""
    if values.dtype.kind == "b":
        return False
    if values.dtype.kind == "O":
        try:
            values = _as_numbers(source, label)
        except InputError:
            return False  # words
    different = np.unique(values)
    # NaN is not whole: `_numbers` says where it is.
    return bool(len(different) > MOST_CLASSES or (different != np.round(different)).any())


def _as_numbers(source: SceneTable, label: str) -> NDArray[np.float64]:
    """Return the values of a column as numbers, NaN where one is missing, (n_scenes,)."""
    values = pa.table({label: stored_values(source.table, label, scene=source.scene_key)})
    frame = open_frame(values.replace_schema_metadata(source.table.schema.metadata), [label])
    return number_columns(frame, [label], lambda row: f"scene {_scene(source, row)}")[:, 0]


def _numbers(source: SceneTable, label: str) -> NDArray[np.float64]:
    numbers = _as_numbers(source, label)
    missing = np.flatnonzero(np.isnan(numbers))
    if missing.size:
        raise InputError(
            f"column {label!r} lacks a number in scene {_scene(source, int(missing[0]))}: fill it in or drop "
            "the scene"
        )
    return numbers


def _scene(source: SceneTable, position: int) -> str:
    return repr(plain(source.scenes.scene_ids[position]))


def _classes(
    values: NDArray[Any], label: str, positive: Label | None
) -> tuple[tuple[Label, ...], NDArray[np.int64]]:
    """Return the classes, and the place of each value among them."""
    if values.dtype.kind == "O" and not all(isinstance(value, str) for value in values):
        values = values.astype(np.float64)  # decimals
    if values.dtype.kind == "f":
        odd = values[~(np.abs(values) < 2.0**63) | (values != np.round(values))]
        if odd.size:
            raise InputError(
                f"column {label!r} holds {odd[0]:g}: classes are words, booleans or whole numbers; to learn "
                'numbers, choose the target "numbers"'
            )
        values = values.astype(np.int64)
    _check_different(np.unique(values).tolist(), label, len(values), "scenes of both classes")
    found, codes = class_labels(values, len(values), what="scenes")
    classes: tuple[Label, ...] = tuple(found.tolist())
    if positive is None or (len(classes) == 2 and _is_meant(positive, classes[1])):
        return classes, codes
    if len(classes) != 2:
        held = f"{len(classes)} ({listed(classes)})"
        raise InputError(f"positive is for two classes, but column {label!r} holds {held}: omit it")
    if not _is_meant(positive, classes[0]):
        raise InputError(
            f"positive must be one of the labels in column {label!r}, {classes[0]} and {classes[1]}, got "
            f"{positive!r:.100}"
        )
    return classes[::-1], 1 - codes


def _check_different(values: list[Any], label: str, n: int, needed: str) -> None:
    if len(values) < 2:
        raise InputError(
            f"column {label!r} has the label {values[0]!r} in all {n} scenes: learning needs {needed}"
        )


def _is_meant(given: Label, label: Label) -> bool:
    """Return whether a value is a label, or a text is how one is written, in messages or in a table."""
    written = parsed_label(given) if isinstance(given, str) else given
    return given == str(label) or (written == label and isinstance(written, bool) == isinstance(label, bool))
