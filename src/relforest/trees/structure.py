"""Checking that a list of nodes is a tree, and fits a schema."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from relforest.support.errors import InputError
from relforest.trees.nodes import Instantiation, Node, Question, children
from relforest.volumes import Arc, Ellipsoid, Slab

if TYPE_CHECKING:
    from collections.abc import Mapping

    from relforest.scenes import Attribute, Schema

# Far beyond what can be learned, as every question must be significant and every variable needs an object.
# These limits keep a hostile file from exhausting memory, which grows with the length of branches.
MAX_ATTRIBUTES: Final = 1000
MAX_WIDTH: Final = 100_000
MAX_NODES: Final = 100_000
MAX_VARIABLES: Final = 100
MAX_DEPTH: Final = 1000
MAX_ABOVE: Final = 5_000_000
MAX_SLABS: Final = 5_000_000


def check_structure(schema: Schema, nodes: tuple[Node, ...]) -> tuple[list[int], list[tuple[int, ...]]]:
    """Check the nodes of a tree and return what lies above each of them.

    Returns
    -------
    (list of int, list of tuple of int)
        For each node, the number of variables bound and the indices of the questions above it, root first.

    Raises
    ------
    InputError
        If the nodes do not form one tree in depth-first order, the schema or the tree is too large, or a
        question does not fit the schema, its variables or its volume.
    """
    if not nodes:
        raise InputError("a tree needs at least one node")
    _check_size(schema, nodes)
    known = frozenset(schema.attributes)
    bound = [-1] * len(nodes)
    above: list[tuple[int, ...]] = [()] * len(nodes)
    bound[0], n_above = 0, 0
    for i, node in enumerate(nodes):
        if bound[i] < 0:
            raise InputError(f"node {i} has no parent before it: list the nodes in depth-first order")
        if isinstance(node, Question):
            _check_question(known, i, node, bound[i])
        path = (*above[i], i) if isinstance(node, Question) else above[i]
        if len(path) > MAX_DEPTH:
            raise InputError(
                f"node {i} is question number {len(path)} of its branch: at most {MAX_DEPTH} are allowed"
            )
        for child in children(node):
            if not i < child < len(nodes) or bound[child] >= 0:
                raise InputError(
                    f"node {i} points to node {child}: every node must have one parent, earlier in the list"
                )
            bound[child] = bound[i] + isinstance(node, Instantiation)
            if bound[child] > MAX_VARIABLES:
                raise InputError(
                    f"node {i} binds variable number {bound[child]} of its branch: "
                    f"at most {MAX_VARIABLES} are allowed"
                )
            above[child] = path
        n_above += len(path)
        if n_above > MAX_ABOVE:
            raise InputError(
                f"the branches ask more than {MAX_ABOVE} questions in all: the tree is too large"
            )
    if _preorder(nodes) != list(range(len(nodes))):
        raise InputError("the nodes are not in depth-first order (Yes, No, Error)")
    return bound, above


def check_counts(document: Mapping[str, Any]) -> None:
    """Check the lengths of the lists in the JSON form of a tree, before anything is built from them."""
    schema = document["schema"]
    _check_most("nodes", len(document["nodes"]), MAX_NODES)
    _check_most("attributes", len(schema["attributes"]), MAX_ATTRIBUTES)
    _check_most("action arguments", len(schema["parameters"]), MAX_VARIABLES)


def _check_size(schema: Schema, nodes: tuple[Node, ...]) -> None:
    _check_most("nodes", len(nodes), MAX_NODES)
    _check_most("attributes", len(schema.attributes), MAX_ATTRIBUTES)
    _check_most("action arguments", schema.n_parameters, MAX_VARIABLES)
    _check_most("components of attributes", schema.width, MAX_WIDTH)
    # Their matrices are not in the file, but packed with the tree.
    slabs = [node.volume for node in nodes if isinstance(node, Question) and isinstance(node.volume, Slab)]
    _check_most("numbers in the matrices of its slabs", sum(slab.dim**2 for slab in slabs), MAX_SLABS)


def _check_most(what: str, count: int, most: int) -> None:
    if count > most:
        raise InputError(f"a tree with {count} {what} is too large: at most {most} are allowed")


def _check_question(known: frozenset[Attribute], index: int, node: Question, n_bound: int) -> None:
    mapping = node.mapping
    if mapping.attribute not in known:
        raise InputError(f"node {index} asks about {mapping.name}, but that attribute is not in the schema")
    used = node.variables
    if len(used) != mapping.arity or len(set(used)) != len(used) or not all(0 <= v < n_bound for v in used):
        raise InputError(
            f"node {index}: {mapping.name} needs {mapping.arity} different bound variables, "
            f"got {used} with {n_bound} bound"
        )
    if mapping.space == "category":
        _check_category(index, node)
    shape = "arc" if mapping.space == "circle" else "ellipsoid"
    fits = type(node.volume).__name__.lower() == shape or (isinstance(node.volume, Slab) and shape != "arc")
    if node.volume.dim != mapping.dim or not fits:
        raise InputError(f"node {index}: {mapping.name} needs an {shape} in {mapping.dim} dimension(s)")
    axes = [bounds.axis for bounds in node.bounds]
    dim = 0 if isinstance(node.volume, Arc) else mapping.dim
    if len(set(axes)) != len(axes) or not all(0 <= axis < dim for axis in axes):
        raise InputError(
            f"node {index}: its bounds must be about different coordinates of the {dim} that it has"
        )


def _check_category(index: int, node: Question) -> None:
    mapping, volume = node.mapping, node.volume
    n = 2 if mapping.operation == "same" else len(mapping.attribute.categories)
    if isinstance(volume, Ellipsoid) and volume.dim == 1 and volume.mean[0] in range(n):
        number = int(volume.mean[0])
        if np.array_equal(volume.contains(np.arange(n)[:, None]), np.arange(n) == number):
            return
    raise InputError(f"node {index}: the volume of {mapping.name} must contain one category and no other")


def _preorder(nodes: tuple[Node, ...]) -> list[int]:
    order: list[int] = []
    stack = [0]
    while stack:
        index = stack.pop()
        order.append(index)
        stack.extend(reversed(children(nodes[index])))
    return order
