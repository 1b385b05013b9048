"""Whether a list of nodes is a tree that a schema can answer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from relforest.support.errors import InputError
from relforest.trees.nodes import Instantiation, Node, Question, children

if TYPE_CHECKING:
    from relforest.scenes import Schema

# What is remembered grows with the square of a branch's length, which a hostile file could exploit.
MAX_DEPTH: Final = 1000


def check_structure(schema: Schema, nodes: tuple[Node, ...]) -> tuple[list[int], list[tuple[int, ...]]]:
    """Check the nodes of a tree and return what stands above each of them.

    Returns
    -------
    (list of int, list of tuple of int)
        For each node the number of variables bound, and the indices of the questions above, root first.

    Raises
    ------
    InputError
        If the nodes do not form one tree in depth-first order, a branch asks more than `MAX_DEPTH`
        questions, or a question does not fit the schema, its variables or its volume.
    """
    if not nodes:
        msg = "a tree needs at least one node"
        raise InputError(msg)
    bound = [-1] * len(nodes)
    above: list[tuple[int, ...]] = [()] * len(nodes)
    bound[0] = 0
    for i, node in enumerate(nodes):
        if bound[i] < 0:
            msg = f"node {i} has no parent before it: list the nodes depth first"
            raise InputError(msg)
        if isinstance(node, Question):
            _check_question(schema, i, node, bound[i])
        path = (*above[i], i) if isinstance(node, Question) else above[i]
        if len(path) > MAX_DEPTH:
            msg = f"node {i} is question number {len(path)} of its branch: at most {MAX_DEPTH} are allowed"
            raise InputError(msg)
        for child in children(node):
            if not i < child < len(nodes) or bound[child] >= 0:
                msg = f"node {i} points to node {child}: every node needs one parent, before it in the list"
                raise InputError(msg)
            bound[child] = bound[i] + isinstance(node, Instantiation)
            above[child] = path
    if _preorder(nodes) != list(range(len(nodes))):
        msg = "the nodes are not in depth-first order (Yes, No, Error)"
        raise InputError(msg)
    return bound, above


def _check_question(schema: Schema, index: int, node: Question, n_bound: int) -> None:
    mapping = node.mapping
    if mapping.attribute not in schema.attributes:
        msg = f"node {index} asks for {mapping.name}, but the schema has no such attribute"
        raise InputError(msg)
    used = node.variables
    if len(used) != mapping.arity or len(set(used)) != len(used) or not all(0 <= v < n_bound for v in used):
        msg = (
            f"node {index}: {mapping.name} needs {mapping.arity} different bound variables, "
            f"got {used} with {n_bound} bound"
        )
        raise InputError(msg)
    shape = "arc" if mapping.space == "circle" else "ellipsoid"
    if node.volume.dim != mapping.dim or type(node.volume).__name__.lower() != shape:
        msg = f"node {index}: {mapping.name} needs an {shape} in {mapping.dim} dimension(s)"
        raise InputError(msg)


def _preorder(nodes: tuple[Node, ...]) -> list[int]:
    order: list[int] = []
    stack = [0]
    while stack:
        index = stack.pop()
        order.append(index)
        stack.extend(reversed(children(nodes[index])))
    return order
