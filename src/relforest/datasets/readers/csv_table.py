"""CSV tables with one row per instance and a column that says which bag it belongs to."""

from __future__ import annotations

import csv
import io
import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import final

from relforest.datasets.bag_set import BagSet
from relforest.datasets.readers.fields import FieldError, at_line, number
from relforest.datasets.readers.flat_rows import Row, gather
from relforest.support.errors import InputError
from relforest.support.files import read_input, unpacked

__all__ = ["Columns", "parse_csv", "read_csv"]


@final
@dataclass(frozen=True, slots=True)
class Columns:
    """Names of the columns that matter.

    Attributes
    ----------
    bag_id, label : str
        Which bag an instance belongs to, and the bag's label.
    features : tuple of str or None
        The components of the point; all other columns if None.
    """

    bag_id: str = "bag_id"
    label: str = "bag_label"
    features: tuple[str, ...] | None = None


def read_csv(
    path: str | os.PathLike[str],
    *,
    bag_id: str = "bag_id",
    label: str = "bag_label",
    features: Sequence[str] | None = None,
    positive: str | None = None,
) -> BagSet:
    """Read bags from a CSV file with one row per instance.

    Parameters
    ----------
    path : path
        The file; its first line names the columns. It may be compressed with gzip.
    bag_id : str
        The column that says which bag an instance belongs to; its values are kept as strings.
    label : str
        The column with the label of the bag, repeated on each of its rows.
    features : sequence of str, optional
        The columns with the components of the point, in this order; all other columns by default, which must
        then all have names.
    positive : str, optional
        The label of positive bags; needed if labels are other than 0 and 1, -1 and 1, false and true, of
        which the second is positive.

    Returns
    -------
    BagSet
        Bags in the order of their first row; the rows of a bag may be anywhere.

    Raises
    ------
    InputError
        If the file cannot be read, a quote is not closed, a column is missing, has no name or is chosen
        twice, a row has too few or too many fields, a feature is missing or no finite number, rows of a bag
        disagree about its label, or labels are unclear; the message names the line and the column.
    """
    if isinstance(features, str):
        raise InputError(f"features must be a sequence of column names, got the string {features!r}")
    columns = Columns(bag_id, label, None if features is None else tuple(features))
    return parse_csv(unpacked(read_input(path), str(path)), columns, origin=str(path), positive=positive)


def parse_csv(data: bytes, columns: Columns, *, origin: str, positive: str | None = None) -> BagSet:
    """Return the bags of a CSV table in memory; see `read_csv`.

    Parameters
    ----------
    data : bytes
        The content of the file, unpacked.
    columns : Columns
        The columns to read.
    origin : str
        The file, for messages.
    positive : str or None
        The label of positive bags.

    Raises
    ------
    InputError
        As `read_csv` says.
    """
    return gather(_rows(data, columns, origin), positive, origin)


def _rows(data: bytes, columns: Columns, origin: str) -> Iterator[Row]:
    records = _records(data, origin)
    _, head = next(records, (1, []))
    names = [name.strip() for name in head]
    features = _feature_columns(names, columns, origin)
    place_of = {name: place for place, name in enumerate(names)}
    bag, label = place_of[columns.bag_id], place_of[columns.label]
    places = [place_of[name] for name in features]
    for line, fields in records:
        with at_line(origin, line):
            if len(fields) != len(names):
                raise FieldError(
                    f"there are {len(fields)} fields, but {len(names)} columns: complete the row, and quote "
                    "fields that hold commas"
                )
            point = _point([fields[place] for place in places], features)
        yield Row(line, fields[bag].strip(), fields[label].strip(), point)


def _records(data: bytes, origin: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the fields of each row that is not blank, after the number of the line on which it begins."""
    text = io.TextIOWrapper(io.BytesIO(data), encoding="utf-8-sig", newline="")
    # Unless strict, a quote that is not closed swallows the rest of the file in silence.
    table = csv.reader(text, skipinitialspace=True, strict=True)
    line = 1
    try:
        for fields in table:
            if fields:
                yield line, fields
            line = table.line_num + 1
    except UnicodeDecodeError as error:
        raise InputError(f"{origin} is not UTF-8 text: convert the file first") from error
    except csv.Error as error:
        raise InputError(
            f"{origin}, line {line}, cannot be read as CSV: {error}; close each quote before a comma or the "
            "end of the line, and write one within a quoted field twice"
        ) from error


def _feature_columns(names: Sequence[str], columns: Columns, origin: str) -> tuple[str, ...]:
    """Return the names of the feature columns, given those of all columns."""
    if not names:
        raise InputError(f"{origin} is empty: its first line must name the columns")
    if columns.features is None and "" in names:
        raise InputError(
            f"{origin}: column {names.index('') + 1} has no name, so it looks like a row index: write the "
            "file with index=False, name the column, or choose others as features"
        )
    repeated = [name for name, count in Counter(names).items() if count > 1]
    if repeated:
        raise InputError(f"{origin} has two columns {repeated[0]!r}: rename one of them")
    keys = {columns.bag_id: "bag_id", columns.label: "label"}
    features = columns.features
    if features is None:
        features = tuple(name for name in names if name not in keys)
    _check_chosen((columns.bag_id, columns.label, *features), names, keys, origin)
    if not features:
        raise InputError(
            f"{origin} has no columns of features chosen beside {columns.bag_id!r} and {columns.label!r}"
        )
    return features


def _check_chosen(chosen: Sequence[str], names: Sequence[str], keys: Mapping[str, str], origin: str) -> None:
    """Check that each chosen column is there and chosen once."""
    known = set(names)
    for name, count in Counter(chosen).items():
        if count > 1:
            raise InputError(
                f"column {name!r} is chosen twice: bag_id, label and each of features must be another column"
            )
        if name not in known:
            listed = ", ".join(map(repr, names[:6])) + (", ..." if len(names) > 6 else "")
            option = keys.get(name, "features")
            raise InputError(
                f"{origin} has no column {name!r}: it has {listed}; name one of them as {option}"
            )


def _point(fields: Sequence[str], names: Sequence[str]) -> list[float]:
    point = []
    for field, name in zip(fields, names, strict=True):
        try:
            point.append(number(field))
        except FieldError as error:
            raise FieldError(f"column {name!r}: {error}") from error
    return point
