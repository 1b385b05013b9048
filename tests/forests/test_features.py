"""Features of ensembles: what they mean, and what they are called."""

from __future__ import annotations

import math
from itertools import permutations
from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray
from sklearn.frozen import FrozenEstimator
from sklearn.linear_model import LogisticRegression
from sklearn.pipeline import make_pipeline

from forest_scenes import holds, is_true, random_condition, random_scenes
from forests.team_scenes import guest_on_the_left, scenes_of
from random_trees import random_question, random_tree, random_volume
from random_trees import random_scenes as scenes_for_trees
from relforest import SMRFForestClassifier, SMRFTreeClassifier
from relforest.forests import Condition, Ensemble, SceneFeatures, SceneTree, Split, Value
from relforest.forests.features import MODES, Mode, feature_names, features
from relforest.forests.question_measures import question_measures
from relforest.forests.statements import Bound, Is, Near, Statement
from relforest.forests.tree_features import tree_features
from relforest.mappings import Mapping
from relforest.scenes import Attribute, Scenes, Schema
from relforest.support.errors import InputError
from relforest.trees import Instantiation, Leaf, Question, Tree, query
from relforest.volumes import Ellipsoid
from small_trees import NOWHERE, near_tree, plane, scenes_in


def tree_of(condition: Condition) -> SceneTree:
    return SceneTree((Split(condition, 1, 2, 0.0), Value((1.0,), 0), Value((0.0,), 0)))


def ensemble_of(schema: Schema, *trees: SceneTree | Tree) -> Ensemble:
    return Ensemble(schema, np.zeros(1), trees, np.ones(len(trees)))


def excess(statement: Statement, scenes: Scenes, rows: tuple[int, ...]) -> float:
    """How far a statement about object rows is from being true, by its definition."""
    mapping, test = cast("Mapping", statement.mapping), statement.test
    chosen = np.array([[rows[variable] for variable in statement.variables]])
    point = mapping.evaluate(scenes.schema, scenes.matrix, chosen)[0]
    if np.isnan(point).any():
        return math.nan
    if isinstance(test, Is):
        return -1.0 if is_true(statement, scenes, rows) else 1.0
    if isinstance(test, Bound):
        x = abs(point[test.component]) if test.absolute else point[test.component]
        return float(x - test.limit if test.side == "at most" else test.limit - x)
    offsets = [point[test.component + i] - centre for i, centre in enumerate(test.centre)]
    if mapping.space == "circle":
        offsets = [math.remainder(offset, 2 * math.pi) for offset in offsets]
    away = math.hypot(*(offset / radius for offset, radius in zip(offsets, test.radii, strict=True)))
    return (away - 1.0) * math.prod(test.radii) ** (1 / len(test.radii))


def measured(condition: Condition, scenes: Scenes, scene: int) -> tuple[float, int]:
    """The distance from a condition, and how many choices satisfy it, by their definitions."""
    bound = scenes.arguments[scene].tolist()
    free = [row for row in scenes.objects(scene).tolist() if row not in bound]
    if not condition.every:
        margins, count = choices(condition, scenes, bound, list(permutations(free, condition.n_free)))
        enough = len(margins) >= condition.at_least
        return (sorted(margins)[condition.at_least - 1] if enough else math.nan), count
    least, n_partnered = [], 0
    for one in free:
        margins, count = choices(condition, scenes, bound, [(one, other) for other in free if other != one])
        least.append(min(margins, default=math.inf))
        n_partnered += count > 0
    farthest = max(least, default=math.inf)
    return (farthest if farthest < math.inf else math.nan), n_partnered


def choices(
    condition: Condition, scenes: Scenes, bound: list[int], tried: list[tuple[int, ...]]
) -> tuple[list[float], int]:
    """The distances of choices of objects, as far as they are defined, and how many satisfy the condition."""
    margins, count = [], 0
    for chosen in tried:
        rows = (*bound, *chosen)
        count += all(is_true(statement, scenes, rows) for statement in condition.statements)
        found = [(isinstance(each.test, Is), excess(each, scenes, rows)) for each in condition.statements]
        numbers = [x for is_category, x in found if not is_category]
        categories = [x for is_category, x in found if is_category]
        if not numbers and not np.isnan(categories).any():
            margins.append(max(categories))
        elif not np.isnan([x for _, x in found]).any() and max(categories, default=-1.0) < 0:
            margins.append(max(numbers))
    return margins, count


