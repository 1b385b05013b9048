"""Labelled bags of points as one value, whether generated, read from a file or fetched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes.bags import as_bags
from relforest.scenes.ids import IdArray, as_ids, codes_by_appearance, plain
from relforest.support.errors import InputError


@final
@dataclass(frozen=True, slots=True)
class About:
    """Facts about a published data set.

    Attributes
    ----------
    name : str
        As in file names: lower case with underscores.
    title : str
        As in tables.
    n_bags, n_positive, n_instances, n_features : int
        Counts; ``n_positive`` is the number of positive bags.
    source : str
        Where the copy comes from.
    licence : str
        The terms stated by the source.
    literature : str
        Who made the data, and where they are described.
    notes : str
        What a user of the data should know.
    """

    name: str
    title: str
    n_bags: int
    n_positive: int
    n_instances: int
    n_features: int
    source: str
    licence: str
    literature: str
    notes: str


@final
@dataclass(frozen=True, slots=True, eq=False)
class BagSet:
    """Labelled bags of points; ``fit(data.bags, data.labels)`` accepts them as they are.

    Parameters
    ----------
    bags : sequence of (n_i, d) arrays
        The points of every bag; copied.
    labels : (n_bags,) bool
        Whether a bag is positive; copied.
    bag_ids : (n_bags,) integers or strings, optional
        Distinct identifiers; 0, 1, 2, ... by default.
    about : About, optional
        Facts about the data, for published sets.

    Attributes
    ----------
    bags : list of (n_i, d) float64
        The points of every bag, finite and read-only; none is empty. Treat the list itself as read-only too.
    labels : (n_bags,) bool
        Read-only.
    bag_ids : (n_bags,) int64 or object (str)
        Read-only.
    about : About or None

    Raises
    ------
    InputError
        If there are no bags, a bag is empty, their widths differ, a value is not finite, the labels are not
        boolean, an identifier is repeated, or lengths disagree.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest.datasets import BagSet
    >>> data = BagSet([np.zeros((2, 3)), np.ones((1, 3))], np.array([True, False]))
    >>> data.n_instances, data.n_features, data.n_positive
    (3, 3, 1)
    """

    bags: list[NDArray[np.float64]]
    labels: NDArray[np.bool_]
    bag_ids: IdArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    about: About | None = None

    def __post_init__(self) -> None:
        """Check the parts and replace them by read-only copies."""
        data = as_bags(list(self.bags))
        data.points.flags.writeable = False
        labels = np.array(self.labels)
        if labels.dtype != np.bool_:
            raise InputError(
                f"labels must be booleans, got {labels.dtype}: compare them with the positive label"
            )
        labels.flags.writeable = False
        ids = as_ids("bag_ids", self.bag_ids).copy() if len(self.bag_ids) else data.bag_ids
        ids.flags.writeable = False
        for name, values in (("labels", labels), ("bag_ids", ids)):
            if values.shape != (len(data),):
                raise InputError(
                    f"{name} must have the shape ({len(data)},), one entry per bag, got {values.shape}"
                )
        distinct, counts = np.unique(ids, return_counts=True)
        if len(distinct) < len(ids):
            repeated = plain(distinct[np.argmax(counts)])
            raise InputError(f"bag_ids contain {repeated!r} twice: give every bag its own")
        object.__setattr__(self, "bags", np.split(data.points, data.starts[1:-1]))
        object.__setattr__(self, "labels", labels)
        object.__setattr__(self, "bag_ids", ids)

    @classmethod
    def from_instances(
        cls,
        points: NDArray[np.float64],
        bag_ids: Sequence[str],
        positive: NDArray[np.bool_],
        *,
        about: About | None = None,
    ) -> BagSet:
        """Group instances by bag, in the order of each bag's first instance.

        Parameters
        ----------
        points : (n, d) float64
            One row per instance; the rows of a bag need not be adjacent.
        bag_ids : sequence of n str
            The bag of each instance.
        positive : (n,) bool
            The label of each instance's bag.
        about : About, optional
            Facts about the data.

        Raises
        ------
        InputError
            If instances of a bag disagree about its label, or for the reasons listed under `BagSet`.
        """
        codes, ids = codes_by_appearance(as_ids("bag_ids", bag_ids))
        counts = np.bincount(codes, minlength=len(ids))
        grouped = np.argsort(codes, kind="stable")
        starts = np.cumsum(counts) - counts
        labels = positive[grouped][starts]
        odd = np.flatnonzero(positive != labels[codes])
        if odd.size:
            raise InputError(
                f"row {odd[0] + 1} labels bag {ids[codes[odd[0]]]!r} differently from an earlier row: all "
                "rows of a bag need the same label"
            )
        return cls(np.split(points[grouped], starts[1:]), labels, ids, about)

    def __len__(self) -> int:
        """Return the number of bags."""
        return len(self.bags)

    @property
    def n_positive(self) -> int:
        """Number of positive bags."""
        return int(np.count_nonzero(self.labels))

    @property
    def n_instances(self) -> int:
        """Number of points in all bags together."""
        return sum(len(bag) for bag in self.bags)

    @property
    def n_features(self) -> int:
        """Number of components of a point."""
        return int(self.bags[0].shape[1])
