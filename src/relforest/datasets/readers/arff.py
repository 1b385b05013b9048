"""Weka's multi-instance ARFF: each data row holds a bag's name, its instances as one quoted text, its label.

SciPy's reader of the format supports relational attributes, but guesses quoting from the first row, lacks
text attributes and does not locate errors.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from relforest.datasets.bag_set import BagSet
from relforest.datasets.readers.arff_lines import Attribute, parse_attribute, split_fields, split_statement
from relforest.datasets.readers.fields import FieldError, at_line, number, positive_labels, split_lines
from relforest.scenes.sources import Source, name_of, read_text
from relforest.support.errors import InputError


@final
@dataclass(frozen=True, slots=True)
class BagRelation:
    """The declarations in the head of a multi-instance ARFF file."""

    name: Attribute  # the identifier, the first attribute of a bag
    features: tuple[Attribute, ...]  # the attributes of an instance, numeric or nominal
    label: Attribute  # the class, the last attribute of a bag


def read_arff(path: Source, *, positive: str | None = None, encoding: str | None = None) -> BagSet:
    r"""Read bags from a relational ARFF file, Weka's format of multi-instance data.

    Parameters
    ----------
    path : path or open file
        The file; it may be compressed with gzip.
    positive : str, optional
        The label of positive bags; needed if labels are other than 0 and 1, -1 and 1, false and true, of
        which the second is positive.
    encoding : str, optional
        Default: UTF-8, or UTF-16 where the first bytes show it.

    Returns
    -------
    BagSet
        In the order of the file. A nominal attribute of instances becomes one component per declared value, 1
        where the instance has it and 0 elsewhere.

    Raises
    ------
    InputError
        If the file cannot be read, does not declare a name, a relational attribute and a class, in this
        order, or contains something unusable: a missing value, an invalid number, an undeclared value, a bag
        without a name, a sparse or weighted row, an empty bag, or text or dates as attributes of instances.
        The message names the line.

    Notes
    -----
    ::

        @relation example
        @attribute molecule {a,b}
        @attribute bag relational
          @attribute f1 numeric
          @attribute f2 {x,y}
        @end bag
        @attribute class {0,1}
        @data
        a,"1.5,x\n2,y",1
        b,"0.5,x",0
    """
    return read_relation(path, positive=positive, encoding=encoding)[1]


def read_relation(
    path: Source,
    *,
    positive: str | None = None,
    usual: str | None = None,
    encoding: str | None = None,
) -> tuple[BagRelation, BagSet]:
    """Return the declarations of a file along with its bags, as `read_arff` does.

    `usual` is the label of positive bags in files that have it, if `positive` is not given.
    """
    origin = name_of(path)
    lines = enumerate(split_lines(read_text(path, encoding)), start=1)
    relation = _read_head(lines, origin)
    ids: dict[str, int] = {}
    labels: list[str] = []
    bags: list[NDArray[np.float64]] = []
    for line_number, line in lines:
        with at_line(origin, line_number):
            fields = split_fields(line)
            if not fields:
                continue
            if len(fields) != 3:
                raise FieldError(f"{len(fields)} values instead of three: a name, a bag and a label")
            name, instances, label = fields
            if not name:
                raise FieldError("the name of the bag is missing")
            if name in ids:
                raise FieldError(f"bag {name!r} is already on line {ids[name]}: give it another name")
            _check_declared("name", name, relation.name)
            _check_declared("label", label, relation.label)
            ids[name] = line_number
            labels.append(label)
            bags.append(_points(instances, relation.features))
    if not bags:
        raise InputError(f"{origin} does not contain any bags after @data")
    if positive is None and usual in labels:
        positive = usual
    is_positive = positive_labels(labels, positive, origin)
    return relation, BagSet(bags, is_positive, np.array(list(ids), dtype=object))


def _read_head(lines: Iterator[tuple[int, str]], origin: str) -> BagRelation:
    """Read up to the line ``@data``."""
    outer: list[Attribute] = []
    relational: Attribute | None = None
    for line_number, line in lines:
        with at_line(origin, line_number):
            keyword, rest = split_statement(line)
            if keyword == "@data" and relational is None:
                return _bag_relation(outer)
            if keyword == "@attribute":
                attribute = parse_attribute(rest)
                if relational is not None:
                    relational = replace(relational, members=(*relational.members, attribute))
                elif attribute.datatype == "relational":
                    relational = attribute
                else:
                    outer.append(attribute)
            elif keyword == "@end" and relational is not None:
                outer.append(relational)
                relational = None
            elif keyword not in {"", "@relation"}:
                raise FieldError(
                    f"{keyword!r} is not allowed here: the head has lines @relation, @attribute, @end (which "
                    "closes a relational attribute) and @data"
                )
    raise InputError(f"{origin} does not have an @data line: it is not an ARFF file, or truncated")


def _bag_relation(declared: list[Attribute]) -> BagRelation:
    if [attribute.datatype == "relational" for attribute in declared] != [False, True, False]:
        listed = ", ".join(f"{attribute.name!r} ({attribute.datatype})" for attribute in declared) or "none"
        raise FieldError(
            "bags need three attributes, a name, a relational one with the instances, and a class; "
            f"this file declares {listed}. Save a flat table as CSV and use read_csv"
        )
    features = declared[1].members
    odd = next((member for member in features if member.datatype not in {"numeric", "nominal"}), None)
    if odd is not None:
        raise FieldError(
            f"attribute {odd.name!r} of the instances has type {odd.datatype}: only numeric and nominal ones "
            "are supported, so remove it"
        )
    if not features:
        raise FieldError(f"the relational attribute {declared[1].name!r} lacks attributes")
    return BagRelation(declared[0], features, declared[2])


def _points(text: str, features: Sequence[Attribute]) -> NDArray[np.float64]:
    """Return the instances of a bag, (n, d)."""
    rows = [fields for fields in map(split_fields, split_lines(text)) if fields]
    if not rows:
        raise FieldError("the bag is empty: remove it or fill it")
    return np.array(
        [_components(row_number, fields, features) for row_number, fields in enumerate(rows, start=1)]
    )


def _components(row_number: int, fields: Sequence[str], features: Sequence[Attribute]) -> list[float]:
    if len(fields) != len(features):
        raise FieldError(f"instance {row_number} has {len(fields)} values, but {len(features)} are declared")
    components: list[float] = []
    for field, attribute in zip(fields, features, strict=True):
        try:
            components += (
                [number(field)] if attribute.datatype == "numeric" else _indicators(field, attribute)
            )
        except FieldError as error:
            raise FieldError(f"instance {row_number}, attribute {attribute.name!r}: {error}") from error
    return components


def _indicators(field: str, attribute: Attribute) -> list[float]:
    _check_declared("value", field, attribute)
    return [float(field == value) for value in attribute.values]


def _check_declared(what: str, field: str, attribute: Attribute) -> None:
    if attribute.datatype == "nominal" and field not in attribute.values:
        raise FieldError(
            f"the {what} {field!r} is not declared: add it to the attribute {attribute.name!r} or correct it"
        )
