"""CSV tables with one row per instance and a column for its bag."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import final

import pyarrow as pa

from relforest.datasets.bag_set import BagSet
from relforest.datasets.readers.fields import FieldError, at_line, number
from relforest.datasets.readers.flat_rows import Row, gather
from relforest.scenes.csv_rows import CsvRow, csv_rows, wrong_length
from relforest.scenes.dialect import ANY_DIALECT, Dialect, detected_separator
from relforest.scenes.number_columns import allow_only_commas
from relforest.scenes.sources import Source, decoded, encoding_hint, is_broken, name_of, read_bytes, utf8
from relforest.support.errors import InputError


@final
@dataclass(frozen=True, slots=True)
class Columns:
    """Names of the columns to read."""

    bag_id: str = "bag_id"
    label: str = "bag_label"
    """The bag of an instance, and the bag's label."""
    features: tuple[str, ...] | None = None  # the components of the point; all other columns if None


def read_csv(
    path: Source,
    *,
    bag_id: str = "bag_id",
    label: str = "bag_label",
    features: Sequence[str] | None = None,
    positive: str | None = None,
    separator: str | None = None,
    decimal: str | None = None,
    encoding: str | None = None,
) -> BagSet:
    """Read bags from a CSV file with one row per instance.

    Parameters
    ----------
    path : path or open file
        The file; its first line names the columns. It may be compressed with gzip.
    bag_id : str
        The column with the bag of an instance; its values are kept as strings.
    label : str
        The column with the label of the bag, repeated on each of its rows.
    features : sequence of str, optional
        The columns with the components of the point, in this order. Default: all other columns, which must
        then have names.
    positive : str, optional
        The label of positive bags; needed if labels are other than 0 and 1, -1 and 1, false and true, of
        which the second is positive.
    separator, decimal, encoding : str, optional
        How the file is written. By default the separator is detected from the first line (comma, semicolon,
        tab or bar), the decimal mark is a point, or a comma if the values allow no other reading, and the
        encoding is UTF-8, or UTF-16 if the first bytes show it.

    Returns
    -------
    BagSet
        Bags in the order of their first row; the rows of a bag may be anywhere.

    Raises
    ------
    InputError
        If the file cannot be read, a quote is not closed, a column is missing, unnamed or chosen twice, a
        row has too few or too many fields, a feature is missing or not a finite number, rows of a bag
        disagree about its label, or labels are unclear; the message names the line and the column.
    """
    if isinstance(features, str):
        raise InputError(f"features must be a sequence of column names, got the string {features!r}")
    columns = Columns(bag_id, label, None if features is None else tuple(features))
    dialect = Dialect(separator, decimal, encoding)
    return parse_csv(read_bytes(path), columns, origin=name_of(path), positive=positive, dialect=dialect)


def parse_csv(
    data: bytes,
    columns: Columns,
    *,
    origin: str,
    positive: str | None = None,
    dialect: Dialect = ANY_DIALECT,
) -> BagSet:
    """Return the bags of a CSV table in memory, unpacked; `origin` names it in the messages of `read_csv`."""
    data = utf8(data, dialect.encoding, origin)
    if dialect.separator is None:
        start = data[: 2**16].decode("utf-8", "surrogateescape")
        dialect = replace(dialect, separator=detected_separator(start))
    return gather(_rows(data, columns, origin, dialect), positive, origin)


def _rows(data: bytes, columns: Columns, origin: str, dialect: Dialect) -> Iterator[Row]:
    separator = dialect.separator or ","
    records: Iterable[CsvRow] = csv_rows(data, separator, origin, skip_blanks=True)
    head = next(iter(records), CsvRow(1, 1, []))
    names = [name.strip() for name in head.fields]
    features = _feature_columns(names, columns, origin)
    chosen = (columns.bag_id, columns.label, *features)
    places = [names.index(name) for name in chosen]
    decimal = dialect.decimal
    if decimal is None and (separator != "," or b'"' in data):
        records = list(records)
        decimal = _decimal_mark(records, places[2:])
    for record in records:
        with at_line(origin, record.line):
            complaint = wrong_length(record, len(names), separator)
            if complaint is not None:
                raise FieldError(complaint)
            bag, label, *fields = (record.fields[place].strip() for place in places)
            if not (bag + label).isprintable():
                _check_encoding(bag + label, data, origin)
            try:
                point = _point(fields, features, decimal or ".")
            except FieldError:
                _check_encoding("".join(fields), data, origin)
                raise
        yield Row(record.line, bag, label, point)


def _feature_columns(names: Sequence[str], columns: Columns, origin: str) -> tuple[str, ...]:
    """Return the names of the feature columns, given those of all columns."""
    if not names:
        raise InputError(f"{origin} is empty: its first line must name the columns")
    if columns.features is None and "" in names:
        raise InputError(
            f"{origin}: column {names.index('') + 1} is unnamed, like a row index: write the "
            "file with index=False, name the column, or choose others as features"
        )
    keys = {columns.bag_id: "bag_id", columns.label: "label"}
    features = columns.features
    if features is None:
        features = tuple(dict.fromkeys(name for name in names if name not in keys))
    chosen = (columns.bag_id, columns.label, *features)
    _check_chosen(chosen, names, keys, origin)
    repeated = [name for name in chosen if names.count(name) > 1]
    if repeated:
        raise InputError(f"{origin} has two columns {repeated[0]!r}: rename one of them")
    if not features:
        raise InputError(
            f"{origin}: columns of features are missing (besides {columns.bag_id!r} and {columns.label!r})"
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
                f"column {name!r} is missing from {origin}, which has {listed}; name one of them as {option}"
                f"{encoding_hint(names)}"
            )


def _check_encoding(text: str, data: bytes, origin: str) -> None:
    """Raise an error if a text that is used was not valid UTF-8."""
    if is_broken(text):
        decoded(data, "utf-8", origin)


def _decimal_mark(records: Sequence[CsvRow], places: Sequence[int]) -> str:
    """Return the decimal mark of the features: a comma if they allow no other reading."""
    texts = [fields[place] for *_, fields in records for place in places if place < len(fields)]
    if not any("," in text for text in texts):
        return "."
    return "," if allow_only_commas([pa.array(map(str.strip, texts), pa.large_string())]) else "."


def _point(fields: Sequence[str], names: Sequence[str], decimal: str) -> list[float]:
    point = []
    for field, name in zip(fields, names, strict=True):
        try:
            point.append(number(field, decimal))
        except FieldError as error:
            raise FieldError(f"column {name!r}: {error}") from error
    return point
