"""Scenes, statements and conditions of every form, at random, and what they mean, one choice at a time."""

from __future__ import annotations

import math
from itertools import permutations

import numpy as np

from relforest.forests import Condition
from relforest.forests.statements import Bound, Is, Near, Statement
from relforest.mappings import Mapping, Related
from relforest.scenes import Attribute, Relation, Scenes, Schema

TEAM = Attribute("team", kind="category", categories=["home", "guest", "referee"])
ATTRIBUTES = (
    Attribute("location", 2, operations=[*Attribute("location", 2).operations, "bearing", "scaled_distance"]),
    Attribute("weight"),
    Attribute("heading", kind="angle", operations=["identity", "difference"]),
    TEAM,
)
RELATIONS = (Relation("touches"), Relation("passes to", directed=True))


def random_scenes(
    rng: np.random.Generator, n_scenes: int, n_parameters: int, most: int = 5, undefined: float = 0.1
) -> Scenes:
    """Scenes of 0 to `most` objects with attributes of all kinds; few different values, so that some tie."""
    schema = Schema(ATTRIBUTES, ["passer", "receiver"][:n_parameters])
    counts = rng.integers(0, most + 1, n_scenes)
    starts = np.cumsum(counts) - counts
    n = int(counts.sum())
    matrix = np.column_stack(
        [
            rng.integers(-3, 4, (n, 2)),
            rng.integers(0, 5, n),
            rng.uniform(-3, 3, n),
            rng.integers(0, 3, n),
        ]
    ).astype(np.float64)
    matrix[rng.random(matrix.shape) < undefined] = np.nan
    arguments = np.full((n_scenes, n_parameters), -1, dtype=np.int64)
    for scene in np.flatnonzero(counts):
        arguments[scene] = starts[scene] + rng.integers(0, counts[scene], n_parameters)
    return Scenes(schema, matrix, np.arange(n), starts, counts, arguments)


def related(rng: np.random.Generator, scenes: Scenes, share: float = 0.4) -> Scenes:
    """The same scenes with a share of all possible pairs in each of `RELATIONS`."""
    pairs: dict[str | Relation, object] = {}
    for relation in RELATIONS:
        pairs[relation] = [
            (scenes.scene_ids[scene], scenes.object_ids[one], scenes.object_ids[other])
            for scene in range(len(scenes))
            for one, other in permutations(scenes.objects(scene).tolist(), 2)
            if (relation.directed or one < other) and rng.random() < share
        ]
    return scenes.with_relations(pairs)


def random_condition(
    rng: np.random.Generator, n_parameters: int, relations: tuple[Relation, ...] = ()
) -> Condition:
    """A condition of any form."""
    n_free = int(rng.integers(0 if n_parameters else 1, 3))
    n_bound = n_parameters + n_free
    statements = tuple(random_statement(rng, n_bound, relations) for _ in range(int(rng.integers(1, 4))))
    if n_free == 2 and rng.random() < 0.3:
        return Condition(n_free, statements, every=True)
    return Condition(n_free, statements, int(rng.integers(1, 4)) if n_free else 1)


def random_statement(
    rng: np.random.Generator, n_bound: int, relations: tuple[Relation, ...] = ()
) -> Statement:
    """A statement about some of the bound objects, as often about a relation, if there are any, as not."""
    if relations and n_bound > 1 and rng.random() < 0.5:
        relation = relations[int(rng.integers(len(relations)))]
        arity = int(rng.integers(1, 3))
        chosen = tuple(rng.permutation(n_bound)[:arity].tolist())
        return Statement(Related(relation, arity), chosen, Is(int(rng.integers(2)), bool(rng.integers(2))))
    mappings = [Mapping(operation, each) for each in ATTRIBUTES for operation in each.operations]
    possible = [mapping for mapping in mappings if mapping.arity <= n_bound]
    mapping = possible[int(rng.integers(len(possible)))]
    variables = tuple(rng.permutation(n_bound)[: mapping.arity].tolist())
    return Statement(mapping, variables, _random_test(rng, mapping))


def _random_test(rng: np.random.Generator, mapping: Mapping) -> Bound | Near | Is:
    if mapping.attribute.kind == "category":
        n_values = 2 if mapping.operation == "same" else 3
        return Is(int(rng.integers(n_values)), bool(rng.integers(2)))
    component = int(rng.integers(mapping.dim))
    if mapping.space == "circle" or rng.random() < 0.3:
        dim = int(rng.integers(1, mapping.dim - component + 1))
        return Near(component, tuple(rng.uniform(-2, 2, dim)), tuple(rng.uniform(0.5, 3, dim)))
    side = ("at most", "at least")[int(rng.integers(2))]
    return Bound(component, side, float(rng.uniform(-1, 2)), bool(rng.integers(2)))  # type: ignore[arg-type]


def is_true(statement: Statement, scenes: Scenes, rows: tuple[int, ...]) -> bool:
    """Whether a statement is true of object rows, by its definition."""
    mapping, test = statement.mapping, statement.test
    if isinstance(mapping, Related):
        assert isinstance(test, Is)
        own = [rows[variable] for variable in statement.variables]
        # The objects of different scenes are different ones here.
        is_related = any(own == pair[: mapping.arity] for pair in scenes.relations[mapping.name].tolist())
        return min(own) >= 0 and (is_related == test.category) != test.negated
    chosen = np.array([[rows[variable] for variable in statement.variables]])
    point = mapping.evaluate(scenes.schema, scenes.matrix, chosen)[0]
    if np.isnan(point).any():
        return False
    if isinstance(test, Is):
        return bool(point[0] == test.category) != test.negated
    if isinstance(test, Bound):
        x = abs(point[test.component]) if test.absolute else point[test.component]
        return bool(x <= test.limit if test.side == "at most" else x >= test.limit)
    offsets = [point[test.component + i] - centre for i, centre in enumerate(test.centre)]
    if mapping.space == "circle":
        offsets = [math.remainder(offset, 2 * math.pi) for offset in offsets]
    squares = [(offset / radius) ** 2 for offset, radius in zip(offsets, test.radii, strict=True)]
    return bool(sum(squares) <= 1.0)


def holds(condition: Condition, scenes: Scenes, scene: int) -> bool:
    """Whether a condition holds in a scene, by its definition."""
    bound = scenes.arguments[scene].tolist()
    free = [row for row in scenes.objects(scene).tolist() if row not in bound]
    if condition.every:
        pairs = [[(one, other) for other in free if other != one] for one in free]
        found = [[_all_true(condition, scenes, (*bound, *pair)) for pair in own] for own in pairs]
        return bool(free) and all(map(any, found))
    true = [
        _all_true(condition, scenes, (*bound, *chosen)) for chosen in permutations(free, condition.n_free)
    ]
    return sum(true) >= condition.at_least


def _all_true(condition: Condition, scenes: Scenes, rows: tuple[int, ...]) -> bool:
    return all(is_true(statement, scenes, rows) for statement in condition.statements)
