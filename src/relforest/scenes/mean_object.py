"""One more object in every scene, the mean of the others, for what sums over objects decide."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes.arrays import FloatArray, SceneArrays, gather
from relforest.scenes.schema import Schema

MEAN: Final = "mean object"
"""Name of the argument that is bound to the mean object."""


def needs_mean(given: Schema, wanted: Schema) -> bool:
    """Return whether scenes of one schema become those of another by a mean object."""
    return has_mean(wanted) and MEAN not in given.parameters


def has_mean(schema: Schema) -> bool:
    """Return whether the last argument of scenes is their mean object."""
    return schema.parameters[-1:] == (MEAN,)


def without_mean(schema: Schema) -> Schema:
    """Return the schema of the scenes before they got a mean object, if they have one."""
    return Schema(schema.attributes, schema.parameters[:-1], schema.relations) if has_mean(schema) else schema


def with_mean_object(parts: SceneArrays) -> SceneArrays:
    """Return the scenes with a last argument, `MEAN`: the mean of all objects but the other arguments.

    Its attributes are the means of theirs, on the circle for angles; where none is defined, and for
    categories, they are undefined.
    """
    n, schema = len(parts.starts), parts.schema
    objects = gather(parts.rows, parts.starts, parts.counts)
    owner = np.repeat(np.arange(n), parts.counts)
    free = ~(objects[:, None] == parts.arguments[owner]).any(axis=1)
    values, scene = parts.matrix[objects[free]], owner[free]
    means = np.full((n, schema.width), np.nan)
    for attribute in schema.attributes:
        if attribute.kind == "category":
            continue
        for column in range(*schema.columns(attribute.name).indices(schema.width)):
            own = values[:, column]
            if attribute.kind == "angle":
                means[:, column] = np.arctan2(_means(np.sin(own), scene, n), _means(np.cos(own), scene, n))
            else:
                means[:, column] = _means(own, scene, n)
    counts = parts.counts + 1
    starts = np.cumsum(counts) - counts
    rows = np.empty(int(counts.sum()), dtype=np.int64)
    last = starts + parts.counts
    is_mean = np.zeros(len(rows), dtype=np.bool_)
    is_mean[last] = True
    new = len(parts.matrix) + np.arange(n)
    rows[~is_mean], rows[is_mean] = objects, new
    numbered = parts.object_ids.dtype.kind in "iu"
    ids = np.full(n, -1) if numbered else np.full(n, MEAN, dtype=object)
    return SceneArrays(
        Schema(schema.attributes, (*schema.parameters, MEAN), schema.relations),
        np.concatenate([parts.matrix, means]),
        rows,
        starts,
        counts,
        np.column_stack([parts.arguments, new]),
        parts.scene_ids,
        np.concatenate([parts.object_ids, ids]),
        parts.pairs,
    )


def _means(values: FloatArray, scene: NDArray[np.int64], n: int) -> FloatArray:
    """Return the mean of the defined values of each of n scenes, NaN where there is none."""
    known = ~np.isnan(values)
    with np.errstate(invalid="ignore"):
        return np.asarray(
            np.bincount(scene[known], values[known], n) / np.bincount(scene[known], minlength=n)
        )
