"""Trees of conditions as arrays, the form that the evaluation kernels read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.forests.scene_tree import SceneTree, Value
from relforest.forests.statements import Bound, Near, Statement

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.forests.conditions import Condition
    from relforest.scenes import Schema

# Columns of `Packed.statements`.
OPERATION: Final = 0
CIRCULAR: Final = 1
FIRST: Final = 2
DIM: Final = 3
VARIABLES: Final = 4  # three, -1 = unused
TEST: Final = 7
COMPONENT: Final = 8
N_COMPONENTS: Final = 9

AT_MOST: Final = 0
AT_LEAST: Final = 1
SMALL: Final = 2
LARGE: Final = 3
NEAR: Final = 4
IS: Final = 5
IS_NOT: Final = 6

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
    """Trees one after the other; child indices count from the first node of all trees."""

    statements: NDArray[np.int64]  # (n_statements, 10)
    numbers: NDArray[np.float64]  # (n_statements, 4): limit or category; or two centres, two radii
    conditions: NDArray[np.int64]  # (n_conditions, 4)
    nodes: NDArray[np.int64]  # (n_nodes, 4)
    roots: NDArray[np.int64]  # (n_trees,)


def pack(schema: Schema, trees: tuple[SceneTree, ...]) -> Packed:
    """Return trees as arrays."""
    statements: list[list[int]] = []
    numbers: list[list[float]] = []
    conditions: list[tuple[int, int, int, int]] = []
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
            begin = len(statements)
            for statement in node.condition.statements:
                row, values = _statement(schema, statement)
                statements.append(row)
                numbers.append(values)
            asked: Condition = node.condition
            nodes.append((len(conditions), root + node.yes, root + node.no, -1))
            conditions.append((begin, len(statements), asked.n_free, 0 if asked.every else asked.at_least))
    return Packed(
        np.array(statements, dtype=np.int64).reshape(-1, 10),
        np.array(numbers, dtype=np.float64).reshape(-1, 4),
        np.array(conditions, dtype=np.int64).reshape(-1, 4),
        np.array(nodes, dtype=np.int64).reshape(-1, 4),
        np.array(roots, dtype=np.int64),
    )


def _statement(schema: Schema, statement: Statement) -> tuple[list[int], list[float]]:
    mapping, test = statement.mapping, statement.test
    variables = [*statement.variables, -1, -1][:3]
    component, n_components = 0, 1
    if isinstance(test, Bound):
        kind = (AT_MOST if test.side == "at most" else AT_LEAST) + (SMALL if test.absolute else 0)
        component, numbers = test.component, [test.limit, 0.0, 0.0, 0.0]
    elif isinstance(test, Near):
        kind, component, n_components = NEAR, test.component, len(test.centre)
        numbers = [*test.centre, 0.0][:2] + [*test.radii, 1.0][:2]
    else:
        kind, numbers = (IS_NOT if test.negated else IS), [float(test.category), 0.0, 0.0, 0.0]
    row = [
        mapping.rule.code,
        int(mapping.space == "circle"),
        schema.offset(mapping.attribute.name),
        mapping.attribute.dim,
        *variables,
        kind,
        component,
        n_components,
    ]
    return row, numbers
