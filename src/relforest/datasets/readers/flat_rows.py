"""Files with one row per instance, in any format: rows are grouped by their bag."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from relforest.datasets.bag_set import BagSet
from relforest.datasets.readers.fields import FieldError, at_line, positive_labels
from relforest.support.errors import InputError


class Row(NamedTuple):
    """An instance."""

    line: int  # in the file, from 1
    bag: str
    label: str  # of the bag
    point: list[float]


def gather(rows: Iterable[Row], positive: str | None, origin: str) -> BagSet:
    """Group instances by their bag; bags come in the order of their first instance.

    The rows of a bag may be anywhere; all have points of the same length. The label of positive bags is
    `positive`, if it is not obvious.

    Raises
    ------
    InputError
        If rows or names of bags are missing, a bag has two labels, or labels are unclear.
    """
    ids: list[str] = []
    label_of: dict[str, str] = {}
    points = []
    for row in rows:
        with at_line(origin, row.line):
            if not row.bag:
                raise FieldError("the name of the bag is missing: give every row one")
            first = label_of.setdefault(row.bag, row.label)
            if first != row.label:
                raise FieldError(
                    f"bag {row.bag!r} is labelled {row.label!r} here and {first!r} above: all rows of a bag "
                    "need the same label"
                )
        ids.append(row.bag)
        points.append(np.array(row.point))
    if not points:
        raise InputError(f"{origin} does not contain any instances")
    labels = positive_labels([label_of[bag] for bag in ids], positive, origin)
    return BagSet.from_instances(np.array(points), ids, labels)
