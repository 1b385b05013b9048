"""Boosting, forests and rule sets: what they must find, and what they refuse."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.model_selection import cross_val_score

from forest_scenes import TEAM
from forests.team_scenes import SCHEMA, guest_on_the_left, nearest, scenes_of
from interpreted import INTERPRETED, compiled_only
from relforest import (
    OutcomeForestClassifier,
    SMRFBoostingClassifier,
    SMRFBoostingRegressor,
    SMRFForestClassifier,
    SMRFForestRegressor,
    SMRFRuleSetClassifier,
)
from relforest.forests import Ensemble, GrowthSettings, rule_set_estimator
from relforest.forests.base import SceneEstimator
from relforest.forests.losses import Logistic, Loss, Softmax, SquaredError
from relforest.forests.rule_sets import Pool, RuleSetSettings, choose_rule_sets
from relforest.scenes import Attribute, Scenes, Schema
from relforest.support.errors import InputError, ModelFormatError

FEW = 2 if INTERPRETED else 15
CLASSIFIERS: tuple[SceneEstimator, ...] = (
    SMRFBoostingClassifier(n_trees=2 * FEW, learning_rate=0.2, random_state=0),
    SMRFForestClassifier(n_trees=FEW, random_state=0),
    SMRFRuleSetClassifier(n_trees=FEW, rules=RuleSetSettings(n_steps=100 * FEW), random_state=0),
    # It needs ten scenes of each class, more than there is time for without compilation.
    *(() if INTERPRETED else (OutcomeForestClassifier(n_trees=FEW, random_state=0),)),
)
REGRESSORS: tuple[SceneEstimator, ...] = (
    SMRFBoostingRegressor(n_trees=FEW, random_state=0),
    SMRFForestRegressor(n_trees=FEW, random_state=0),
)


@compiled_only
@pytest.mark.parametrize("model", CLASSIFIERS, ids=lambda model: type(model).__name__)
def test_classifiers_find_a_relation(model: Any) -> None:
    rng = np.random.default_rng(0)
    scenes, others = scenes_of(rng, 120), scenes_of(rng, 150, 7)
    model = clone(model).fit(scenes, guest_on_the_left(scenes))

    assert (model.predict(others) == guest_on_the_left(others)).mean() >= 0.9
    probabilities = model.predict_proba(others)
    assert np.allclose(probabilities.sum(axis=1), 1.0)
    assert ((probabilities >= 0) & (probabilities <= 1)).all()
    assert "team guest" in model.describe()
    assert "identity(team) of C" in " ".join(each.question for each in model.importances())


@pytest.mark.parametrize("model", CLASSIFIERS + REGRESSORS, ids=lambda model: type(model).__name__)
def test_what_is_not_fitted_says_so(model: Any) -> None:
    with pytest.raises(NotFittedError):
        clone(model).predict(scenes_of(np.random.default_rng(0), 2))


@compiled_only
def test_a_rule_set_is_read_as_the_concept() -> None:
    rng = np.random.default_rng(1)
    scenes = scenes_of(rng, 200)
    model = SMRFRuleSetClassifier(
        n_trees=30, rules=RuleSetSettings(n_steps=5000), averaged=False, random_state=0
    )
    model.fit(scenes, guest_on_the_left(scenes))
    lines = model.describe().splitlines()

    assert len(lines) == 3
    assert "some object with team guest has x at most" in lines[1]
    reasons = model.explain(scenes.take(np.flatnonzero(guest_on_the_left(scenes))[:1]))[0].reasons
    assert reasons[0].holds
    assert scenes.matrix[np.array(reasons[0].witnesses["C"], dtype=int), 2] == 1


@compiled_only
def test_the_rules_that_are_told_are_the_most_typical_of_all(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(3)
    scenes, others = scenes_of(rng, 60), scenes_of(rng, 500)
    monkeypatch.setattr(rule_set_estimator, "mixed", lambda *_arguments: others)
    labels = guest_on_the_left(scenes) ^ (rng.random(60) < 0.2)
    chosen: dict[str, Any] = {"n_trees": 20, "rules": RuleSetSettings(n_steps=5000), "random_state": 0}
    model, single = (SMRFRuleSetClassifier(averaged=averaged, **chosen) for averaged in (True, False))
    model.fit(scenes, labels)
    single.fit(scenes, labels)

    sets = model.ensemble_.trees[:-20]
    leaves, predicted = model.ensemble_.leaves(others), model.predict(others)
    agreement = [
        ((tree.values[leaf, 0] > 0.0) == predicted).mean()
        for tree, leaf in zip(sets, leaves.T[: len(sets)], strict=True)
    ]
    assert len(sets) > 2
    assert agreement == sorted(agreement, reverse=True)
    assert [tree.nodes for tree in single.ensemble_.trees] == [sets[0].nodes]
    assert single.describe().splitlines()[1:] == model.describe().splitlines()[1:]


@compiled_only
@pytest.mark.parametrize(
    "model",
    [
        SMRFBoostingRegressor(n_trees=150, learning_rate=0.1, random_state=0),
        SMRFForestRegressor(n_trees=30, random_state=0),
    ],
    ids=lambda model: type(model).__name__,
)
def test_a_distance_is_predicted_among_twice_the_objects(model: Any) -> None:
    rng = np.random.default_rng(2)
    scenes, others = scenes_of(rng, 150, 3), scenes_of(rng, 100, 6)
    model.fit(scenes, nearest(scenes))

    assert model.score(others, nearest(others)) >= 0.6
    assert model.importances()[0].question.startswith(("distance(location)", "difference(location)"))


@compiled_only
def test_the_training_loss_falls() -> None:
    rng = np.random.default_rng(3)
    scenes = scenes_of(rng, 60)
    model = SMRFBoostingClassifier(n_trees=20, learning_rate=0.3, random_state=0)
    losses = model.fit(scenes, rng.random(60) < 0.4).losses_

    assert len(losses) == 21
    assert (np.diff(losses) < 0).all()


@compiled_only
def test_boosting_stops_early_on_noise() -> None:
    rng = np.random.default_rng(4)
    scenes = scenes_of(rng, 100)
    model = SMRFBoostingClassifier(n_trees=100, learning_rate=0.3, validation=0.3, random_state=0)
    model.fit(scenes, rng.random(100) < 0.5)

    assert len(model.ensemble_.trees) < 70
    assert model.losses_.argmin() == len(model.ensemble_.trees)


@compiled_only
@pytest.mark.parametrize("model", CLASSIFIERS[:2], ids=lambda model: type(model).__name__)
def test_three_classes(model: Any) -> None:
    rng = np.random.default_rng(5)
    scenes, others = scenes_of(rng, 150), scenes_of(rng, 100)

    def classes(batch: Scenes) -> NDArray[Any]:
        near = nearest(batch) < 1.5
        return np.where(guest_on_the_left(batch), "left", np.where(near, "near", "none"))

    model = clone(model).set_params(class_weight="balanced").fit(scenes, classes(scenes))

    assert model.classes_.tolist() == ["left", "near", "none"]
    assert (model.predict(others) == classes(others)).mean() >= 0.7
    assert np.allclose(model.predict_proba(others).sum(axis=1), 1.0)


@pytest.mark.parametrize("model", CLASSIFIERS + REGRESSORS, ids=lambda model: type(model).__name__)
def test_models_are_scikit_learn_citizens_and_survive_files(model: Any) -> None:
    rng = np.random.default_rng(6)
    scenes = scenes_of(rng, 20 if INTERPRETED else 60, 2)
    distances = nearest(scenes)
    y = distances > np.median(distances) if hasattr(model, "class_weight") else distances
    one, other = clone(model).fit(scenes, y), clone(model).set_params(n_jobs=2).fit(scenes, y)
    document = one.ensemble_.to_dict()
    read = Ensemble.from_dict(document)

    assert np.array_equal(one.predict(scenes), other.predict(scenes))
    assert one.ensemble_.to_dict() == other.ensemble_.to_dict()
    assert read.to_dict() == document
    assert np.array_equal(read.scores(scenes), one.ensemble_.scores(scenes))
    copied = pickle.loads(pickle.dumps(one))  # noqa: S301 - our own
    assert np.array_equal(copied.predict(scenes), one.predict(scenes))
    assert len(cross_val_score(clone(model), scenes, y, cv=2)) == 2
    assert isinstance(str(one.explain(scenes[:1])[0]), str)


@compiled_only
def test_categories_are_matched_by_name() -> None:
    rng = np.random.default_rng(7)
    scenes = scenes_of(rng, 80)
    model = SMRFForestClassifier(n_trees=10, random_state=0).fit(scenes, guest_on_the_left(scenes))
    renumbered = Schema([SCHEMA["location"], TEAM.with_categories(["referee", "guest", "home"])])
    matrix = scenes.matrix.copy()
    matrix[:, 2] = 2 - matrix[:, 2]
    same = Scenes(renumbered, matrix, scenes.rows, scenes.starts, scenes.counts)

    assert np.array_equal(model.predict_proba(same), model.predict_proba(scenes))


def test_derivatives_are_those_of_the_loss() -> None:
    rng = np.random.default_rng(8)
    weights = rng.uniform(0.5, 2, 5)
    losses: tuple[Loss, ...] = (
        Logistic(np.array([True, False, True, True, False]), weights),
        Softmax(np.array([0, 2, 1, 1, 0]), 3, weights),
        SquaredError(rng.standard_normal(5), weights),
    )
    for loss in losses:
        scores = rng.standard_normal((5, len(loss.start())))
        found, step = loss.targets(scores), 1e-4
        for at in np.ndindex(scores.shape):
            below, here, above = (_total(loss, scores, at, by) for by in (-step, 0.0, step))

            assert found.gradients[at] == pytest.approx((above - below) / (2 * step), abs=1e-6)
            assert found.curvatures[at] == pytest.approx((above - 2 * here + below) / step**2, abs=1e-5)


def _total(loss: Loss, scores: NDArray[np.float64], at: tuple[int, ...], by: float) -> float:
    moved = scores.copy()
    moved[at] += by
    weights: NDArray[np.float64] = loss.weights  # type: ignore[attr-defined]
    return loss.value(moved, np.arange(len(scores))) * float(weights.sum())


def test_the_start_is_the_best_constant() -> None:
    weights = np.array([1.0, 3.0])

    # Odds 3 : 1; a weighted mean of 0 and 4.
    assert Logistic(np.array([False, True]), weights).start() == pytest.approx(np.log(3))
    assert Softmax(np.array([0, 1]), 2, weights).start() == pytest.approx(np.log([0.25, 0.75]))
    assert SquaredError(np.array([0.0, 4.0]), weights).start() == pytest.approx(3.0)


def test_weights_count_as_repetitions() -> None:
    rng = np.random.default_rng(9)
    scenes = scenes_of(rng, 50, 2)
    y = guest_on_the_left(scenes)
    weights = rng.integers(0, 3, 50)
    model = SMRFForestRegressor(
        n_trees=1, max_samples=1.0, growth=GrowthSettings(max_leaves=2, share=1.0, n_discs=0), random_state=0
    )
    weighted = model.fit(scenes, y.astype(float), sample_weight=weights).predict(scenes)
    inside = weighted == weighted.max()

    # One leaf is the shrunken weighted mean of its scenes: start - G / (H + 0.5), weights of mean 1 aside.
    scale = 50 / weights.sum()
    start = np.average(y, weights=weights)
    total = scale * weights[inside]
    expected = start + (total * (y[inside] - start)).sum() / (total.sum() + 1.0)
    assert weighted.max() == pytest.approx(expected)


def test_the_cheapest_rule_set_is_found() -> None:
    positive = np.repeat([True, False], 20)
    first = np.arange(40) < 12
    second = (np.arange(40) >= 12) & (np.arange(40) < 20)
    noise = np.arange(40) % 3 == 0
    pool = Pool(np.array([noise, first, second]), np.array([1.0, 2.0, 2.0]))
    found = choose_rule_sets(
        pool, positive, np.ones(40), RuleSetSettings(n_steps=2000), np.random.default_rng(0)
    )

    # Both rules together describe the labels perfectly: their cost, and twice 20.1 of 20.2 scenes.
    assert found[0].rules == (1, 2)
    assert found[0].describes == 1
    perfect = -2 * (20.1 * np.log(20.1 / 20.2) + 0.1 * np.log(0.1 / 20.2))
    assert found[0].cost == pytest.approx(4.0 + perfect)
    assert sum(each.weight for each in found) == pytest.approx(1.0)


@pytest.mark.parametrize("model", CLASSIFIERS, ids=lambda model: type(model).__name__)
@pytest.mark.parametrize(
    ("y", "weight", "message"),
    [
        ([0, 1], None, "got 2 labels for 6 scenes"),
        ([0] * 6, None, "2 classes are needed"),
        ([0.5, 1, 0, 1, 0, 1], None, "continuous"),
        ([0, 1, np.nan, 0, 1, 0], None, "NaN"),
        ([0, 1, 0, 1, 0, 1], [1, 1, -1, 1, 1, 1], "weights must be finite"),
        ([0, 1, 0, 1, 0, 1], [1, 1, np.nan, 1, 1, 1], "weights must be finite"),
        ([0, 1, 0, 1, 0, 1], [0] * 6, "all weights are 0"),
        ([0, 1, 0, 1, 0, 1], [1, 0, 1, 0, 1, 0], "all scenes of class 1 have weight 0"),
        ([0, 1, 0, 1, 0, 1], [1], "got weights of shape"),
    ],
)
def test_bad_labels_and_weights_are_refused(model: Any, y: Any, weight: Any, message: str) -> None:
    scenes = scenes_of(np.random.default_rng(0), 6)
    with pytest.raises(InputError, match=message):
        clone(model).fit(scenes, y, sample_weight=weight)


@pytest.mark.parametrize("model", REGRESSORS, ids=lambda model: type(model).__name__)
@pytest.mark.parametrize(
    ("y", "message"),
    [
        ([0.0, 1.0], "targets of shape"),
        ([1.0] * 6, "all targets are 1"),
        ([0, 1, np.inf, 0, 1, 0], "target 2 is inf"),
        ([0, 1, np.nan, 0, 1, 0], "target 2 is nan"),
        (["a"] * 6, "targets must be numbers"),
    ],
)
def test_bad_targets_are_refused(model: Any, y: Any, message: str) -> None:
    scenes = scenes_of(np.random.default_rng(0), 6)
    with pytest.raises(InputError, match=message):
        clone(model).fit(scenes, y)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"n_trees": 0}, "n_trees must be an integer of at least 1"),
        ({"growth": {"max_leaves": 3}}, "growth must be GrowthSettings"),
        ({"random_state": -1}, "random_state must be"),
        ({"class_weight": "uneven"}, "class_weight must be"),
    ],
)
@pytest.mark.parametrize("model", CLASSIFIERS, ids=lambda model: type(model).__name__)
def test_bad_parameters_are_refused(model: Any, parameters: dict[str, Any], message: str) -> None:
    scenes = scenes_of(np.random.default_rng(0), 6)
    with pytest.raises(InputError, match=message):
        clone(model).set_params(**parameters).fit(scenes, [0, 1] * 3)


@compiled_only
def test_scenes_of_other_kinds_are_refused() -> None:
    scenes = scenes_of(np.random.default_rng(0), 30)
    model = clone(CLASSIFIERS[1]).fit(scenes, guest_on_the_left(scenes))

    with pytest.raises(InputError, match="expected Scenes"):
        model.predict(np.zeros((3, 2)))
    with pytest.raises(InputError, match="the model is for scenes with"):
        model.predict(Scenes.from_dicts([{"objects": [{"weight": 1.0}]}]))
    with pytest.raises(InputError, match="rule sets are for two classes"):
        clone(CLASSIFIERS[2]).fit(scenes, np.arange(30) % 3)


def test_scenes_without_objects_can_be_learned_from() -> None:
    schema = Schema([Attribute("weight")])
    counts = np.array([0, 1, 0, 2, 0, 1, 0, 3, 0, 1, 0, 1])
    starts = np.cumsum(counts) - counts
    matrix = np.arange(9.0)[:, None]
    scenes = Scenes(schema, matrix, np.arange(9), starts, counts)
    model = SMRFBoostingClassifier(n_trees=20, learning_rate=0.5, random_state=0).fit(scenes, counts > 0)

    assert (model.predict(scenes[:1]) == [False]).all()


@pytest.mark.parametrize("model", CLASSIFIERS, ids=lambda model: type(model).__name__)
def test_scenes_that_are_all_alike_get_the_base_rate(model: Any) -> None:
    scenes = Scenes.from_dicts([{"objects": [{"weight": 1.0}]}] * 80)
    model = clone(model).fit(scenes, [0, 1, 1, 1] * 20)

    assert np.allclose(model.predict_proba(scenes)[:, 1], 0.75, atol=0.03)
    assert model.importances() == []
    assert isinstance(model.describe(), str)


def test_rules_share_their_gain() -> None:
    rng = np.random.default_rng(1)
    scenes = scenes_of(rng, 30, 2)
    model = clone(CLASSIFIERS[2]).fit(scenes, nearest(scenes) > 4)

    assert sum(each.share for each in model.importances()) == pytest.approx(1.0)


def _counting_every(nodes: list[Any]) -> list[Any]:
    return [{**nodes[0], "condition": {**nodes[0]["condition"], "at_least": 2, "every": True}}, *nodes[1:]]


def test_damaged_documents_are_refused() -> None:
    scenes = scenes_of(np.random.default_rng(0), 40)
    model = SMRFForestClassifier(n_trees=2, random_state=0).fit(scenes, guest_on_the_left(scenes))
    document = model.ensemble_.to_dict()

    changes: tuple[dict[str, Any], ...] = (
        {"weights": [1.0]},
        {"start": []},
        {"trees": 3},
        {"trees": [_counting_every(document["trees"][0])], "weights": [1.0]},
        {"trees": [[{"value": [0.0, 1.0], "scenes": 3}]], "weights": [1.0]},
        {"trees": [[{**document["trees"][0][0], "yes": 1, "no": 1}]], "weights": [1.0]},
    )
    for change in changes:
        with pytest.raises(ModelFormatError):
            Ensemble.from_dict(document | change)
