"""The C4.5 ``.data`` files of the UCI repository, as those of Musk: one line per instance."""

from __future__ import annotations

import os
from collections.abc import Iterator

from relforest.datasets.bag_set import BagSet
from relforest.datasets.readers.fields import FieldError, at_line, number, read_text
from relforest.datasets.readers.flat_rows import Row, gather

__all__ = ["read_c45"]


def read_c45(
    path: str | os.PathLike[str], *, instance_ids: bool = True, positive: str | None = None
) -> BagSet:
    """Read bags from a C4.5 ``.data`` file such as ``clean1.data`` of Musk.

    Parameters
    ----------
    path : path
        The ``.data`` file; a ``.names`` file beside it is not needed. It may be compressed with gzip.
    instance_ids : bool
        Whether the second field is a name of the instance (Musk: of the conformation), which is not kept.
    positive : str, optional
        The label of positive bags; needed if labels are other than 0 and 1, -1 and 1, false and true.

    Returns
    -------
    BagSet
        Bags in the order of their first instance; the rows of a bag may be anywhere.

    Raises
    ------
    InputError
        If the file cannot be read, a line has another number of fields than the first, a feature is missing
        or no finite number, or labels are unclear; the message names the line.

    Notes
    -----
    A line holds, separated by commas: the bag's name, the instance's name (see ``instance_ids``), the
    features, all of them numbers, and the label, with or without a dot at its end. From ``|`` on
    a line is a comment.
    """
    return gather(_rows(path, 2 if instance_ids else 1), positive, str(path))


def _rows(path: str | os.PathLike[str], n_names: int) -> Iterator[Row]:
    expected: int | None = None
    for line_number, line in enumerate(read_text(path).split("\n"), start=1):
        fields = [field.strip() for field in line.partition("|")[0].split(",")]
        if fields == [""]:
            continue
        features = fields[n_names:-1]
        with at_line(path, line_number):
            _check_length(features, expected, n_names)
            point = [number(feature) for feature in features]
        expected = len(features)
        yield Row(line_number, fields[0], fields[-1].removesuffix("."), point)


def _check_length(features: list[str], expected: int | None, n_names: int) -> None:
    if not features:
        names = "a bag, an instance" if n_names == 2 else "a bag"
        raise FieldError(
            f"a line needs {names}, features and a label, separated by commas (see instance_ids)"
        )
    if expected not in {None, len(features)}:
        raise FieldError(f"there are {len(features)} features, but {expected} above: complete the line")
