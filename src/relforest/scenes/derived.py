"""Attributes computed from attributes: a way to add custom unary mapping functions."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from relforest.scenes.arrays import FloatArray, SceneArrays
from relforest.scenes.schema import Attribute, Schema
from relforest.support.errors import InputError


def extent_ratio(extent: ArrayLike) -> FloatArray:
    """Return how elongated objects are: second extent over first (Palmer 2015, section 4.3, function 7).

    Parameters
    ----------
    extent : (n, 2) array
        The two extents of each object, the larger one first for a ratio of at most 1.

    Returns
    -------
    (n,) array
        NaN (undefined) where the first extent is 0 or an extent is undefined.

    Examples
    --------
    >>> extent_ratio([[4.0, 1.0], [0.0, 1.0]])
    array([0.25,  nan])
    """
    sizes = np.asarray(extent, dtype=np.float64)
    if sizes.ndim != 2 or sizes.shape[1] != 2:
        raise InputError(f"extent_ratio needs two extents per object, shape (n, 2), got {sizes.shape}")
    ratio = np.full(len(sizes), np.nan)
    np.divide(sizes[:, 1], sizes[:, 0], out=ratio, where=sizes[:, 0] != 0)
    return ratio


def add_attribute(
    parts: SceneArrays,
    attribute: str | Attribute,
    function: Callable[..., ArrayLike],
    of: str | Sequence[str],
) -> SceneArrays:
    """Return the arrays with one more attribute; see `Scenes.derive`."""
    schema, names = parts.schema, (of,) if isinstance(of, str) else tuple(of)
    if not names:
        raise InputError("of must name at least one attribute to pass to the function")
    name = attribute.name if isinstance(attribute, Attribute) else attribute
    if name in schema:
        raise InputError(f"the scenes already have an attribute {name!r}: give the derived one another name")
    column = _column(
        name, function(*(parts.matrix[:, schema.columns(each)] for each in names)), len(parts.matrix)
    )
    added = attribute if isinstance(attribute, Attribute) else Attribute(attribute, max(column.shape[1], 1))
    if column.shape[1] != added.dim:
        raise InputError(
            f"the function for attribute {name!r} returned {column.shape[1]} columns, but its dim is "
            f"{added.dim}"
        )
    return parts._replace(
        schema=Schema((*schema.attributes, added), schema.parameters, schema.relations),
        matrix=np.hstack([parts.matrix, column]),
    )


def _column(name: str, values: ArrayLike, n_rows: int) -> FloatArray:
    try:
        column = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"the function for attribute {name!r} must return numbers: {error}") from error
    if column.ndim == 1:
        column = column[:, np.newaxis]
    if column.ndim != 2 or len(column) != n_rows:
        raise InputError(
            f"the function for attribute {name!r} must return one row for each of the {n_rows} objects, "
            f"shape ({n_rows},) or ({n_rows}, dim), got {np.shape(values)}"
        )
    return column
