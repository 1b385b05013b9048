"""Tree inference: instantiation sequences a second, microseconds for a single scene and for many objects."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from clock import median_seconds
from peers import tree as twin
from table import Cell, Table

from relforest.forests.tree_features import width
from relforest.mappings import Mapping
from relforest.rl.kernels import forest_values
from relforest.rl.value import ValueFunction
from relforest.scenes import Attribute, Scenes, Schema
from relforest.smdp import ActionType, Decision
from relforest.support.parallel import one_blas_thread
from relforest.trees import Instantiation, Leaf, Node, Question, Tree, query
from relforest.trees.kernels import query_work
from relforest.volumes import Ellipsoid

ATTRIBUTES = (Attribute("location", 2), Attribute("color", 3))
SCHEMA = Schema(ATTRIBUTES, parameters=("A",))
REPEATS = 15
SCENES = 1000
TWIN_SCENES = 60
MANY = (10, 30, 100, 300, 1000)


def ball(dim: int, centre: float, radius: float) -> Ellipsoid:
    """Return a slightly oblique decision volume."""
    covariance = np.eye(dim) + 0.3 * (np.ones((dim, dim)) - np.eye(dim))
    return Ellipsoid(np.full(dim, centre), covariance, radius, 10, 0.1)


def example_tree(*, error_probability: float) -> Tree:
    """Return a tree of three variables, the first an argument, and five questions.

    Error leaves are never reached here. If they are the least probable, the query can skip branches that hold
    no leaf better than one already reached; if they are the most probable, it has to follow every sequence.
    """
    location, color = ATTRIBUTES
    error = Leaf(error_probability, 0, 0)
    leaves = [Leaf(probability, 0, 0) for probability in (0.9, 0.6, 0.5, 0.3, 0.4, 0.2)]
    nodes: tuple[Node, ...] = (
        Instantiation(1),
        Instantiation(2),
        Question(Mapping("distance", location), (0, 1), ball(1, 0.0, 4.0), 3, 14, 19),
        Instantiation(4),
        Question(Mapping("scaled_reframe", location), (0, 1, 2), ball(2, 0.3, 0.4), 5, 9, 13),
        Question(Mapping("difference", color), (1, 2), ball(3, 0.0, 0.4), 6, 7, 8),
        *leaves[:2],
        error,
        Question(Mapping("identity", color), (2,), ball(3, 0.8, 0.4), 10, 11, 12),
        *leaves[2:4],
        error,
        error,
        Instantiation(15),
        Question(Mapping("difference", location), (1, 2), ball(2, 0.0, 3.0), 16, 17, 18),
        *leaves[4:],
        error,
        error,
    )
    return Tree(SCHEMA, nodes)


def random_scenes(n_scenes: int, n_objects: int) -> Scenes:
    """Return scenes of random locations in [0, 10]^2 and colors, the first object bound to the argument."""
    rng = np.random.default_rng(0)
    n_rows = n_scenes * n_objects
    matrix = np.column_stack([rng.uniform(0, 10, size=(n_rows, 2)), rng.random((n_rows, 3))])
    starts = np.arange(n_scenes) * n_objects
    counts = np.full(n_scenes, n_objects)
    return Scenes(SCHEMA, matrix, np.arange(n_rows), starts, counts, starts[:, np.newaxis].copy())


def measure_batch(name: str, tree: Tree, n_objects: int) -> tuple[Cell, ...]:
    """Time a batch of scenes with the compiled query and with its twin."""
    n_scenes = SCENES * 10 // n_objects
    scenes = random_scenes(n_scenes, n_objects)
    compiled = median_seconds(lambda batch: query(tree, batch), [scenes] * REPEATS) / n_scenes
    few = [scenes.take([scene]) for scene in range(TWIN_SCENES * 10 // n_objects)]
    n_sequences = float(np.mean([twin.query(tree, scene)[0].n_sequences for scene in few]))
    plain = median_seconds(lambda scene: twin.query(tree, scene), few)
    microseconds = (1e6 * compiled, 1e6 * plain)
    return name, n_objects, n_sequences, n_sequences / compiled / 1e6, *microseconds, plain / compiled


def measure_pairs() -> tuple[tuple[Cell, ...], ...]:
    """Time a question about two objects, in microseconds a scene, and fit the growth from 100 objects on."""
    location = ATTRIBUTES[0]
    rows: list[tuple[Cell, ...]] = []
    for operation, variables, volume in (
        ("identity", (1,), ball(2, 5.0, 0.1)),
        ("difference", (0, 1), ball(2, 1.0, 0.1)),
        ("distance", (0, 1), ball(1, 0.0, 0.1)),
        ("distance from 2", (0, 1), ball(1, 2.0, 0.1)),
    ):
        question = Question(Mapping(operation.split()[0], location), variables, volume, 3, 4, 5)
        for winner, probabilities in (("Yes", (0.9, 0.1, 0.5)), ("No", (0.1, 0.9, 0.5))):
            leaves = [Leaf(probability, 0, 0) for probability in probabilities]
            tree = Tree(Schema(ATTRIBUTES), (Instantiation(1), Instantiation(2), question, *leaves))
            microseconds = []
            for n_objects in MANY:
                drawn = random_scenes(max(1000 // n_objects, 4), n_objects)
                scenes = Scenes(tree.schema, drawn.matrix, drawn.rows, drawn.starts, drawn.counts)
                seconds = median_seconds(partial(query, tree), [scenes] * 5)
                microseconds.append(1e6 * seconds / len(scenes))
            slope = np.polyfit(np.log(MANY[2:]), np.log(microseconds[2:]), 1)[0]
            rows.append((operation, winner, *microseconds, float(slope)))
    return tuple(rows)


def measure_single(tree: Tree, n_objects: int) -> tuple[tuple[Cell, ...], ...]:
    """Time the calls that answer for one scene, in microseconds."""
    scene = random_scenes(1, n_objects)
    actions = (ActionType("act", SCHEMA.parameters),)
    weights = np.linspace(0.1, 1, 1 + width(tree, "densities+bits"))
    value = ValueFunction(Schema(ATTRIBUTES), actions, "densities+bits", ((tree,),), (weights,))
    (forest,) = value._packed  # noqa: SLF001 - what `values` hands to the kernel
    arguments, out = np.zeros((1, 1), dtype=np.int64), np.empty(1)
    decision = Decision(scene.matrix, np.zeros(1, dtype=np.int64), arguments, np.zeros(1, dtype=np.int64))
    rows, work, place = np.arange(n_objects), query_work(*forest.sizes), np.zeros(2, dtype=np.int64)

    def kernel(_: int) -> None:
        place[:] = 0
        forest_values(forest, scene.matrix, rows, arguments, work, out, place)

    calls: Sequence[tuple[str, float]] = (
        ("kernel call of a policy (forest_values)", median_seconds(kernel, range(REPEATS), calls=500)),
        (
            "ValueFunction.values, one action",
            median_seconds(lambda _: value.values(decision), range(REPEATS), calls=300),
        ),
        ("query, a batch of one", median_seconds(lambda _: query(tree, scene), range(REPEATS), calls=300)),
    )
    return tuple((name, n_objects, 1e6 * seconds) for name, seconds in calls)


def run() -> tuple[Table, Table, Table]:
    """Measure batches, single scenes and scenes of many objects."""
    skipping, following = example_tree(error_probability=0.0), example_tree(error_probability=0.99)
    with one_blas_thread():
        batches = tuple(
            measure_batch(name, tree, n_objects)
            for n_objects in (10, 30, 100)
            for name, tree in (
                ("hopeless branches skipped", skipping),
                ("every sequence followed", following),
            )
        )
        singles = measure_single(skipping, 10) + measure_single(following, 10)
        pairs = measure_pairs()
    columns = (
        "tree of 5 questions",
        "objects",
        "sequences a scene",
        "M sequences/s",
        "us a scene",
        "NumPy twin us",
        "times faster",
    )
    aim = "Aim with 10 objects: at least 8 M sequences/s and 20 times faster than the twin."
    single_aim = "Aim: the kernel call of a policy below 20 us. First skipping branches, then following all."
    pair_aim = (
        "Aim: an exponent of at most 1.3 from 100 objects on. In the plane, all places at a distance of 2 "
        "form a circle, which boxes search in about n^1.5."
    )
    pair_columns = ("question about two", "wins", *(f"us, {n} objects" for n in MANY), "exponent")
    return (
        Table("tree", aim, columns, batches),
        Table("tree-single", single_aim, ("call", "objects", "us a call"), singles),
        Table("tree-pairs", pair_aim, pair_columns, pairs),
    )


if __name__ == "__main__":
    for table in run():
        table.report()
