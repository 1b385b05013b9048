"""The arrays of a batch of scenes, and their checks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from relforest.scenes.angles import wrap
from relforest.scenes.ids import IdArray, as_ids, plain
from relforest.scenes.pairs import NO_PAIRS
from relforest.scenes.schema import Schema, misfit
from relforest.support.errors import InputError
from relforest.support.jit import kernel

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


class SceneArrays(NamedTuple):
    """The fields of `Scenes`: those of its constructor, where shapes are documented, and the pairs."""

    schema: Schema
    matrix: FloatArray  # (n_rows, schema.width)
    rows: IntArray  # (n_refs,)
    starts: IntArray  # (n_scenes,)
    counts: IntArray  # (n_scenes,)
    arguments: IntArray  # (n_scenes, k)
    scene_ids: IdArray  # (n_scenes,)
    object_ids: IdArray  # (n_rows,)
    pairs: IntArray = NO_PAIRS  # (n_pairs, 3): relation and two object rows, sorted


def check_arrays(parts: SceneArrays) -> SceneArrays:
    """Return the arrays with the agreed types, read-only, after vectorised checks of shapes and values.

    Raises
    ------
    InputError
        If a shape or type is wrong, a row number points outside the matrix, a value is infinite, or a scene
        contains a row twice or binds an argument to a row it does not contain.
    """
    matrix = _floats(parts.schema, parts.matrix)
    object_ids = as_ids("object_ids", parts.object_ids)
    if len(object_ids) != len(matrix):
        raise InputError(f"object_ids must have one entry per row of the matrix, got {len(object_ids)}")
    _check_finite(parts.schema, matrix, object_ids)
    _check_categories(parts.schema, matrix, object_ids)
    matrix = _with_wrapped_angles(parts.schema, matrix).view()
    matrix.flags.writeable = False
    rows, starts, counts = (_integers(name, getattr(parts, name), 1) for name in ("rows", "starts", "counts"))
    if len(starts) != len(counts):
        raise InputError(
            f"starts and counts must have one entry per scene, got {len(starts)} and {len(counts)}"
        )
    if len(starts) and (counts.min() < 0 or starts.min() < 0 or (counts > len(rows) - starts).any()):
        raise InputError(f"starts and counts must lie inside the {len(rows)} entries of rows")
    if len(rows) and (rows.min() < 0 or rows.max() >= len(matrix)):
        raise InputError(f"rows must be row numbers of the matrix, 0 to {len(matrix) - 1}")
    arguments = _integers("arguments", parts.arguments, 2)
    expected = (len(starts), parts.schema.n_parameters)
    if arguments.shape != expected:
        raise InputError(
            f"arguments must have shape {expected}, a row per scene and a column per parameter of the "
            f"schema, got {arguments.shape}"
        )
    if arguments.size and (arguments.min() < -1 or arguments.max() >= len(matrix)):
        raise InputError(
            f"arguments must be row numbers of the matrix, 0 to {len(matrix) - 1}, or -1 for none"
        )
    scene, row = _first_misfit(rows, starts, counts, arguments, np.full(len(matrix), -1))
    if scene >= 0:
        raise InputError(
            f"scene {scene} contains object row {row} twice, or binds it to an argument without containing "
            "it: list each object of a scene once"
        )
    scene_ids = as_ids("scene_ids", parts.scene_ids)
    if len(scene_ids) != len(starts):
        raise InputError(f"scene_ids must have one entry per scene, {len(starts)}, got {len(scene_ids)}")
    checked = SceneArrays(parts.schema, matrix, rows, starts, counts, arguments, scene_ids, object_ids)
    return checked._replace(pairs=_integers("pairs", parts.pairs, 2))


def compact(parts: SceneArrays) -> SceneArrays:
    """Drop object rows, and pairs of them, that no scene contains; lay out ``rows`` scene after scene.

    The scenes are the same afterwards; rows that several scenes share stay shared, and rows keep their order.
    """
    rows = gather(parts.rows, parts.starts, parts.counts)
    bound = parts.arguments[parts.arguments >= 0]
    kept = np.zeros(len(parts.matrix), dtype=np.bool_)
    kept[rows] = True
    kept[bound] = True
    renumbered = np.cumsum(kept) - 1
    arguments = (
        np.where(parts.arguments >= 0, renumbered[parts.arguments], -1) if bound.size else parts.arguments
    )
    return parts._replace(
        matrix=parts.matrix[kept],
        rows=renumbered[rows],
        starts=np.cumsum(parts.counts) - parts.counts,
        arguments=arguments,
        object_ids=parts.object_ids[kept],
        pairs=_renumbered(parts, renumbered),
    )


def _renumbered(parts: SceneArrays, numbers: IntArray) -> IntArray:
    """Return the pairs that a scene contains, with other numbers of their rows, in the same order."""
    if not len(parts.pairs):
        return parts.pairs
    kept = parts.pairs[np.unique(occurrences(parts)[2])]
    return np.column_stack([kept[:, 0], numbers[kept[:, 1:]]])


def occurrences(parts: SceneArrays) -> tuple[IntArray, IntArray, IntArray]:
    """Return each pair once for every scene that contains both objects.

    These are (n,) the places of the first and the second objects among all objects of all scenes, the first
    ones ascending, and the numbers of the pairs.
    """
    rows = gather(parts.rows, parts.starts, parts.counts)
    owner = np.repeat(np.arange(len(parts.starts)), parts.counts)
    by_first = np.argsort(parts.pairs[:, 1], kind="stable")
    begin, end = (np.searchsorted(parts.pairs[by_first, 1], rows, side) for side in ("left", "right"))
    place, number = np.repeat(np.arange(len(rows)), end - begin), gather(by_first, begin, end - begin)
    keys = owner * len(parts.matrix) + rows
    order = np.argsort(keys)
    keys = np.append(keys[order], -1)
    wanted = owner[place] * len(parts.matrix) + parts.pairs[number, 2]
    other = np.searchsorted(keys[:-1], wanted)
    found = keys[other] == wanted
    return place[found], order[other[found]], number[found]


def gather(rows: IntArray, starts: IntArray, counts: IntArray) -> IntArray:
    """Return the object rows of all scenes, scene after scene, (counts.sum(),)."""
    ends = np.cumsum(counts)
    within = np.arange(ends[-1] if len(ends) else 0) - np.repeat(ends - counts, counts)
    gathered: IntArray = rows[np.repeat(starts, counts) + within]
    return gathered


def _floats(schema: Schema, values: ArrayLike) -> FloatArray:
    try:
        matrix = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"the matrix of scenes must contain numbers: {error}") from error
    if matrix.ndim != 2 or matrix.shape[1] != schema.width:
        raise InputError(
            f"the matrix must have shape (n_rows, {schema.width}), the columns of "
            f"{', '.join(schema.names)}, got {matrix.shape}"
        )
    return matrix


def _check_finite(schema: Schema, matrix: FloatArray, object_ids: IdArray) -> None:
    infinite = np.isinf(matrix)
    if infinite.any():
        row, column = np.argwhere(infinite)[0]
        name = schema.attribute_of(column).name
        raise InputError(
            f"object {plain(object_ids[row])!r} (row {row}) has an infinite {name}: use NaN where a value "
            "is undefined"
        )


def _check_categories(schema: Schema, matrix: FloatArray, object_ids: IdArray) -> None:
    for attribute in schema.attributes:
        if attribute.kind != "category":
            continue
        places = matrix[:, schema.offset(attribute.name)]
        wrong = np.flatnonzero(~np.isnan(places) & ~np.isin(places, np.arange(len(attribute.categories))))
        if wrong.size:
            row = wrong[0]
            raise InputError(
                f"object {plain(object_ids[row])!r} (row {row}) has the category {places[row]:g} of "
                f"{attribute.name!r}: use the number of one of its {len(attribute.categories)} categories, "
                "counted from 0, or NaN where it is undefined"
            )


def recoded(parts: SceneArrays, schema: Schema) -> SceneArrays:
    """Return the same scenes with the categories of another schema, which differs in nothing else.

    Raises
    ------
    InputError
        If the schemas differ otherwise, or an object's category is not among those of the other schema.
    """
    if not schema.resembles(parts.schema):
        raise InputError(misfit(schema, parts.schema))
    matrix = parts.matrix.copy()
    for mine, theirs in zip(parts.schema.attributes, schema.attributes, strict=True):
        if mine.categories == theirs.categories:
            continue
        place = {category: number for number, category in enumerate(theirs.categories)}
        new = np.array([place.get(category, -1) for category in mine.categories], dtype=np.float64)
        column = matrix[:, schema.offset(mine.name)]
        defined = ~np.isnan(column)
        column[defined] = new[column[defined].astype(np.int64)]
        unseen = np.flatnonzero(column < 0)
        if unseen.size:
            category = mine.categories[int(parts.matrix[unseen[0], schema.offset(mine.name)])]
            raise InputError(
                f"object {plain(parts.object_ids[unseen[0]])!r} has the {mine.name} {category!r}, which the "
                f"model has never seen: it knows {', '.join(map(repr, theirs.categories))}"
            )
    return parts._replace(schema=schema, matrix=matrix)


def _with_wrapped_angles(schema: Schema, matrix: FloatArray) -> FloatArray:
    """Return the matrix with angles in (-pi, pi], copied only if a value changes."""
    for attribute in schema.attributes:
        angles = matrix[:, schema.columns(attribute.name)]
        if attribute.kind == "angle" and ((angles <= -np.pi) | (angles > np.pi)).any():
            matrix = matrix.copy()
            matrix[:, schema.columns(attribute.name)] = wrap(angles)
    return matrix


def _integers(name: str, values: ArrayLike, ndim: int) -> IntArray:
    array = np.asarray(values)
    if array.ndim != ndim:
        raise InputError(f"{name} must have {ndim} dimension{'s'[: ndim - 1]}, got the shape {array.shape}")
    if array.dtype.kind not in "iu" and array.size:
        raise InputError(f"{name} must be integers, got {array.dtype}")
    view = np.ascontiguousarray(array, dtype=np.int64).view()
    view.flags.writeable = False
    return view


@kernel
def _first_misfit(
    rows: NDArray[np.int64],
    starts: NDArray[np.int64],
    counts: NDArray[np.int64],
    arguments: NDArray[np.int64],
    last_scene: NDArray[np.int64],
) -> tuple[int, int]:
    """Find the first scene that contains an object row twice or binds an argument to a row it lacks.

    Returns the scene and the row, or (-1, -1). `last_scene` (n_rows,) is work space, all -1.
    """
    for scene in range(len(starts)):
        for row in rows[starts[scene] : starts[scene] + counts[scene]]:
            if last_scene[row] == scene:
                return scene, row
            last_scene[row] = scene
        for row in arguments[scene]:
            if row >= 0 and last_scene[row] != scene:
                return scene, row
    return -1, -1
