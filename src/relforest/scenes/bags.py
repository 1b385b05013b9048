"""Bags of points, the input of multiple-instance learning, in one layout whatever form they came in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes.arrays import FloatArray, IntArray
from relforest.scenes.ids import IdArray, as_ids, codes_by_appearance, plain
from relforest.support.errors import InputError

__all__ = ["LARGEST_VALUE", "BagTypeError", "Bags", "as_bags"]

LARGEST_VALUE: Final = 1e30
"""Squares of differences of such values, and sums of many of these, stay far from overflow."""


@final
class BagTypeError(InputError, TypeError):
    """A value inside a bag is of a type that is no number; scikit-learn expects a `TypeError` here."""


@final
@dataclass(frozen=True, slots=True, eq=False)
class Bags:
    """Points grouped by bag.

    Attributes
    ----------
    points : (n_points, d) float array
        Bag after bag, the rows of each as they were given; C-contiguous, none beyond `LARGEST_VALUE`.
    starts : (n_bags + 1,) int64 array
        Bag ``i`` is ``points[starts[i] : starts[i + 1]]``; none is empty.
    bag_ids : (n_bags,) array
        Identifiers in order of first appearance; 0, 1, 2, ... where none were given.
    """

    points: FloatArray
    starts: IntArray
    bag_ids: IdArray

    def __len__(self) -> int:
        """Return the number of bags."""
        return len(self.starts) - 1

    @property
    def counts(self) -> IntArray:
        """Number of points in each bag, shape (n_bags,)."""
        return np.diff(self.starts)

    @property
    def dim(self) -> int:
        """Number of components of a point."""
        return int(self.points.shape[1])


def as_bags(bags: object) -> Bags:
    """Bring bags of points into one layout.

    Parameters
    ----------
    bags : list of (n_i, d) arrays, or (X, bag_ids), or 3-D array, or 2-D array
        A sequence with one array per bag; or a tuple of an (n_points, d) array and (n_points,) integer or
        string identifiers, the rows of a bag being anywhere; or an (n_bags, n, d) array; or an (n_bags, d)
        array, read as one point per bag.

    Returns
    -------
    Bags
        In the order given, or of the identifiers' first appearance.

    Raises
    ------
    InputError
        If there are no bags, a bag is empty, bags differ in width, a value is NaN, infinite, beyond 1e30 or
        no number, or the input is sparse, complex or of another shape. Messages follow scikit-learn's wording
        where it has one.
    """
    if _is_sparse(bags):
        raise InputError("sparse input is not supported: pass a dense array, for instance with .toarray()")
    if isinstance(bags, tuple) and len(bags) == 2 and _dimensions(bags[1]) < 2:
        return _from_identified(*bags)
    if isinstance(bags, (list, tuple)) and (not bags or _is_sequence_of_bags(bags)):
        return _from_sequence(bags)
    array = _numbers(bags, "the array of bags")
    if array.ndim < 2:
        raise InputError(
            f"Expected 2D array, got {array.ndim}D array instead. Reshape your data: array.reshape(-1, 1) "
            "makes one point with one component per bag, a list of 2-D arrays gives one array per bag."
        )
    if array.ndim > 3:
        raise InputError(f"bags must be a 2-D or 3-D array, got the shape {array.shape}")
    n_bags, size = array.shape[0], array.shape[1] if array.ndim == 3 else 1
    if n_bags and not size:
        raise InputError(f"every bag is empty, shape {array.shape}: each needs at least one point")
    counts = np.full(n_bags, size)
    return _bags(array.reshape(n_bags * size, array.shape[-1]), counts, np.arange(n_bags))


def _from_sequence(bags: Sequence[Any]) -> Bags:
    arrays = [_numbers(bag, f"bag {number}") for number, bag in enumerate(bags)]
    for number, array in enumerate(arrays):
        if array.ndim in (1, 2) and not len(array):
            raise InputError(f"bag {number} is empty: each needs at least one point, leave it out or fill it")
        if array.ndim != 2:
            raise InputError(
                f"bag {number} must be a 2-D array, one row per point, got the shape {array.shape}"
            )
        if array.shape[1] != arrays[0].shape[1]:
            raise InputError(
                f"bag {number} has points of {array.shape[1]} components, but bag 0 of "
                f"{arrays[0].shape[1]}: all bags must have the same width"
            )
    points = np.concatenate(arrays) if arrays else np.empty((0, 1))
    return _bags(points, np.array([len(array) for array in arrays], dtype=np.int64), np.arange(len(arrays)))


def _from_identified(points: object, bag_ids: object) -> Bags:
    array = _numbers(points, "the array of points")
    if array.ndim != 2:
        raise InputError(
            f"Expected 2D array, got {array.ndim}D array instead. Reshape your data to one row per point, "
            "next to its bag id."
        )
    ids = as_ids("bag_ids", bag_ids if isinstance(bag_ids, list) else np.asarray(bag_ids))
    if len(ids) != len(array):
        raise InputError(f"bag_ids must have one entry for each of the {len(array)} points, got {len(ids)}")
    codes, distinct = codes_by_appearance(ids)
    grouped = np.argsort(codes, kind="stable")
    return _bags(array[grouped], np.bincount(codes, minlength=len(distinct)), distinct)


def _bags(points: FloatArray, counts: IntArray, bag_ids: IdArray) -> Bags:
    if not len(counts):
        raise InputError("there are no bags: Found array with 0 sample(s) while a minimum of 1 is required.")
    if not points.shape[1]:
        raise InputError(
            f"Found array with 0 feature(s) (shape={points.shape}) while a minimum of 1 is required."
        )
    starts = np.concatenate([np.zeros(1, dtype=np.int64), np.cumsum(counts)])
    # The negated test also catches NaN.
    wrong = np.argwhere(~(np.abs(points) <= LARGEST_VALUE))
    if wrong.size:
        point, component = wrong[0]
        bag = int(np.searchsorted(starts, point, side="right")) - 1
        place = f"bag {plain(bag_ids[bag])!r}, row {point - starts[bag]}, component {component}"
        if np.isfinite(points[point, component]):
            raise InputError(f"Input X contains values beyond {LARGEST_VALUE:g}: use other units ({place})")
        raise InputError(f"Input X contains NaN or infinity: {place}. Drop the point or fill in the value.")
    return Bags(np.ascontiguousarray(points), starts, bag_ids)


def _numbers(values: object, what: str) -> NDArray[np.float64]:
    """Return values as a float64 array of whatever shape."""
    if _is_sparse(values):
        raise InputError(
            f"{what} is sparse, which is not supported: pass a dense array, for instance with .toarray()"
        )
    try:
        array = np.asarray(values)
        if array.dtype.kind == "c":
            raise InputError(f"Complex data not supported: {what} holds complex numbers")
        if array.dtype.kind in "US":
            raise InputError(f"{what} holds strings: convert them to numbers")
        return array.astype(np.float64)
    except TypeError as error:
        raise BagTypeError(f"{what} must hold numbers: {error}") from error
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{what} must be an array of numbers with rows of equal length: {error}") from error


def _dimensions(value: object) -> int:
    """Return the number of dimensions without converting nested lists whole."""
    found = getattr(value, "ndim", None)
    if isinstance(found, int):
        return found
    if isinstance(value, (list, tuple)):
        return 1 + (_dimensions(value[0]) if len(value) else 0)
    return 0


def _is_sequence_of_bags(entries: Sequence[object]) -> bool:
    """Tell bags from the rows of one array; an empty bag, like a row, may look one-dimensional."""
    return _dimensions(entries[0]) > 0 and any(_dimensions(entry) != 1 for entry in entries)


def _is_sparse(value: object) -> bool:
    return hasattr(value, "toarray") and hasattr(value, "nnz")
