"""Estimators with weights, several classes and real targets."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from interpreted import compiled_only
from relforest import Attribute, Scenes, Schema, SMRFTreeClassifier, SMRFTreeRegressor, Tree
from relforest.support.errors import InputError, ModelFormatError
from relforest.trees import Leaf, MeanLeaf

pytestmark = compiled_only

Floats = NDArray[np.float64]

WEIGHTS = Schema((Attribute("weight", operations=("identity",)),))


def of_weights(weights: Floats) -> Scenes:
    """Scenes of objects that have nothing but a weight."""
    return Scenes.from_dicts(
        [{"objects": [{"weight": w} for w in scene]} for scene in weights.tolist()], WEIGHTS
    )


def three_classes(n: int = 60, seed: int = 0) -> tuple[Scenes, NDArray[np.str_]]:
    """Light objects only, or one of 8, or one of 20."""
    rng = np.random.default_rng(seed)
    weights = rng.uniform(0, 4, size=(n, 3))
    classes = rng.choice(["light", "heavy", "huge"], n, p=[0.5, 0.25, 0.25])
    weights[classes == "heavy", 1] = rng.normal(8, 0.3, np.count_nonzero(classes == "heavy"))
    weights[classes == "huge", 0] = rng.normal(20, 0.3, np.count_nonzero(classes == "huge"))
    return of_weights(weights), classes


def nearest(scenes: Scenes) -> Floats:
    """Distance of the first object to the nearest other."""
    places = [scenes.matrix[scenes.objects(i), :2] for i in range(len(scenes))]
    return np.array([np.linalg.norm(each[1:] - each[0], axis=1).min() for each in places])


def near_and_far(n_objects: int, n: int, seed: int) -> Scenes:
    rng = np.random.default_rng(seed)
    schema = Schema((Attribute("location", 2, operations=("distance",)),), ("me",))
    return Scenes.from_dicts(
        [
            {
                "objects": [{"id": i, "location": place} for i, place in enumerate(scene)],
                "arguments": {"me": 0},
            }
            for scene in rng.uniform(0, 10, size=(n, n_objects, 2)).tolist()
        ],
        schema,
    )


def again(tree: Tree) -> Tree:
    return Tree.from_dict(tree.to_dict())


@pytest.mark.parametrize("search", ["screened", "exhaustive"])
def test_three_classes(search: Any) -> None:
    scenes, y = three_classes()
    model = SMRFTreeClassifier(search=search, attempts=1, random_state=0).fit(scenes, y)

    assert model.classes_.tolist() == ["heavy", "huge", "light"]
    assert (model.predict(scenes) == y).all()
    probabilities = model.predict_proba(scenes)
    assert probabilities.shape == (60, 3)
    np.testing.assert_allclose(probabilities.sum(axis=1), 1)
    test, labels = three_classes(seed=1)
    assert model.score(test, labels) > 0.9
    tree = again(model.tree_)
    assert tree.to_dict() == model.tree_.to_dict()
    assert tree.to_dict()["version"] == 2
    assert str(tree) == str(model.tree_)
    assert "0.00, 0.00, 1.00  (0, 0, " in str(tree)
    assert str(model.explain(scenes)[0]).startswith("scene 0: 0.00, 1.00, 0.00, leaf ") == (y[0] == "huge")


def test_low_values_may_be_explained_by_what_exists() -> None:
    train, test = near_and_far(3, 50, 0), near_and_far(6, 40, 1)
    y = nearest(train)
    lowest, highest, either = (
        SMRFTreeRegressor(decides=decides, attempts=1, random_state=0).fit(train, y)
        for decides in ("lowest", "highest", "either")
    )

    assert lowest.score(test, nearest(test)) > max(0.5, highest.score(test, nearest(test)))
    assert either.score(test, nearest(test)) > 0.5
    tree = again(lowest.tree_)
    assert tree.to_dict() == lowest.tree_.to_dict()
    means = np.array([y[lowest.apply(train) == leaf].mean() for leaf in np.unique(lowest.apply(train))])
    assert np.unique(lowest.predict(train)) == pytest.approx(np.sort(means))
    # Of the leaves that a scene reaches, the one with the lowest mean decides.
    assert tree.leaf_predictions.tolist() == (-tree.leaf_probabilities).tolist()
    assert "lowest" not in str(highest.tree_.to_dict())
    with pytest.raises(InputError, match="decides must be one of"):
        SMRFTreeRegressor(decides="both").fit(train, y)  # type: ignore[arg-type]


def test_a_relation_is_explained_by_regression() -> None:
    train, test = near_and_far(3, 50, 0), near_and_far(6, 40, 1)
    model = SMRFTreeRegressor(decides="highest", attempts=1, random_state=0).fit(train, -nearest(train))

    assert not model.tree_.is_stub
    assert model.score(test, -nearest(test)) > 0.5
    leaf = model.apply(train)
    for ordinal, node in enumerate(model.tree_.leaves):
        found = model.tree_.nodes[node]
        assert isinstance(found, MeanLeaf)
        assert found.positives == np.count_nonzero(leaf == ordinal)
    tree = again(model.tree_)
    assert tree.to_dict() == model.tree_.to_dict()
    assert "yes: mean -" in str(tree)
    assert "one class" not in str(tree)
    explanation = str(model.explain(train)[0])
    assert explanation.startswith("scene 0: mean -")


def test_regression_refuses_noise() -> None:
    rng = np.random.default_rng(0)
    scenes = of_weights(rng.uniform(0, 4, size=(30, 2)))
    model = SMRFTreeRegressor(decides="highest", test="permutation", permutations=19, random_state=0)
    y = rng.normal(size=30)

    assert model.fit(scenes, y).tree_.is_stub
    assert model.predict(scenes).tolist() == pytest.approx([y.mean()] * 30)
    n_below = 0
    for _ in range(5):
        y = rng.normal(size=30)
        heavy = of_weights(np.where(y[:, None] > 0, 8.0, 2.0) + rng.uniform(0, 1, size=(30, 2)))
        first, *below = model.fit(heavy, y).steps_
        assert first.p_value == 1 / 20
        n_below += len(below)
    # Each of the leaves below has a chance of 5 % to be expanded by noise.
    assert n_below <= 1


def test_units_of_the_target_do_not_matter() -> None:
    train = near_and_far(3, 30, 0)
    y = -nearest(train)
    one, other = (SMRFTreeRegressor(random_state=0).fit(train, each) for each in (y, 1e6 + 1e3 * y))

    assert str(one.tree_).splitlines()[0] == str(other.tree_).splitlines()[0]
    np.testing.assert_allclose(other.predict(train), 1e6 + 1e3 * one.predict(train))


def test_scenes_of_weight_zero_count_for_nothing() -> None:
    scenes, y = three_classes(80)
    positive = y == "heavy"
    noisy = np.where(np.arange(80) < 60, positive, ~positive)
    weights = np.where(np.arange(80) < 60, 2.5, 0.0)
    few = scenes.take(np.arange(60))
    plain = SMRFTreeClassifier(random_state=0).fit(few, positive[:60])
    weighted = SMRFTreeClassifier(random_state=0).fit(scenes, noisy, sample_weight=weights)

    assert weighted.tree_.to_dict() == plain.tree_.to_dict()


def test_weights_of_classes_by_hand() -> None:
    # Nothing can be learned, 10 of 40 are positive.
    scenes, y = of_weights(np.full((40, 1), 1.0)), np.arange(40) < 10

    def probability(sample_weight: Any = None, **options: Any) -> float:
        model = SMRFTreeClassifier(**options).fit(scenes, y, sample_weight)
        root = model.tree_.nodes[0]
        assert isinstance(root, Leaf)
        assert (root.negatives, root.positives) == (30, 10)
        return root.probability

    assert probability() == 0.25
    assert probability(class_weight="balanced") == pytest.approx(0.5)
    assert probability(class_weight={True: 2.0}) == pytest.approx(20 / 50)
    assert probability(np.where(y, 4.0, 1.0)) == pytest.approx(40 / 70)
    assert probability(np.where(y, 4.0, 1.0), class_weight={True: 3, False: 2}) == pytest.approx(120 / 180)
    assert probability(np.where(y, 4.0, 1.0), class_weight="balanced") == pytest.approx(0.5)


def test_weights_change_what_is_asked() -> None:
    # A heavy object is what the first half has, a light one what the second half has.
    rng = np.random.default_rng(0)
    weights = rng.uniform(2, 4, size=(80, 2))
    y = np.arange(80) % 2 == 0
    weights[:40][y[:40], 0] = 9.0
    weights[40:][y[40:], 0] = 0.0
    for first, there in ((10.0, 9.0), (0.1, 0.0)):
        emphasis = np.where(np.arange(80) < 40, first, 1.0)
        model = SMRFTreeClassifier(random_state=0, alpha=0.01).fit(of_weights(weights), y, emphasis)
        assert model.tree_.nodes[1].volume.contains([[there]]).tolist() == [True]  # type: ignore[union-attr]


SCENES, Y = three_classes(20)


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        (np.ones(19), r"got weights of shape \(19,\) for 20 scenes"),
        (np.zeros(20), "all weights are 0"),
        (-np.ones(20), "finite numbers of at least 0"),
        (np.full(20, np.nan), "finite numbers of at least 0"),
        (np.full(20, np.inf), "finite numbers of at least 0"),
        (["a"] * 20, "weights must be numbers"),
    ],
)
def test_bad_weights_are_refused(weights: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        SMRFTreeClassifier().fit(SCENES, Y, weights)
    with pytest.raises(InputError, match=message):
        SMRFTreeRegressor().fit(SCENES, np.arange(20), weights)


@pytest.mark.parametrize(
    ("class_weight", "message"),
    [
        ("equal", "class_weight must be \"balanced\", a mapping or None, got 'equal'"),
        (
            {"tiny": 2},
            "class_weight names 'tiny', which is no class: the classes are 'heavy', 'huge'",
        ),
        ({"huge": -1}, "weights must be finite numbers of at least 0"),
    ],
)
def test_bad_weights_of_classes_are_refused(class_weight: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        SMRFTreeClassifier(class_weight=class_weight).fit(SCENES, Y)


@pytest.mark.parametrize(
    ("y", "message"),
    [
        (np.arange(19), r"got targets of shape \(19,\) for 20 scenes"),
        (Y, "targets must be numbers: use SMRFTreeClassifier"),
        (np.ones(20), "all targets are 1"),
        (np.full(20, np.nan), "targets contain NaN"),
    ],
)
def test_bad_targets_are_refused(y: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        SMRFTreeRegressor().fit(SCENES, y)


@pytest.mark.parametrize(
    "changes",
    [
        {"kind": "mean", "mean": float("nan"), "deviation": 1.0, "scenes": 3},
        {"kind": "mean", "mean": 0.0, "deviation": -1.0, "scenes": 3},
        {"kind": "mean", "mean": 0.0, "deviation": 1.0, "scenes": -1},
        {"kind": "classes", "order": 0.5, "negatives": 1, "shares": [0.5, 0.6], "counts": [1, 1]},
        {"kind": "classes", "order": 0.5, "negatives": 1, "shares": [0.5, 0.5], "counts": [1]},
        {"kind": "classes", "order": 0.5, "negatives": 1, "shares": [1.0], "counts": [1]},
        {"kind": "classes", "order": 1.5, "negatives": 1, "shares": [0.5, 0.5], "counts": [1, 1]},
        {"kind": "classes", "order": 0.5, "negatives": 3, "shares": [0.5, 0.5], "counts": [1, 1]},
        {"kind": "classes", "order": 0.5, "negatives": 1, "shares": 0.5, "counts": [1, 1]},
    ],
)
def test_malformed_leaves_are_refused(changes: dict[str, Any]) -> None:
    document = Tree.stub(WEIGHTS, Leaf(0.5, 1, 1)).to_dict()
    document["nodes"] = [changes]
    with pytest.raises(ModelFormatError, match=r"malformed|mean must|order must|deviation must|not finite"):
        Tree.from_dict(document)


def test_leaves_are_of_one_type() -> None:
    scenes, y = three_classes()
    document = SMRFTreeClassifier(random_state=0).fit(scenes, y).tree_.to_dict()
    document["nodes"][-1] = {"kind": "leaf", "probability": 0.5, "negatives": 1, "positives": 1}
    with pytest.raises(ModelFormatError, match="the leaves of a tree must be of one type"):
        Tree.from_dict(document)
