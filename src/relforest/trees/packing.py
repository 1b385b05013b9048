"""A tree as two arrays, the form that kernels read."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.mappings.operations import DIFFERENCE, DISTANCE, IDENTITY
from relforest.trees.nodes import AnyLeaf, Instantiation, Node, Question, children
from relforest.volumes import Arc, Ellipsoid

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.scenes import Schema
    from relforest.volumes import Volume

LEAF: Final = 0
INSTANTIATION: Final = 1
QUESTION: Final = 2

NODE_TYPE: Final = 0
OPERATION: Final = 1  # code of the mapping's operation
CIRCULAR: Final = 2  # 1 if the codomain is the circle
FIRST: Final = 3  # first column of the attribute
ATTRIBUTE_DIM: Final = 4
DIM: Final = 5  # dimension of the codomain
VARIABLES: Final = 6  # three columns, -1 = unused
CHILDREN: Final = 9  # three columns: yes, no, error; an instantiation's child in the first
VOLUME: Final = 12  # where the volume begins in `numbers`
RANK: Final = 13  # rank of the most probable leaf at or below this node, 0 = most probable of the tree
ORDINAL: Final = 14  # a leaf's place among the leaves
SLOT: Final = 15  # of an instantiation followed by a question that boxes answer: number of its attribute
N_COLUMNS: Final = 16


class PackedTree(NamedTuple):
    """One row of `nodes` per node, in the order of the tree, and the numbers of all volumes end to end.

    A volume is stored as squared radius, sharpness of the density, mean (d), precision (d * d).
    """

    nodes: NDArray[np.int64]  # (n_nodes, N_COLUMNS)
    numbers: NDArray[np.float64]  # (n_numbers,)
    n_variables: int
    n_asked: int  # most questions on a branch
    n_dims: int  # largest dimension of a codomain
    boxed: tuple[int, int]  # attributes that boxes answer questions about, and their largest dimension


def pack(schema: Schema, nodes: tuple[Node, ...]) -> PackedTree:
    """Pack the nodes of a tree."""
    table = np.full((len(nodes), N_COLUMNS), -1, dtype=np.int64)
    numbers: list[NDArray[np.float64]] = []
    bound, asked = np.zeros(len(nodes), dtype=np.int64), np.zeros(len(nodes), dtype=np.int64)
    used, ordinal = 0, 0
    slots: dict[str, int] = {}
    boxed_dim = 1
    ends = accumulate((attribute.dim for attribute in schema.attributes), initial=0)
    first = dict(zip(schema.names, ends, strict=False))
    for i, node in enumerate(nodes):
        row = table[i]
        for answer, child in enumerate(children(node)):
            row[CHILDREN + answer] = child
            bound[child] = bound[i] + isinstance(node, Instantiation)
            asked[child] = asked[i] + isinstance(node, Question)
        match node:
            case AnyLeaf():
                row[NODE_TYPE], row[ORDINAL] = LEAF, ordinal
                ordinal += 1
            case Instantiation():
                row[NODE_TYPE] = INSTANTIATION
                question, variable = nodes[node.child], int(bound[i])
                # The first free variable is searched for only once.
                is_repeated = variable > schema.n_parameters
                if is_repeated and isinstance(question, Question) and _suits_boxes(question, variable):
                    attribute = question.mapping.attribute
                    row[SLOT] = slots.setdefault(attribute.name, len(slots))
                    boxed_dim = max(boxed_dim, attribute.dim)
            case Question():
                _pack_question(node, first[node.mapping.attribute.name], row)
                row[VOLUME] = used
                numbers.append(_volume_numbers(node.volume))
                used += len(numbers[-1])
    _rank(nodes, table)
    return PackedTree(
        table,
        np.concatenate(numbers) if numbers else np.empty(0),
        int(bound.max()),
        int(asked.max()),
        max((node.mapping.dim for node in nodes if isinstance(node, Question)), default=1),
        (len(slots), boxed_dim),
    )


def pack_question(schema: Schema, question: Question) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return nodes and numbers as `pack` does, of a single question without what follows from its answers."""
    table = np.full((1, N_COLUMNS), -1, dtype=np.int64)
    _pack_question(question, schema.offset(question.mapping.attribute.name), table[0])
    table[0, VOLUME] = 0
    return table, _volume_numbers(question.volume)


def _pack_question(node: Question, first: int, row: NDArray[np.int64]) -> None:
    attribute = node.mapping.attribute
    row[NODE_TYPE] = QUESTION
    row[OPERATION] = node.mapping.rule.code
    row[CIRCULAR] = node.mapping.space == "circle"
    row[FIRST] = first
    row[ATTRIBUTE_DIM] = attribute.dim
    row[DIM] = node.mapping.dim
    row[VARIABLES : VARIABLES + len(node.variables)] = node.variables


def _volume_numbers(volume: Volume) -> NDArray[np.float64]:
    if isinstance(volume, Arc):
        return np.array([volume.radius * volume.radius, volume.kappa, volume.mean, 1.0])
    head = [volume.radius * volume.radius, volume.density_sharpness]
    return np.concatenate([head, volume.mean, volume.precision.ravel()])


def _suits_boxes(question: Question, variable: int) -> bool:
    mapping, volume = question.mapping, question.volume
    if mapping.rule.code not in (IDENTITY, DIFFERENCE, DISTANCE) or variable not in question.variables:
        return False
    # A matrix that is singular but for rounding defines no distance.
    return isinstance(volume, Ellipsoid) and bool(np.linalg.cond(volume.precision) < 1e12)


def _rank(nodes: tuple[Node, ...], table: NDArray[np.int64]) -> None:
    leaves = [i for i, node in enumerate(nodes) if isinstance(node, AnyLeaf)]
    probabilities = [node.probability for node in nodes if isinstance(node, AnyLeaf)]
    for rank, place in enumerate(np.argsort(-np.array(probabilities), kind="stable")):
        table[leaves[place], RANK] = rank
    for i in range(len(nodes) - 1, -1, -1):
        below = children(nodes[i])
        if below:
            table[i, RANK] = min(table[child, RANK] for child in below)
