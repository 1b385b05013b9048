"""Forests of SMRF trees, half of them for negated labels."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from sklearn.base import clone

from forests.team_scenes import guest_on_the_left, nearest, scenes_of
from interpreted import INTERPRETED, compiled_only
from relforest import SMRFForestClassifier, SMRFForestRegressor
from relforest.forests import Ensemble, GrowthSettings
from relforest.forests.questions import questions
from relforest.support.errors import InputError, ModelFormatError
from relforest.trees import MeanLeaf, Tree, TreeSettings, query
from small_trees import near_tree, plane, scenes_in

PAIRS = scenes_in(plane(), [[(0, 0), (0, 1)], [(0, 0), (0, 5)], [(0, 0)]])
"""B near A, B far from A, no B: probabilities .9, .1 and .3 by `near_tree`."""


def small(**options: Any) -> Any:
    return SMRFForestClassifier(n_trees=4, growth=TreeSettings(attempts=1), random_state=0, **options)


def test_a_negated_tree_counts_as_its_complement() -> None:
    schema = plane()
    trees = (near_tree(schema), near_tree(schema, probabilities=(0.8, 0.4, 0.2)))
    ensemble = Ensemble(schema, np.array([0.5]), trees, np.array([0.5, -0.5]))

    # Means of .9 and 1 - .8, of .1 and 1 - .4, of .3 and 1 - .2.
    assert ensemble.scores(PAIRS)[:, 0] == pytest.approx([0.55, 0.35, 0.55])
    assert ensemble.leaves(PAIRS, n_jobs=2).tolist() == [[0, 0], [1, 1], [2, 2]]
    assert Ensemble.from_dict(ensemble.to_dict()).to_dict() == ensemble.to_dict()


@compiled_only
def test_a_relation_is_found_and_told() -> None:
    rng = np.random.default_rng(0)
    scenes, others = scenes_of(rng, 150), scenes_of(rng, 200)
    model = SMRFForestClassifier(n_trees=12, growth=TreeSettings(), random_state=0)
    model.fit(scenes, guest_on_the_left(scenes))

    assert (model.predict(others) == guest_on_the_left(others)).mean() >= 0.8
    assert model.oob_score_ >= 0.8
    assert model.ensemble_.weights.tolist() == pytest.approx([1 / 12, -1 / 12] * 6)
    assert model.ensemble_.start.tolist() == [0.5]
    assert "there is an A with team guest" in model.describe()
    compared = {each.question for each in model.importances()[:2]}
    assert compared == {"identity(location) of A", "identity(team) of A"}
    assert sum(each.share for each in model.importances()) == pytest.approx(1.0)


def test_a_small_forest_is_the_same_after_files_and_in_any_number_of_processes() -> None:
    rng = np.random.default_rng(1)
    scenes = scenes_of(rng, 20 if INTERPRETED else 40, 2)
    y = guest_on_the_left(scenes)
    model = small().fit(scenes, y)
    document = model.ensemble_.to_dict()
    read = Ensemble.from_dict(document)

    assert clone(model).fit(scenes, y).ensemble_.to_dict() == document
    assert np.array_equal(read.scores(scenes), model.ensemble_.scores(scenes))
    assert np.allclose(model.predict_proba(scenes).sum(axis=1), 1.0)
    if not INTERPRETED:
        assert clone(model).set_params(n_jobs=2).fit(scenes, y).ensemble_.to_dict() == document


def test_reasons_add_up_to_the_score() -> None:
    schema = plane("A", "B")
    scenes = scenes_in(schema, [[(0, 0), (0, 1)], [(0, 0), (0, 5)]], [(0, 1), (0, 1)])
    trees = (near_tree(schema), near_tree(schema, radius=0.5))
    ensemble = Ensemble(schema, np.array([0.5]), trees, np.array([0.5, -0.5]))
    model = SMRFForestClassifier()
    model.ensemble_ = ensemble
    near, far = model.explain(scenes)

    # No training scenes are counted in these trees, so each leaf is compared with 0.
    for found, score in ((near, 0.5 + 0.45 - 0.05), (far, 0.5)):
        assert found.score == pytest.approx(score)
        assert 0.5 + sum(reason.contribution for reason in found.reasons) == pytest.approx(score)
    assert str(near.reasons[0]) == "+0.45: B is within 3 of A (A = 0, B = 1)"
    assert [reason.holds for reason in far.reasons] == [False, False]
    assert "it is not so that B is within 3 of A (A = 2, B = 3)" in str(far)
    assert "B is within 3 of A" in model.explain(scenes, most=1)[0].reasons[0].sentence


def test_gains_are_what_a_question_takes_from_the_squared_error() -> None:
    rng = np.random.default_rng(2)
    scenes = scenes_of(rng, 20, 2)
    y = scenes.matrix[::2, 0] > 5
    model = SMRFForestClassifier(
        n_trees=1, max_samples=1.0, growth=TreeSettings(attempts=1), negated=0.0, random_state=0
    ).fit(scenes, y)
    tree = model.ensemble_.trees[0]
    assert isinstance(tree, Tree)
    values = tree.leaf_probabilities[query(tree, scenes).leaf]

    # All questions together take away the variance of what the leaves say.
    gains = sum(each.share for each in model.importances())
    assert gains == pytest.approx(1.0)
    assert sum(asked.gain for asked in questions(tree)) == pytest.approx(10 * values.var())


@compiled_only
def test_three_classes_are_learned_without_negation() -> None:
    rng = np.random.default_rng(3)
    scenes = scenes_of(rng, 100, 3)
    y = np.where(guest_on_the_left(scenes), 2, np.where(nearest(scenes) < 1.5, 1, 0))
    model = small().fit(scenes, y)

    assert (model.ensemble_.weights > 0).all()
    assert model.predict_proba(scenes).shape == (100, 3)
    assert model.score(scenes, y) >= 0.6
    with pytest.raises(InputError, match="more than two classes cannot be negated"):
        small(negated=0.5).fit(scenes, y)


@pytest.mark.parametrize("negated", [None, 0.5])
def test_numbers_are_predicted_by_trees_for_either_end(negated: float | None) -> None:
    rng = np.random.default_rng(4)
    scenes = scenes_of(rng, 16, 2)
    y = nearest(scenes)
    model = SMRFForestRegressor(n_trees=2, growth=TreeSettings(attempts=1), negated=negated, random_state=0)
    model.fit(scenes, y)

    assert model.ensemble_.start.tolist() == [0.0]
    assert model.ensemble_.weights.tolist() == [0.5, 0.5]
    leaves = [tree.nodes[tree.leaves[0]] for tree in model.ensemble_.trees]
    lowest = [isinstance(leaf, MeanLeaf) and leaf.lowest for leaf in leaves]
    assert negated is None or lowest == [False, True]
    assert abs(model.predict(scenes).mean() - y.mean()) < 0.5 * y.std()
    assert np.nanmax(np.abs(model.oob_prediction_ - y)) < 10


def test_a_sample_of_equal_numbers_gives_a_constant_tree() -> None:
    scenes = scenes_of(np.random.default_rng(5), 6, 1)
    model = SMRFForestRegressor(n_trees=8, max_samples=2, growth=TreeSettings(attempts=1), random_state=0)
    model.fit(scenes, [0.0, 0.0, 0.0, 0.0, 0.0, 3.0])

    leaves = [tree.nodes[0] for tree in model.ensemble_.trees]
    assert MeanLeaf(0.0, 0, 2, 0.0) in leaves
    assert np.isfinite(model.predict(scenes)).all()


def test_scenes_without_weight_are_not_drawn() -> None:
    scenes = scenes_of(np.random.default_rng(6), 12, 1)
    weights = np.repeat([0.0, 1.0], 6)
    model = small(max_samples=4).fit(scenes, [0, 1] * 6, sample_weight=weights)

    # Every tree sees four of the last six scenes, and therefore predicts all others unseen.
    assert not np.isnan(model.oob_decision_function_[:6]).any()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"negated": 1.5}, "negated must be"),
        ({"negated": 0.5, "growth": None}, "negated is for SMRF trees"),
        ({"negated": 0.5, "growth": GrowthSettings()}, "negated is for SMRF trees"),
        ({"max_samples": 7}, "max_samples must be at most the 6 scenes, got 7"),
        ({"max_samples": 1}, "max_samples must be an integer of at least 2"),
        ({"max_samples": 0.0}, "max_samples must be"),
        ({"growth": "smrf"}, "growth must be GrowthSettings"),
        ({"n_trees": 0}, "n_trees must be"),
    ],
)
def test_bad_options_are_refused(options: dict[str, Any], message: str) -> None:
    scenes = scenes_of(np.random.default_rng(0), 6, 1)
    with pytest.raises(InputError, match=message):
        small().set_params(**options).fit(scenes, [0, 1] * 3)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 1.0])
def test_negated_trees_are_spread_evenly(share: float) -> None:
    scenes = scenes_of(np.random.default_rng(0), 6, 1)
    model = clone(small(negated=share)).set_params(n_trees=10, max_samples=3)
    signs = np.sign(model.fit(scenes, [0, 1] * 3).ensemble_.weights)

    assert np.count_nonzero(signs < 0) == round(10 * share)
    assert np.count_nonzero(signs[:5] < 0) in {int(5 * share), int(5 * share) + 1}


def test_damaged_documents_are_refused() -> None:
    schema = plane()
    document = Ensemble(schema, np.zeros(1), (near_tree(schema),), np.ones(1)).to_dict()
    tree = document["trees"][0]

    changes: tuple[dict[str, Any], ...] = (
        {"trees": [tree, [{"value": [0.0], "scenes": 3}]], "weights": [1.0, 1.0]},
        {"trees": [{"nodes": tree["nodes"][:-1]}]},
        {"trees": [{}]},
        {"start": [0.0, 0.0]},
        {"weights": []},
    )
    for change in changes:
        with pytest.raises(ModelFormatError):
            Ensemble.from_dict(document | change)
    mixed = (near_tree(schema), Tree(plane("A"), near_tree(plane("A")).nodes))
    with pytest.raises(ModelFormatError, match="must have its schema"):
        Ensemble(schema, np.zeros(1), mixed, np.ones(2))