@pytest.mark.parametrize("seed", range(6))
def test_distances_and_counts_are_those_defined(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n_parameters = seed % 3
    scenes = random_scenes(rng, 10, n_parameters)
    conditions = [random_condition(rng, n_parameters) for _ in range(25)]
    ensemble = ensemble_of(scenes.schema, *map(tree_of, conditions))
    found = [features(ensemble, scenes, mode) for mode in ("distances", "counts")]

    expected = np.array([[measured(each, scenes, i) for each in conditions] for i in range(10)])
    np.testing.assert_allclose(found[0], expected[..., 0], rtol=1e-9, atol=1e-12)
    assert np.array_equal(found[1], expected[..., 1])
    answers = [[holds(each, scenes, i) for each in conditions] for i in range(10)]
    assert ((found[0] <= 0) == answers).all()
    assert (found[0] > 0).any()
    assert np.array_equal(features(ensemble, scenes, "distances", n_jobs=2), found[0], equal_nan=True)


def test_a_distance_by_hand() -> None:
    location, team = Attribute("location", 2), Attribute("team", kind="category", categories=["own", "other"])
    schema = Schema([location, team], ["passer"])
    near = Statement(Mapping("distance", location), (0, 1), Bound(0, "at most", 3.0))
    other = Statement(Mapping("identity", team), (1,), Is(1))
    ellipse = Statement(Mapping("difference", location), (0, 1), Near(0, (0.0, 0.0), (4.0, 1.0)))
    ensemble = ensemble_of(
        schema,
        *(tree_of(Condition(1, each)) for each in ((near, other), (other,), (ellipse,))),
        tree_of(Condition(1, (near,), 2)),
    )
    # The passer at the origin, then an own object at (0, 1), others at (0, 5) and (8, 0).
    matrix = np.array([[0, 0, 0], [0, 1, 0], [0, 5, 1], [8, 0, 1], [0, 0, 0], [0, 2, 0]], dtype=float)
    scenes = Scenes(schema, matrix, np.arange(6), np.array([0, 4]), np.array([4, 2]), np.array([[0], [4]]))

    # The nearest other object is 5 away. (8, 0) and (0, 2) are twice as far as the ellipse, whose half-axes
    # are 4 and 1.
    assert features(ensemble, scenes, "distances").tolist() == [
        [2.0, -1.0, 0.0, 2.0],
        [pytest.approx(math.nan, nan_ok=True), 1.0, 2.0, pytest.approx(math.nan, nan_ok=True)],
    ]
    assert features(ensemble, scenes, "counts").tolist() == [[0, 2, 1, 1], [0, 0, 0, 1]]
    assert feature_names(ensemble, "counts")[0] == (
        "tree 1, question 1, count: some object with team other is within 3 of the passer"
    )


def sequences(tree: Tree, scenes: Scenes, scene: int) -> dict[int, list[tuple[int, ...]]]:
    """The instantiation sequences of object rows that arrive at each question, one by one."""
    found: dict[int, list[tuple[int, ...]]] = {}

    def visit(index: int, bound: tuple[int, ...]) -> None:
        node = tree.nodes[index]
        if isinstance(node, Instantiation):
            if len(bound) < tree.schema.n_parameters:
                visit(node.child, (*bound, int(scenes.arguments[scene, len(bound)])))
                return
            free = [row for row in scenes.objects(scene).tolist() if row not in bound]
            for row in free or [-1]:
                visit(node.child, (*bound, row))
        elif isinstance(node, Question):
            found.setdefault(index, []).append(bound)
            point = at(node, scenes, bound)
            answer = "error" if np.isnan(point).any() else "yes" if node.volume.contains(point)[0] else "no"
            visit(getattr(node, answer), bound)

    visit(0, ())
    return found


def at(question: Question, scenes: Scenes, bound: tuple[int, ...]) -> NDArray[np.float64]:
    rows = np.array([[bound[variable] for variable in question.variables]])
    return question.mapping.evaluate(scenes.schema, scenes.matrix, rows)


def chain(rng: np.random.Generator, n_parameters: int, depth: int) -> Tree:
    """A tree of one branch of Noes, with an object bound before every question, about that object or any."""
    schema = scenes_for_trees(rng, n_parameters).schema
    tree = Tree.stub(schema, Leaf(0.5, 0, 0))
    for number in range(depth):
        mapping, variables = random_question(rng, n_parameters + number + 1)
        if rng.random() < 0.7:
            mapping, variables = Mapping("identity", schema.attributes[number % 3]), (n_parameters + number,)
        question = Question(mapping, variables, random_volume(rng, mapping), 0, 0, 0)
        tree = tree.expanded(number, 1 if number else n_parameters + 1, question)
    return tree


@pytest.mark.parametrize("seed", range(16))
def test_questions_of_smrf_trees_are_measured_as_defined(seed: int) -> None:
    rng = np.random.default_rng(seed)
    scenes = scenes_for_trees(rng, seed % 3)
    tree = random_tree(rng, seed % 3) if seed < 8 else chain(rng, seed % 3, 4)
    asked = [index for index, node in enumerate(tree.nodes) if isinstance(node, Question)]
    expected = np.full((2, len(scenes), len(asked)), np.nan)
    for scene in range(len(scenes)):
        arrived = sequences(tree, scenes, scene)
        for place, index in enumerate(asked):
            node = tree.nodes[index]
            assert isinstance(node, Question)
            points = [at(node, scenes, bound) for bound in arrived.get(index, [])]
            defined = [point for point in points if not np.isnan(point).any()]
            margins = [float(node.volume.distance(point)[0] - node.volume.radius) for point in defined]
            expected[0, scene, place] = min(margins, default=math.nan)
            expected[1, scene, place] = sum(margin <= 0 for margin in margins)

    found = question_measures(tree, scenes)
    np.testing.assert_allclose(found[0], expected[0], rtol=1e-9, atol=1e-9)
    assert np.array_equal(found[1], expected[1])
    assert np.array_equal(question_measures(tree, scenes, n_jobs=2), found, equal_nan=True)


def test_many_variables_and_objects_take_no_time() -> None:
    # None of 40 objects is near (20, 9), nor another one, nor ...: 40 * 39 * ... * 34 sequences.
    scenes = scenes_in(plane(), [[(i, 0) for i in range(40)]])
    far = Ellipsoid(np.array([20.0, 9.0]), np.eye(2), 0.5, 3, 0.1)
    tree = Tree.stub(plane(), Leaf(0.5, 0, 0))
    for number in range(7):
        question = Question(Mapping("identity", plane()["location"]), (number,), far, 0, 0, 0)
        tree = tree.expanded(number, 1, question)
    margins, counts = question_measures(tree, scenes)

    assert margins[0].tolist() == pytest.approx([8.5] * 7)
    assert counts[0].tolist() == [0.0] * 7


def test_bits_probabilities_and_densities_are_those_of_each_tree() -> None:
    schema = plane()
    scenes = scenes_in(schema, [[(0, 0), (0, 1)], [(0, 0), (0, 5)], [(0, 0), NOWHERE]])
    trees = (near_tree(schema), near_tree(schema, radius=9.0, probabilities=(0.8, 0.4, 0.2)))
    ensemble = Ensemble(schema, np.array([0.5]), trees, np.array([0.5, -0.5]))

    assert features(ensemble, scenes, "probability").tolist() == [[0.9, 0.8], [0.1, 0.8], [0.3, 0.2]]
    assert features(ensemble, scenes, "bits").tolist() == [
        [1, 0, 0, 1, 0, 0],
        [0, 1, 0, 1, 0, 0],
        [0, 0, 1, 0, 0, 1],
    ]
    expected = np.hstack([tree_features(tree, query(tree, scenes), "densities+bits") for tree in trees])
    assert np.array_equal(features(ensemble, scenes, "densities+bits", n_jobs=2), expected)
    assert features(ensemble, scenes, "distances").tolist() == [
        [-2.0, -8.0],
        [2.0, -4.0],
        [pytest.approx(math.nan, nan_ok=True)] * 2,
    ]
    # Both orders of two objects.
    assert features(ensemble, scenes, "counts").tolist() == [[2, 2], [0, 2], [0, 0]]
    assert feature_names(ensemble, "bits")[:3] == [
        "tree 1, leaf 1: there are A and B such that B is within 3 of A",
        "tree 1, leaf 2: it is not so that B is within 3 of A",
        "tree 1, leaf 3: it cannot be said whether B is within 3 of A",
    ]
    assert feature_names(ensemble, "densities+bits")[7] == (
        "tree 2, leaf 1, density: there are A and B such that B is within 9 of A"
    )


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("mode", MODES)
def test_every_column_has_a_name_of_its_own(mode: Mode, seed: int) -> None:
    rng = np.random.default_rng(seed)
    scenes = scenes_for_trees(rng, 1)
    ensemble = ensemble_of(scenes.schema, *(random_tree(rng, 1) for _ in range(3)))
    found, names = features(ensemble, scenes, mode), feature_names(ensemble, mode)

    assert found.shape == (len(scenes), len(names))
    # A leaf has a density for every question above it, and two of these may say the same.
    assert len(set(names)) == len(names) or mode == "densities+bits"


def test_branches_of_conditions_are_told() -> None:
    schema = plane()
    right, up = (
        Condition(1, (Statement(Mapping("identity", schema["location"]), (0,), Bound(i, "at least", 3.0)),))
        for i in range(2)
    )
    nodes = (
        Split(right, 1, 2, 0.0),
        Value((1.0,), 0),
        Split(up, 3, 4, 0.0),
        Value((2.0,), 0),
        Value((3.0,), 0),
    )
    ensemble = ensemble_of(schema, SceneTree(nodes), SceneTree((Value((0.0,), 0),)))

    no = "it is not so that"
    assert feature_names(ensemble, "bits") == [
        "tree 1, leaf 1: some object has x at least 3",
        "tree 1, leaf 2: it is not so that some object has x at least 3 and some object has y at least 3",
        f"tree 1, leaf 3: {no} some object has x at least 3 and {no} some object has y at least 3",
        "tree 2, leaf 1: always",
    ]
    assert feature_names(ensemble, "probability") == ["tree 1", "tree 2"]
    scenes = scenes_in(schema, [[(4, 0)], [(0, 4)], []])
    assert features(ensemble, scenes, "bits").tolist() == [[1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 1]]
    assert features(ensemble, scenes, "probability")[:, 0].tolist() == [1.0, 2.0, 3.0]


def test_an_ensemble_without_questions_has_no_distances() -> None:
    scenes = scenes_in(plane(), [[(4, 0)], []])
    for ensemble in (ensemble_of(plane(), SceneTree((Value((0.0,), 0),))), ensemble_of(plane())):
        assert features(ensemble, scenes, "distances").shape == (2, 0)
        assert feature_names(ensemble, "counts") == []


def test_several_outputs_have_a_column_each() -> None:
    tree = SceneTree((Value((0.25, 0.75), 0),))
    ensemble = Ensemble(plane(), np.zeros(2), (tree,), np.ones(1))

    assert features(ensemble, scenes_in(plane(), [[]]), "probability").tolist() == [[0.25, 0.75]]
    assert feature_names(ensemble, "probability") == ["tree 1, output 1", "tree 1, output 2"]


@pytest.mark.parametrize("mode", ["bits", "probability", "distances", "counts"])
def test_a_pipeline_learns_from_the_features(mode: Mode) -> None:
    rng = np.random.default_rng(0)
    scenes = scenes_of(rng, 20, 2)
    y = guest_on_the_left(scenes)
    forest = SMRFForestClassifier(n_trees=2, random_state=0)
    model = make_pipeline(SceneFeatures(forest, mode=mode), LogisticRegression())
    model.set_params(scenefeatures__model__n_trees=3).fit(scenes, y)
    others = scenes_of(rng, 5, 0)

    assert len(model[0].model_.ensemble_.trees) == 3
    assert model.predict(others).shape == (5,)
    # Scenes without objects are as far as the farthest scene of the training.
    if mode == "distances":
        found = model[0].transform(others)
        assert np.array_equal(found[0], model[0].farthest_)
        assert np.array_equal(found[0], np.nanmax(features(model[0].model_.ensemble_, scenes, mode), axis=0))


def test_a_fitted_model_is_used_as_it_is_and_columns_are_named() -> None:
    scenes = scenes_of(np.random.default_rng(0), 20, 2)
    forest = SMRFForestClassifier(n_trees=2, random_state=0).fit(scenes, guest_on_the_left(scenes))
    mapped = SceneFeatures(FrozenEstimator(forest), mode="counts").fit(scenes[:3], [0, 1, 1])
    named = mapped.set_output(transform="pandas").transform(scenes)

    assert np.array_equal(named, features(forest.ensemble_, scenes, "counts"))
    assert named.columns.tolist() == feature_names(forest.ensemble_, "counts")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"mode": "leaves"}, "mode must be"),
        ({"mode": "densities+bits"}, "is for SMRF trees"),
        ({"model": SMRFTreeClassifier()}, "model must be a forest"),
        ({"n_jobs": 0}, "n_jobs must be"),
    ],
)
def test_bad_options_are_refused(options: dict[str, Any], message: str) -> None:
    scenes = scenes_of(np.random.default_rng(0), 12, 1)
    mapped = SceneFeatures(SMRFForestClassifier(n_trees=1, random_state=0)).set_params(**options)
    with pytest.raises(InputError, match=message):
        mapped.fit(scenes, [0, 1] * 6)


def test_other_modes_and_scenes_are_refused() -> None:
    ensemble = ensemble_of(plane(), SceneTree((Value((0.0,), 0),)))
    with pytest.raises(InputError, match="mode must be"):
        feature_names(ensemble, "leaves")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="is for SMRF trees"):
        feature_names(ensemble, "densities+bits")
    with pytest.raises(InputError, match="the model is for scenes with"):
        features(ensemble, scenes_of(np.random.default_rng(0), 2, 1), "bits")
