"""Trees of conditions as arrays, the form that the evaluation kernels read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.forests.forms import AT_LEAST, AT_MOST, IS, IS_NOT, N_NUMBERS, NEAR, NEAR_ANGLE, SMALL
from relforest.forests.scene_tree import SceneTree, Value
from relforest.forests.statements import Bound, Is, Near, Statement, Test
from relforest.mappings.related import RELATED, Related

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from relforest.forests.conditions import Condition
    from relforest.scenes import Schema

# Columns of `Packed.statements`.
OPERATION: Final = 0
CIRCULAR: Final = 1
OFFSET: Final = 2  # of a relation, its number
DIM: Final = 3  # of a relation, of how many objects
VARIABLES: Final = 4  # three, -1 = unused
N_COLUMNS: Final = 7

# Columns of `Packed.conditions`.
BEGIN: Final = 0  # first statement
END: Final = 1
N_FREE: Final = 2
COUNT: Final = 3  # 0 = one for every first object

# Columns of `Packed.nodes`.
CONDITION: Final = 0  # -1 = leaf
YES: Final = 1
NO: Final = 2
LEAF: Final = 3  # number of the leaf in its tree


class Packed(NamedTuple):
    """Trees one after the other; child indices count from the first node of all trees.

    `points` are the different mappings, so that what several statements are about is computed once.
    """

    statements: NDArray[np.int64]  # (n_statements, N_COLUMNS): the mapping
    points: NDArray[np.int64]  # (n_points, N_COLUMNS)
    point_of: NDArray[np.int64]  # (n_statements,): the row of `points`
    numbers: NDArray[np.float64]  # (n_statements, N_NUMBERS): what its components must be
    conditions: NDArray[np.int64]  # (n_conditions, 4)
    nodes: NDArray[np.int64]  # (n_nodes, 4)
    roots: NDArray[np.int64]  # (n_trees,)


def pack(schema: Schema, trees: tuple[SceneTree, ...]) -> Packed:
    """Return trees as arrays."""
    asked: list[Condition] = []
    nodes: list[tuple[int, int, int, int]] = []
    roots = []
    for tree in trees:
        root, n_leaves = len(nodes), 0
        roots.append(root)
        for node in tree.nodes:
            if isinstance(node, Value):
                nodes.append((-1, -1, -1, n_leaves))
                n_leaves += 1
                continue
            nodes.append((len(asked), root + node.yes, root + node.no, -1))
            asked.append(node.condition)
    return pack_conditions(schema, asked)._replace(
        nodes=np.array(nodes, dtype=np.int64).reshape(-1, 4), roots=np.array(roots, dtype=np.int64)
    )


def pack_conditions(schema: Schema, asked: Sequence[Condition]) -> Packed:
    """Return conditions as arrays, without trees."""
    statements: list[list[int]] = []
    numbers: list[list[float]] = []
    conditions: list[tuple[int, int, int, int]] = []
    for condition in asked:
        begin = len(statements)
        for statement in condition.statements:
            row, values = _statement(schema, statement)
            statements.append(row)
            numbers.append(values)
        needed = 0 if condition.every else condition.at_least
        conditions.append((begin, len(statements), condition.n_free, needed))
    mapped = np.array(statements, dtype=np.int64).reshape(-1, N_COLUMNS)
    points, point_of = np.unique(mapped, axis=0, return_inverse=True)
    return Packed(
        mapped,
        points,
        point_of.reshape(-1),
        np.array(numbers, dtype=np.float64).reshape(-1, N_NUMBERS),
        np.array(conditions, dtype=np.int64).reshape(-1, 4),
        np.empty((0, 4), dtype=np.int64),
        np.empty(0, dtype=np.int64),
    )


def _statement(schema: Schema, statement: Statement) -> tuple[list[int], list[float]]:
    mapping = statement.mapping
    if isinstance(mapping, Related):
        number = schema.relations.index(mapping.relation)
        variables = [*statement.variables, -1, -1][:3]
        return [RELATED, 0, number, mapping.arity, *variables], _numbers(statement.test, is_circular=False)
    row = [
        mapping.rule.code,
        int(mapping.space == "circle"),
        schema.offset(mapping.attribute.name),
        mapping.attribute.dim,
        *[*statement.variables, -1, -1][:3],
    ]
    return row, _numbers(statement.test, is_circular=mapping.space == "circle")


def _numbers(test: Test, *, is_circular: bool) -> list[float]:
    """Return a test as a row of numbers, see `relforest.forests.forms`."""
    match test:
        case Bound(component, side, limit, absolute):
            form = (AT_MOST if side == "at most" else AT_LEAST) + (SMALL if absolute else 0)
            return [form, component, -1, 0.0, 0.0, 0.0, 0.0, limit if side == "at most" else -limit]
        case Near(component, centre, radii):
            weights = [1.0 / radius**2 for radius in radii]
            second = component + 1 if len(centre) == 2 else -1
            form = NEAR_ANGLE if is_circular else NEAR
            return [form, component, second, *[*centre, 0.0][:2], *[*weights, 1.0][:2], 1.0]
        case Is(category, negated):
            return [IS_NOT if negated else IS, 0, -1, category, 0.0, 0.0, 0.0, 0.5]
