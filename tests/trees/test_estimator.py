"""`SMRFTreeClassifier`: scikit-learn's ways with scenes, explanations, bad input."""

from __future__ import annotations

import json
import pickle
from dataclasses import asdict
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.model_selection import GridSearchCV, cross_val_score, train_test_split
from sklearn.utils.estimator_checks import (
    check_no_attributes_set_in_init,
    check_parameters_default_constructible,
)

from interpreted import compiled_only
from relforest import Attribute, Scenes, Schema, SMRFTreeClassifier, SMRFTreeRegressor
from relforest.support.errors import InputError
from relforest.trees import Explanation, Question, Tree, TreeSettings, query
from relforest.trees.significance import likelihood_ratio_p
from relforest.volumes import CovAggSettings, Ellipsoid

pytestmark = compiled_only

SCHEMA = Schema((Attribute("location", 2, operations=("distance",)),), ("passer",))


def passes(n: int = 40, seed: int = 0) -> tuple[Scenes, NDArray[np.bool_]]:
    """A passer and one to three others; positive if one of them stands within 3."""
    rng = np.random.default_rng(seed)
    records: list[dict[str, Any]] = []
    labels = np.arange(n) % 2 == 0
    for scene in range(n):
        passer = rng.uniform(-1, 1, size=2)
        angles = rng.uniform(-np.pi, np.pi, size=rng.integers(1, 4))
        distances = rng.uniform(5, 9, size=len(angles))
        if labels[scene]:
            distances[rng.integers(len(angles))] = rng.uniform(0, 2.5)
        others = passer + distances[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
        objects = [{"id": f"mate {i}", "location": place.tolist()} for i, place in enumerate(others)]
        objects.insert(int(rng.integers(len(objects) + 1)), {"id": "me", "location": passer.tolist()})
        records.append({"id": f"pass {scene}", "objects": objects, "arguments": {"passer": "me"}})
    return Scenes.from_dicts(records, SCHEMA), labels


SCENES, Y = passes()


def fitted(y: Any = Y, **options: Any) -> SMRFTreeClassifier:
    return SMRFTreeClassifier(random_state=0, **options).fit(SCENES, y)


def test_it_learns_the_concept() -> None:
    model = fitted()

    assert model.predict(SCENES).tolist() == Y.tolist()
    assert model.score(SCENES, Y) == 1.0
    test, labels = passes(seed=1)
    assert model.score(test, labels) > 0.9
    assert str(model.tree_).splitlines()[1].startswith("A is the passer; there is a B within")
    assert [step.question for step in model.steps_] == ["distance(location)"]
    assert model.n_left_out_ == 0


def test_probabilities() -> None:
    model = fitted()
    probabilities = model.predict_proba(SCENES)

    assert probabilities.shape == (40, 2)
    np.testing.assert_allclose(probabilities.sum(axis=1), 1)
    np.testing.assert_array_equal(probabilities[:, 1], model.tree_.leaf_probabilities[model.apply(SCENES)])
    np.testing.assert_array_equal(probabilities[:, 1] >= 0.5, model.predict(SCENES))


def test_at_even_odds_the_positive_class_is_predicted() -> None:
    # 20 of 40 are positive, and nothing was learned.
    stub = fitted(alpha=1e-12)

    assert stub.predict_proba(SCENES)[0].tolist() == [0.5, 0.5]
    assert stub.predict(SCENES).all()


def test_leaves_are_those_of_the_tree() -> None:
    model = fitted()

    np.testing.assert_array_equal(model.apply(SCENES), query(model.tree_, SCENES).leaf)


@pytest.mark.parametrize(("no", "yes"), [(0, 1), (-1, 1), (False, True), ("lost", "safe"), (2.0, 5.0)])
def test_labels_of_any_type(no: Any, yes: Any) -> None:
    y = [yes if label else no for label in Y]
    model = fitted(y)

    assert model.classes_.tolist() == [no, yes]
    assert model.predict(SCENES).tolist() == y
    assert model.tree_.to_dict() == fitted().tree_.to_dict()


def test_explanations_name_the_objects() -> None:
    explanations = fitted().explain(SCENES)

    assert [each.scene for each in explanations] == [f"pass {i}" for i in range(40)]
    for each, label in zip(explanations, Y, strict=True):
        assert each.probability == float(label)
        assert each.witnesses["A"] == "me"
        assert str(each.witnesses["B"]).startswith("mate")
        assert len(each.densities) == 1
        assert 0 < each.densities[0] <= 1


def test_the_witness_is_the_mate_who_is_near() -> None:
    model = fitted()
    question = model.tree_.nodes[2]
    assert isinstance(question, Question)
    assert isinstance(question.volume, Ellipsoid)
    centre = question.volume.mean[0]
    for position, each in enumerate(model.explain(SCENES)):
        if not Y[position]:
            continue
        rows = SCENES.objects(position)
        me = next(row for row in rows if SCENES.object_ids[row] == "me")
        gaps = {
            str(SCENES.object_ids[row]): abs(np.linalg.norm(SCENES.matrix[row] - SCENES.matrix[me]) - centre)
            for row in rows
            if row != me
        }
        assert each.witnesses["B"] == min(gaps, key=lambda name: gaps[name])


def test_explanations_of_missing_objects() -> None:
    alone = Scenes.from_dicts(
        [
            {"id": 1, "objects": [{"id": 5, "location": [0.0, 0.0]}], "arguments": {"passer": 5}},
            {"id": 2, "objects": [], "arguments": {}},
        ],
        SCHEMA,
    )
    first, second = fitted().explain(alone)

    assert (first.scene, first.leaf, first.witnesses, first.densities) == (1, 2, {"A": 5, "B": None}, (0.0,))
    assert second.witnesses == {"A": None, "B": None}
    assert type(first.scene) is int
    assert type(first.witnesses["A"]) is int


def test_explanations_in_one_line() -> None:
    assert str(Explanation("pass 7", 0.75, 1, {"A": "me", "B": None}, (0.5,))) == (
        "scene pass 7: probability 0.75, leaf 1, A = me, B = None"
    )
    stub = fitted(alpha=1e-12)
    assert stub.tree_.is_stub
    assert str(stub.explain(SCENES)[0]) == "scene pass 0: probability 0.50, leaf 0, no objects"


def test_parameters_are_those_of_scikit_learn() -> None:
    model = SMRFTreeClassifier(alpha=0.1, n_jobs=2)
    copy = clone(model).set_params(attempts=5)

    changed = {"alpha": 0.1, "n_jobs": 2, "attempts": 5}
    assert copy.get_params() == SMRFTreeClassifier().get_params() | changed
    check_no_attributes_set_in_init("SMRFTreeClassifier", model)
    check_parameters_default_constructible("SMRFTreeClassifier", model)


def test_defaults_are_those_of_the_settings() -> None:
    settings = asdict(TreeSettings())
    assert settings.pop("covagg") == asdict(CovAggSettings())
    settings["covagg"] = None

    assert SMRFTreeRegressor().get_params() == settings | {"decides": "either"} | {
        "random_state": None,
        "n_jobs": 1,
        "verbose": False,
    }
    assert SMRFTreeClassifier().get_params() == settings | {
        "class_weight": None,
        "random_state": None,
        "n_jobs": 1,
        "verbose": False,
    }


def in_a_strip(n: int = 40) -> tuple[Scenes, NDArray[np.bool_]]:
    """Two objects in a square; positive if one of them has y below -3, x being all the same."""
    rng = np.random.default_rng(3)
    places, labels = rng.uniform([-9, -2], 9, size=(n, 2, 2)), np.arange(n) % 2 == 0
    places[labels, 0, 1] = rng.uniform(-8, -4, size=n // 2)
    records = [{"objects": [{"location": place} for place in scene]} for scene in places.tolist()]
    schema = Schema((Attribute("location", 2, operations=("identity", "difference")),))
    return Scenes.from_dicts(records, schema), labels


@pytest.mark.parametrize("search", ["screened", "exhaustive"])
@pytest.mark.parametrize("learner", ["covagg", "diverse-density"])
def test_volumes_of_one_coordinate(search: Any, learner: Any) -> None:
    scenes, labels = in_a_strip()
    model = SMRFTreeClassifier(
        random_state=0, attempts=1, search=search, covagg=CovAggSettings(shape="axis", learner=learner)
    ).fit(scenes, labels)
    again = Tree.from_dict(json.loads(json.dumps(model.tree_.to_dict())))

    assert model.score(scenes, labels) == 1.0
    assert str(model.tree_).splitlines()[1].startswith("there is an A such that y of A is ")
    np.testing.assert_array_equal(query(again, scenes).leaf, model.apply(scenes))
    # -2 log L of 40 scenes falls from 40 ln 4 to 0, by centre, width, which coordinate, and a leaf.
    assert model.steps_[0].p_value == pytest.approx(likelihood_ratio_p(40 * np.log(2), 4))


def test_the_permutation_test_takes_other_volumes() -> None:
    volumes = CovAggSettings(learner="diverse-density")
    model = fitted(test="permutation", permutations=3, alpha=0.25, attempts=1, covagg=volumes)
    assert model.score(SCENES, Y) == 1.0


@pytest.mark.parametrize("search", ["screened", "exhaustive"])
def test_volumes_along_the_axes(search: Any) -> None:
    scenes, labels = in_a_strip()
    model = SMRFTreeClassifier(
        random_state=0, attempts=1, search=search, covagg=CovAggSettings(shape="diagonal")
    )
    question = model.fit(scenes, labels).tree_.nodes[1]

    assert isinstance(question, Question)
    assert isinstance(question.volume, Ellipsoid)
    assert question.volume.covariance[0, 1] == 0.0
    assert model.steps_[0].p_value == pytest.approx(likelihood_ratio_p(model.steps_[0].gain, 5))


def test_regression_with_other_volumes() -> None:
    scenes, labels = in_a_strip()
    for settings in (
        CovAggSettings(shape="axis", learner="diverse-density"),
        CovAggSettings(shape="diagonal"),
    ):
        model = SMRFTreeRegressor(random_state=0, attempts=1, covagg=settings).fit(scenes, 1.0 + labels)
        assert model.score(scenes, 1.0 + labels) > 0.9


def test_volumes_are_settings() -> None:
    with pytest.raises(InputError, match=r"covagg must be CovAggSettings\(\.\.\.\) or None, got 'axis'"):
        fitted(covagg="axis")
    model = clone(SMRFTreeClassifier(covagg=CovAggSettings(shape="axis")))
    assert model.covagg == CovAggSettings(shape="axis")


def test_cross_validation_takes_scenes() -> None:
    scores = cross_val_score(SMRFTreeClassifier(random_state=0), SCENES, Y, cv=3)

    assert scores.shape == (3,)
    assert scores.mean() > 0.85


def test_model_selection_takes_scenes() -> None:
    train, test, y_train, y_test = train_test_split(SCENES, Y, random_state=0, stratify=Y)
    search = GridSearchCV(SMRFTreeClassifier(random_state=0), {"alpha": [0.05, 1e-9]}, cv=2).fit(
        train, y_train
    )

    assert len(train) + len(test) == 40
    assert search.best_params_ == {"alpha": 0.05}
    assert search.score(test, y_test) > 0.7


def test_the_same_seed_grows_the_same_tree_whatever_the_number_of_threads() -> None:
    model, other = fitted(), fitted(n_jobs=3)

    assert model.tree_.to_dict() == other.tree_.to_dict()
    np.testing.assert_array_equal(model.predict_proba(SCENES), other.predict_proba(SCENES))


def test_the_permutation_test() -> None:
    model = fitted(test="permutation", permutations=19, attempts=1)

    assert [step.p_value for step in model.steps_] == [1 / 20]


def test_expansions_left_out_are_counted() -> None:
    model = fitted(max_points=40, search="exhaustive")

    # 40 sequences for the passer, more for the passer and a mate; two mates without him are more still.
    assert model.tree_.is_stub
    assert model.n_left_out_ > 0


def test_a_model_can_be_pickled() -> None:
    model = fitted()
    again = pickle.loads(pickle.dumps(model))  # noqa: S301 - our own

    np.testing.assert_array_equal(again.predict_proba(SCENES), model.predict_proba(SCENES))


@pytest.mark.parametrize(
    ("y", "message"),
    [
        (Y[:-1], "got 39 labels for 40 scenes: give one label for each"),
        (np.ones(40), "labels of 2 classes are needed, but 40 scenes have only 1 class: 1"),
        (np.arange(40) % 21, "40 scenes have 21 classes: give at least two scenes a class on average"),
        (np.where(Y, np.nan, 1.0), "labels contain NaN"),
        (None, "y should be a 1d array"),
    ],
)
def test_bad_labels_are_refused(y: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        SMRFTreeClassifier().fit(SCENES, y)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"test": "bayes"}, "test must be one of"),
        ({"alpha": 2.0}, "alpha must be a number above 0 and below 1"),
        ({"attempts": 0}, "attempts must be an integer of at least 1, got 0"),
        ({"permutations": -1}, "permutations must be an integer of at least 1, got -1"),
        ({"max_points": 0}, "max_points must be an integer of at least 1"),
        ({"random_state": -1}, "random_state must be an integer of at least 0"),
    ],
)
def test_bad_parameters_are_refused_by_fit(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        SMRFTreeClassifier(**options).fit(SCENES, Y)


@pytest.mark.parametrize("n_jobs", [0, -2, 1.5])
def test_a_bad_number_of_threads_is_refused(n_jobs: Any) -> None:
    with pytest.raises(InputError, match="n_jobs must be a positive integer, or -1 for all cores"):
        fitted(n_jobs=n_jobs).predict(SCENES)


@pytest.mark.parametrize("method", ["predict", "predict_proba", "apply", "explain"])
def test_prediction_needs_a_fitted_model_and_scenes_of_its_schema(method: str) -> None:
    other = Scenes.from_dicts([{"objects": [{"location": [0.0, 0.0]}]}])
    with pytest.raises(NotFittedError, match="not fitted yet"):
        getattr(SMRFTreeClassifier(), method)(SCENES)
    with pytest.raises(InputError, match=r"expected Scenes, got list: use Scenes\.from_frame"):
        getattr(fitted(), method)([[0.0, 0.0]])
    with pytest.raises(InputError, match="the model is for scenes with"):
        getattr(fitted(), method)(other)


def test_learning_needs_scenes() -> None:
    with pytest.raises(InputError, match="expected Scenes, got ndarray"):
        SMRFTreeClassifier().fit(np.zeros((40, 2)), Y)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="got 40 labels for 0 scenes"):
        SMRFTreeClassifier().fit(SCENES.take([]), Y)
