"""Bags and scenes in the containers of other libraries: of sawmil and torchmil, and padded arrays."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from relforest.datasets import BagSet
from relforest.scenes import Scenes, Schema, as_bags
from relforest.support.errors import InputError


def bags_from_sawmil(dataset: Any) -> BagSet:  # noqa: ANN401 - the package need not be installed
    """Return the bags of a ``sawmil.BagDataset``, or of any list of its bags.

    Bags whose label is above 0 are positive, as there. The masks of instances, which say where the signal may
    be, are for the methods of that package and are not used.

    Raises
    ------
    InputError
        If it is something else, or a bag cannot be used.
    """
    bags = getattr(dataset, "bags", dataset)
    if not isinstance(bags, Iterable) or not all(hasattr(bag, "X") and hasattr(bag, "y") for bag in bags):
        raise InputError(f"pass a sawmil.BagDataset or a list of its bags, got {dataset!r:.60}")
    bags = list(bags)
    return BagSet([bag.X for bag in bags], np.array([float(bag.y) > 0.0 for bag in bags], dtype=np.bool_))


def bags_from_torchmil(batches: Any) -> BagSet:  # noqa: ANN401 - the package need not be installed
    """Return the bags of a data set of torchmil, of its batches, or of a single batch.

    Parameters
    ----------
    batches : iterable of mappings, or a mapping
        With the keys ``X`` and ``Y``: of a bag, (n, d) and a label 0 or 1; of a batch, which also has a
        ``mask`` (b, n), (b, n, d) and (b,). So are the items of data sets and of data loaders that use
        ``torchmil.data.collate_fn``. Other keys are not used.

    Raises
    ------
    InputError
        If it is something else, a label is neither 0 nor 1, or a bag cannot be used.
    """
    bags: list[NDArray[Any]] = []
    labels: list[NDArray[Any]] = []
    for batch in [batches] if hasattr(batches, "keys") else batches:
        keys = set(batch.keys()) if hasattr(batch, "keys") else set()
        if not {"X", "Y"} <= keys:
            raise InputError(f"a bag or batch of torchmil is a mapping with X and Y, got {batch!r:.60}")
        points, own = _array(batch["X"]), _array(batch["Y"]).ravel()
        found = list(_present(points, _array(batch["mask"]))) if "mask" in keys else [points]
        if len(own) != len(found) or not np.isin(own, (0, 1)).all():
            raise InputError(f"Y must be 0 or 1 for each of {len(found)} bags, got {own!r:.60}")
        bags += found
        labels.append(own == 1)
    return BagSet(bags, np.concatenate(labels) if labels else np.empty(0, np.bool_))


def bags_from_padded(points: ArrayLike, mask: ArrayLike) -> list[NDArray[Any]]:
    """Return the bags of a padded array, for ``fit(bags, labels)``.

    Parameters
    ----------
    points : (n_bags, n, d) array
        The content of empty places does not matter.
    mask : (n_bags, n) array
        1 or True where there is a point.

    Raises
    ------
    InputError
        If the shapes do not agree, or the mask has other values.
    """
    return list(_present(_array(points), _array(mask)))


def padded_bags(bags: Any, fill: float = 0.0) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:  # noqa: ANN401 - in many forms
    """Return bags, in any form that classifiers take, as an array (n_bags, n, d) and its mask (n_bags, n)."""
    data = as_bags(bags)
    mask = np.arange(data.counts.max()) < data.counts[:, None]
    points = np.full((*mask.shape, data.dim), fill)
    points[mask] = data.points
    return points, mask


def scenes_from_rows(
    rows: ArrayLike, schema: Schema, *, mask: ArrayLike | None = None, flag: int | None = None
) -> Scenes:
    """Return scenes of padded rows of numbers, as in many observations of PettingZoo and Stable-Baselines3.

    Parameters
    ----------
    rows : (n_scenes, n, k) or (n, k) array
        A row for each object, in the columns of the schema, apart from the flag.
    schema : Schema
        Without arguments and relations; see `relforest.Scenes.from_padded` for these.
    mask : (n_scenes, n) or (n,) array, optional
        1 or True where there is an object.
    flag : int, optional
        The column of ``rows`` that says so, instead of a mask; negative ones count from the end.

    Raises
    ------
    InputError
        If shapes do not agree, or there is no mask and no flag, or both.

    Examples
    --------
    >>> import relforest as rf
    >>> seen = [[1, 0.5, 2.0], [1, 3.0, 4.0], [0, 0.0, 0.0]]
    >>> scenes_from_rows(seen, rf.Schema([rf.Attribute("location", 2)]), flag=0)
    Scenes(1 scene, 2 objects; attributes location (2))
    """
    values = _array(rows)
    if (mask is None) == (flag is None):
        raise InputError("say which rows are objects: by mask=, or by flag=, the column that tells it")
    width = schema.width + (flag is not None)
    if values.ndim not in (2, 3) or values.shape[-1] != width:
        raise InputError(f"rows must be of {width} numbers, in two or three dimensions, got {values.shape}")
    if flag is not None:
        if not -width <= flag < width:
            raise InputError(f"flag must be one of the {width} columns, counted from 0, got {flag}")
        mask, values = values[..., flag], np.delete(values, flag, axis=-1)
    observation = {name: values[..., schema.columns(name)] for name in schema.names}
    present = _array(mask)
    return Scenes.from_padded({**observation, "mask": present}, schema=schema)


def _present(points: NDArray[Any], mask: NDArray[Any]) -> Iterator[NDArray[Any]]:
    """Yield the points of each bag."""
    if points.ndim != 3 or mask.shape != points.shape[:2] or not np.isin(mask, (0, 1)).all():
        raise InputError(
            "points must be an array (n_bags, n, d), and the mask 0 or 1 in the shape (n_bags, n), got the "
            f"shapes {points.shape} and {mask.shape}"
        )
    for own, present in zip(points, mask.astype(np.bool_), strict=True):
        yield own[present]


def _array(values: Any) -> NDArray[Any]:  # noqa: ANN401 - tensors, too
    """Return numbers as an array, also those of a tensor that is on a GPU or part of a graph."""
    try:
        return np.asarray(values.detach().cpu() if hasattr(values, "detach") else values)
    except ValueError as error:
        raise InputError(f"expected an array of numbers: {error}") from error
