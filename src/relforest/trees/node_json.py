"""JSON form of single nodes."""

from __future__ import annotations

import reprlib
from collections.abc import Mapping as Dictionary
from typing import TYPE_CHECKING, Any, Final

from relforest.mappings import Mapping
from relforest.support.errors import ModelFormatError
from relforest.support.options import in_range
from relforest.trees.nodes import Instantiation, Leaf, Node, Question
from relforest.volumes import volume_from_dict

if TYPE_CHECKING:
    from relforest.scenes import Attribute

# Up to here, every integer is also a float.
MAX_COUNT: Final = 2**53


def node_to_dict(node: Node) -> dict[str, Any]:
    """Return a node as a plain dictionary."""
    match node:
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
            }


def node_from_dict(document: dict[str, Any], attributes: Dictionary[str, Attribute]) -> Node:
    """Read what `node_to_dict` returned; a malformed document raises an error that `Tree.from_dict` handles.

    `attributes` are the attributes of the schema, by name.
    """
    kind = document["kind"]
    if kind == "leaf":
        counts = [_whole(document[key]) for key in ("negatives", "positives")]
        probability = in_range("probability", document["probability"], 0.0, 1.0)
        if not 0 <= min(counts) <= max(counts) <= MAX_COUNT:
            msg = f"malformed leaf: counts {reprlib.repr(counts)}"
            raise ModelFormatError(msg)
        return Leaf(probability, *counts)
    if kind == "instantiation":
        return Instantiation(_whole(document["child"]))
    if kind == "question":
        name = document["attribute"]
        if name not in attributes:
            msg = f"unknown attribute {reprlib.repr(name)}: the schema has {reprlib.repr(tuple(attributes))}"
            raise ModelFormatError(msg)
        mapping = Mapping(document["operation"], attributes[name])
        variables = tuple(_whole(variable) for variable in document["variables"])
        links = [_whole(document[answer]) for answer in ("yes", "no", "error")]
        return Question(mapping, variables, volume_from_dict(document["volume"]), *links)
    msg = f"unknown node kind {reprlib.repr(kind)}: expected leaf, instantiation or question"
    raise ModelFormatError(msg)


def _whole(value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool):
        msg = f"expected a whole number, got {reprlib.repr(value)}"
        raise ModelFormatError(msg)
    return value
