"""JSON form of single nodes."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping as Dictionary
from typing import TYPE_CHECKING, Any, Final

from relforest.mappings import Mapping
from relforest.support.documents import LARGEST_NUMBER
from relforest.support.errors import ModelFormatError
from relforest.support.options import in_range
from relforest.trees.bounds import Bounds
from relforest.trees.nodes import ClassLeaf, Instantiation, Leaf, MeanLeaf, Node, Question
from relforest.volumes import volume_from_dict

if TYPE_CHECKING:
    from relforest.scenes import Attribute

# Up to here, every integer is also a float.
MAX_COUNT: Final = 2**53
_ROUNDING: Final = 1e-6


def node_to_dict(node: Node) -> dict[str, Any]:
    """Return a node as a plain dictionary."""
    match node:
        case MeanLeaf():
            return {
                "kind": "mean",
                "mean": node.prediction,
                "deviation": node.deviation,
                "scenes": node.positives,
            } | ({"lowest": True} if node.lowest else {})
        case ClassLeaf():
            return {
                "kind": "classes",
                "order": node.probability,
                "negatives": node.negatives,
                "shares": list(node.shares),
                "counts": list(node.counts),
            }
        case Leaf():
            return {
                "kind": "leaf",
                "probability": node.probability,
                "negatives": node.negatives,
                "positives": node.positives,
            }
        case Instantiation(child):
            return {"kind": "instantiation", "child": child}
        case Question():
            return {
                "kind": "question",
                "operation": node.mapping.operation,
                "attribute": node.mapping.attribute.name,
                "variables": list(node.variables),
                "volume": node.volume.to_dict(),
                "yes": node.yes,
                "no": node.no,
                "error": node.error,
            } | ({"bounds": [_bounds_to_list(each) for each in node.bounds]} if node.bounds else {})


def node_from_dict(document: dict[str, Any], attributes: Dictionary[str, Attribute]) -> Node:
    """Read what `node_to_dict` returned; a malformed document raises an error that `Tree.from_dict` handles.

    `attributes` are the attributes of the schema, by name.
    """
    node_type = document["kind"]
    if node_type == "leaf":
        negatives, positives = _counts(document["negatives"], document["positives"])
        return Leaf(in_range("probability", document["probability"], 0.0, 1.0), negatives, positives)
    if node_type == "mean":
        mean = in_range("mean", document["mean"], -LARGEST_NUMBER, LARGEST_NUMBER)
        deviation = in_range("deviation", document["deviation"], 0.0, LARGEST_NUMBER)
        lowest = document.get("lowest", False)
        if not isinstance(lowest, bool):
            raise ModelFormatError(f"lowest must be true or false, got {reprlib.repr(lowest)}")
        return MeanLeaf(-mean if lowest else mean, 0, _counts(document["scenes"])[0], deviation, lowest)
    if node_type == "classes":
        return _class_leaf(document)
    if node_type == "instantiation":
        return Instantiation(_whole(document["child"]))
    if node_type == "question":
        name = document["attribute"]
        if name not in attributes:
            raise ModelFormatError(
                f"unknown attribute {reprlib.repr(name)}: the schema has {reprlib.repr(tuple(attributes))}"
            )
        mapping = Mapping(document["operation"], attributes[name])
        variables = tuple(_whole(variable) for variable in document["variables"])
        yes, no, error = (_whole(document[answer]) for answer in ("yes", "no", "error"))
        bounds = tuple(map(_bounds_from_list, document.get("bounds", [])))
        volume = volume_from_dict(document["volume"])
        return Question(mapping, variables, volume, yes, no, error, bounds)
    raise ModelFormatError(
        f"unknown node type {reprlib.repr(node_type)}: expected leaf, instantiation or question"
    )


def _bounds_to_list(bounds: Bounds) -> list[float | None]:
    """Return the coordinate and both ends, null = none."""
    return [bounds.axis, *(end if math.isfinite(end) else None for end in (bounds.low, bounds.high))]


def _bounds_from_list(given: list[Any]) -> Bounds:
    axis, low, high = given
    low, high = (
        none if end is None else in_range("bound", end, -LARGEST_NUMBER, LARGEST_NUMBER)
        for end, none in ((low, -math.inf), (high, math.inf))
    )
    if not -math.inf < low <= high and not low <= high < math.inf:
        raise ModelFormatError(f"malformed bounds {reprlib.repr(given)}")
    return Bounds(_whole(axis), low, high)


def _class_leaf(document: dict[str, Any]) -> ClassLeaf:
    order = in_range("order", document["order"], 0.0, 1.0)
    shares = tuple(in_range("share", share, 0.0, 1.0) for share in document["shares"])
    counts = _counts(document["negatives"], *document["counts"])
    negatives, counts = counts[0], counts[1:]
    if not (len(shares) == len(counts) >= 2 and abs(sum(shares) - 1.0) <= _ROUNDING):
        raise ModelFormatError(
            f"malformed leaf: shares {reprlib.repr(shares)} of counts {reprlib.repr(counts)}"
        )
    if negatives not in counts:
        raise ModelFormatError(f"malformed leaf: no class has {negatives} scenes")
    return ClassLeaf(order, negatives, sum(counts) - negatives, shares, counts)


def _counts(*values: object) -> tuple[int, ...]:
    counts = tuple(_whole(value) for value in values)
    if not 0 <= min(counts) <= max(counts) <= MAX_COUNT:
        raise ModelFormatError(f"malformed leaf: counts {reprlib.repr(list(counts))}")
    return counts


def _whole(value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool):
        raise ModelFormatError(f"expected a whole number, got {reprlib.repr(value)}")
    return value
