"""Random trees that ask questions of all mappings, and scenes for them."""

from __future__ import annotations

import numpy as np

from relforest.mappings import Mapping
from relforest.scenes import Attribute, Scenes, Schema
from relforest.trees import Instantiation, Leaf, Node, Question, Tree
from relforest.volumes import Arc, Ellipsoid, Volume

ATTRIBUTES = (
    Attribute("location", 2),
    Attribute("altitude"),
    Attribute("color", 3),
    Attribute("orientation"),
)


def random_volume(rng: np.random.Generator, mapping: Mapping) -> Volume:
    if mapping.space == "circle":
        return Arc(float(rng.uniform(-np.pi, np.pi)), float(rng.uniform(0.5, 2.5)), float(rng.uniform(0, 4)))
    root = rng.standard_normal((mapping.dim, mapping.dim))
    covariance = root @ root.T + 0.1 * np.eye(mapping.dim)
    # Wide enough that a fair share of standard normal points lies inside.
    radius = float(np.sqrt(mapping.dim) * rng.uniform(0.5, 3))
    return Ellipsoid(rng.standard_normal(mapping.dim), covariance, radius, int(rng.integers(1, 6)), 0.1)


def random_question(rng: np.random.Generator, n_bound: int) -> tuple[Mapping, tuple[int, ...]]:
    possible = [
        mapping
        for attribute in ATTRIBUTES
        for operation in attribute.operations
        if (mapping := Mapping(operation, attribute)).arity <= n_bound
    ]
    mapping = possible[rng.integers(len(possible))]
    variables = rng.permutation(n_bound)[: mapping.arity]
    return mapping, tuple(int(variable) for variable in variables)


def random_tree(rng: np.random.Generator, n_parameters: int, most_questions: int = 3) -> Tree:
    nodes: list[Node] = []

    def add(node: Node) -> int:
        nodes.append(node)
        return len(nodes) - 1

    def grow(n_bound: int, questions_left: int, *, stop: float = 0.3) -> int:
        if questions_left == 0 or rng.random() < stop:
            # Few different probabilities, so that leaves tie.
            return add(Leaf(float(rng.choice([0.0, 0.2, 0.5, 0.9])), 0, 0))
        first = len(nodes)
        fewest = 1 if n_bound == 0 else 0
        for _ in range(int(rng.integers(fewest, 3)) if n_bound < 3 else 0):
            add(Instantiation(len(nodes) + 1))
            n_bound += 1
        mapping, variables = random_question(rng, n_bound)
        here = add(Leaf(0.0, 0, 0))
        volume = random_volume(rng, mapping)
        yes, no, error = (grow(n_bound, questions_left - 1) for _ in range(3))
        nodes[here] = Question(mapping, variables, volume, yes, no, error)
        return first

    grow(0, most_questions, stop=0.0)
    return Tree(Schema(ATTRIBUTES, [f"arg{i}" for i in range(n_parameters)]), tuple(nodes))


def random_scenes(
    rng: np.random.Generator, n_parameters: int, n_scenes: int = 12, n_rows: int = 20, most: int = 5
) -> Scenes:
    """Scenes of 0 to `most` objects that share rows; some values undefined, some arguments not bound."""
    schema = Schema(ATTRIBUTES, [f"arg{i}" for i in range(n_parameters)])
    matrix = rng.standard_normal((n_rows, schema.width))
    for attribute in ATTRIBUTES:
        matrix[rng.random(n_rows) < 0.1, schema.columns(attribute.name)] = np.nan
    counts = rng.integers(0, most + 1, size=n_scenes)
    chosen = [rng.permutation(n_rows)[:count] for count in counts]
    arguments = np.full((n_scenes, n_parameters), -1)
    for scene, objects in enumerate(chosen):
        bound = rng.permutation(objects)[:n_parameters]
        arguments[scene, : len(bound)] = bound
        arguments[scene, rng.random(n_parameters) < 0.1] = -1
    return Scenes(schema, matrix, np.concatenate(chosen), np.cumsum(counts) - counts, counts, arguments)
