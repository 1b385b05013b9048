"""Bags of points, the input of multiple-instance learning, in a common layout."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Literal, final

import numpy as np

from relforest.scenes.arrays import FloatArray, IntArray
from relforest.scenes.bag_values import Values, are_names, as_values, dimensions, in_order_of, is_sparse
from relforest.scenes.ids import IdArray, as_ids, codes_by_appearance, plain
from relforest.support.errors import InputError
from relforest.support.masks import refuse_masked

LARGEST_VALUE: Final = 1e30
"""Squared differences of such values, and sums of many of them, do not overflow."""


@final
@dataclass(frozen=True, slots=True, eq=False)
class Bags:
    """Points grouped by bag.

    Attributes
    ----------
    points : (n_points, d) float64
        Grouped by bag, in the given order within each bag; C-contiguous, with values of at most
        `LARGEST_VALUE`.
    starts : (n_bags + 1,) int64
        Bag ``i`` is ``points[starts[i] : starts[i + 1]]``; no bag is empty.
    bag_ids : (n_bags,) array
        Identifiers in order of first appearance; 0, 1, 2, ... if none were given.
    columns : tuple or None
        Labels of the components of points, from the columns of data frames; None for other input.
    form : {"list", "identified", "rows", "cube"}
        Form of the input: an array per bag, an identifier per point, a 2-D array, or a 3-D array.
    rows : (n_points,) int64 or None
        Row of each point in the input, if `form` is "identified".
    """

    points: FloatArray
    starts: IntArray
    bag_ids: IdArray
    columns: tuple[Any, ...] | None = None
    form: Literal["list", "identified", "rows", "cube"] = "list"
    rows: IntArray | None = None

    def __len__(self) -> int:
        """Return the number of bags."""
        return len(self.starts) - 1

    def taken(self, bags: IntArray) -> Bags:
        """Return some of the bags, by their numbers, in the order in which they are named."""
        rows, starts = rows_of(self.starts, bags)
        return Bags(self.points[rows], starts, self.bag_ids[bags], self.columns)

    @property
    def counts(self) -> IntArray:
        """Number of points in each bag, (n_bags,)."""
        return np.diff(self.starts)

    @property
    def dim(self) -> int:
        """Number of components of a point."""
        return int(self.points.shape[1])

    @property
    def has_names(self) -> bool:
        """Whether columns have names; only strings count as names, as in scikit-learn."""
        return are_names(self.columns)


def rows_of(starts: IntArray, chosen: IntArray) -> tuple[IntArray, IntArray]:
    """Return the rows of the points of chosen bags, and where each bag starts among these rows."""
    counts = np.diff(starts)[chosen]
    new_starts = np.concatenate([[0], np.cumsum(counts)])
    rows = np.arange(new_starts[-1]) + np.repeat(starts[chosen] - new_starts[:-1], counts)
    return rows, new_starts


def as_bags(bags: Any) -> Bags:  # noqa: ANN401  # in many forms
    """Convert bags of points to the common layout.

    Parameters
    ----------
    bags : list of (n_i, d) arrays, (X, bag_ids), 3-D array, 2-D array, or BagSet
        A sequence with one array per bag; a tuple of an (n_points, d) array and (n_points,) integer or string
        identifiers, with the rows of a bag in any place; an (n_bags, n, d) array; an (n_bags, d) array, with
        one point per bag; or a `relforest.datasets.BagSet`. An object array with a single column and a bag in
        every cell counts as a sequence. Pandas, polars and pyarrow tables may replace 2-D arrays; the columns
        of different bags are matched by name.

    Returns
    -------
    Bags
        In the given order, or in the order of first appearance of identifiers.

    Raises
    ------
    InputError
        If there are no bags, a bag is empty, bags differ in width or column names, a value is NaN, infinite,
        larger than 1e30, masked or not a real number, or the input is sparse or of another shape. Messages
        use scikit-learn's wording where possible.
    """
    if _is_bag_set(bags):
        bags = bags.bags
    if is_sparse(bags):
        raise InputError("sparse input is not supported: pass a dense array, for instance with .toarray()")
    if isinstance(bags, tuple) and len(bags) == 2 and dimensions(bags[1]) < 2:
        return _from_identified(*bags)
    bags = _from_cells(bags)
    if isinstance(bags, (list, tuple)) and (not bags or _is_sequence_of_bags(bags)):
        return _from_sequence(bags)
    array, columns = as_values(bags, "the array of bags")
    if array.ndim < 2:
        raise InputError(
            f"Expected 2D array, got {array.ndim}D array instead. Reshape your data: array.reshape(-1, 1) "
            "for one point with one component per bag, or a list of 2-D arrays, one per bag."
        )
    if array.ndim > 3:
        raise InputError(f"bags must be a 2-D or 3-D array, got the shape {array.shape}")
    n_bags, size = array.shape[0], array.shape[1] if array.ndim == 3 else 1
    if n_bags and not size:
        raise InputError(f"every bag is empty (shape {array.shape}): each needs at least one point")
    counts = np.full(n_bags, size)
    found = _bags(array.reshape(n_bags * size, array.shape[-1]), counts, np.arange(n_bags), columns)
    return replace(found, form="rows" if array.ndim == 2 else "cube")


def own_labels(bags: Any) -> Any:  # noqa: ANN401  # of any type
    """Return the labels of a `relforest.datasets.BagSet`, and None for other forms of bags."""
    return bags.labels if _is_bag_set(bags) else None


def _is_bag_set(bags: object) -> bool:
    # The columns of data frames are attributes too, but not lists.
    return isinstance(getattr(bags, "bags", None), list) and hasattr(bags, "labels")


def _from_cells(bags: object) -> object:
    """Convert a column with a bag in every cell to a list; return anything else unchanged."""
    column = np.asarray(bags) if hasattr(bags, "to_numpy") and dimensions(bags) == 1 else bags
    if not isinstance(column, np.ndarray) or column.dtype != object:
        return bags
    if column.ndim not in (1, 2) or column.shape[1:] not in ((), (1,)):
        return bags
    refuse_masked(column, "the array of bags")
    cells = list(column.ravel())
    return cells if any(dimensions(cell) for cell in cells) else bags


def _from_sequence(bags: Sequence[Any]) -> Bags:
    n_bags = np.arange(len(bags))
    if _can_be_joined(bags):
        counts = np.fromiter(map(len, bags), np.int64, len(bags))
        return _bags(np.concatenate(bags, dtype=np.float64, casting="unsafe"), counts, n_bags)
    every = [as_values(bag, f"bag {number}") for number, bag in enumerate(bags)]
    for number, (array, _) in enumerate(every):
        if array.ndim in (1, 2) and not len(array):
            raise InputError(f"bag {number} is empty: remove it, or add at least one point")
        if array.ndim != 2:
            raise InputError(
                f"bag {number} must be a 2-D array, one row per point, got the shape {array.shape}"
            )
    every = [_like_the_first(every, number) for number in range(len(every))]
    for number, (array, _) in enumerate(every):
        if array.shape[1] != every[0].array.shape[1]:
            raise InputError(
                f"bag {number} has points of {array.shape[1]} components, but bag 0 of "
                f"{every[0].array.shape[1]}: all bags must have the same width"
            )
    points = np.concatenate([array for array, _ in every]) if every else np.empty((0, 1))
    counts = np.array([len(array) for array, _ in every], dtype=np.int64)
    return _bags(points, counts, n_bags, every[0].columns if every else None)


def _can_be_joined(bags: Sequence[Any]) -> bool:
    """Whether all bags are plain arrays of numbers of the right shape, so that only values need checking."""
    if set(map(type, bags)) != {np.ndarray}:
        return False
    widths = {bag.shape[1:] for bag in bags}
    types = {bag.dtype for bag in bags}
    return (
        len(widths) == 1
        and len(*widths) == 1
        and all(map(len, bags))
        and all(dtype.kind in "fiub" and dtype.itemsize <= 8 for dtype in types)
    )


def _like_the_first(every: list[Values], number: int) -> Values:
    """Return the values of a bag with their columns in the order of the first bag.

    Labels that are not names, such as pandas' default numbers, may differ between bags.
    """
    first, values = every[0], every[number]
    if are_names(first.columns) != are_names(values.columns):
        named, bare = (number, 0) if are_names(values.columns) else (0, number)
        raise InputError(
            f"bag {named} has column names, but bag {bare} does not: name the columns of all bags, or of none"
        )
    if first.columns is None or values.columns is None:
        return values
    missing = [label for label in first.columns if label not in values.columns]
    extra = [label for label in values.columns if label not in first.columns]
    if not missing and not extra:
        return in_order_of(first.columns, values)
    if not are_names(first.columns):
        return values
    found = [f"column {missing[0]!r} is missing"] if missing else []
    found += [f"column {extra[0]!r} is not in bag 0"] if extra else []
    raise InputError(f"bag {number}: {', '.join(found)}; all bags must have the same columns")


def _from_identified(points: object, bag_ids: object) -> Bags:
    array, columns = as_values(points, "the array of points")
    if array.ndim != 2:
        raise InputError(
            f"Expected 2D array, got {array.ndim}D array instead. Reshape your data to one row per point, "
            "with one bag id per row."
        )
    ids = as_ids("bag_ids", bag_ids)
    if len(ids) != len(array):
        raise InputError(f"bag_ids must have one entry for each of the {len(array)} points, got {len(ids)}")
    codes, distinct = codes_by_appearance(ids)
    grouped = np.argsort(codes, kind="stable")
    found = _bags(array[grouped], np.bincount(codes, minlength=len(distinct)), distinct, columns)
    return replace(found, form="identified", rows=grouped)


def _bags(
    points: FloatArray, counts: IntArray, bag_ids: IdArray, columns: tuple[Any, ...] | None = None
) -> Bags:
    if not len(counts):
        raise InputError("there are no bags: Found array with 0 sample(s) while a minimum of 1 is required.")
    if not points.shape[1]:
        raise InputError(
            f"Found array with 0 feature(s) (shape={points.shape}) while a minimum of 1 is required."
        )
    starts = np.zeros(len(counts) + 1, dtype=np.int64)
    np.cumsum(counts, out=starts[1:])
    # NaN is not allowed either.
    allowed = np.abs(points) <= LARGEST_VALUE
    if not allowed.all():
        point, component = np.argwhere(~allowed)[0]
        bag = int(np.searchsorted(starts, point, side="right")) - 1
        part = f"component {component}" if columns is None else f"column {columns[component]!r}"
        place = f"bag {plain(bag_ids[bag])!r}, row {point - starts[bag]}, {part}"
        if np.isfinite(points[point, component]):
            raise InputError(f"Input X contains values beyond {LARGEST_VALUE:g}: use other units ({place})")
        raise InputError(f"Input X contains NaN or infinity: {place}. Drop the point or fill in the value.")
    return Bags(np.ascontiguousarray(points), starts, bag_ids, columns)


def _is_sequence_of_bags(entries: Sequence[object]) -> bool:
    """Whether entries are bags instead of rows of one array; an empty bag may look like a row."""
    return dimensions(entries[0]) > 0 and any(dimensions(entry) != 1 for entry in entries)
