"""Estimators of bags inside scikit-learn: ensembles, searches, data frames, copies."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest
from scipy.special import expit
from sklearn.base import clone
from sklearn.calibration import CalibratedClassifierCV
from sklearn.ensemble import BaggingClassifier
from sklearn.model_selection import GridSearchCV, cross_val_score
from sklearn.pipeline import make_pipeline

from interpreted import compiled_only
from relforest import CovAggClassifier
from relforest.datasets import BagSet
from relforest.mil import BagScaler, VolumeCommitteeClassifier
from relforest.mil.baselines import (
    APRClassifier,
    BagMarginSVMClassifier,
    DiverseDensityClassifier,
    EMDDClassifier,
    InstanceMarginSVMClassifier,
    MILESClassifier,
    OptimalBallClassifier,
    SingleInstanceSVMClassifier,
)
from relforest.support.errors import InputError

pytestmark = compiled_only

RNG = np.random.default_rng(0)
Y = np.arange(24) % 2
# Feature 1 is ten times as wide as feature 0, so that it matters which is which.
BAGS = [RNG.normal(size=(2 + bag % 2, 2)) * [1, 10] for bag in range(24)]
for _bag in BAGS[1::2]:
    _bag[0] = [4, 4] + 0.2 * RNG.normal(size=2)
NAMES = ["mass", "charge"]
ESTIMATORS: dict[str, Any] = {
    "covagg": CovAggClassifier(random_state=0),
    "committee": VolumeCommitteeClassifier(random_state=0, n_splits=2, n_volumes=2, n_balls=10),
    "ball": OptimalBallClassifier(),
    "box": APRClassifier(scale=True),
    "density": DiverseDensityClassifier(refined=1, max_steps=30),
    "EM": EMDDClassifier(random_state=0, start_bags=1, max_steps=30),
    "MILES": MILESClassifier(random_state=0, max_iter=20),
    "MI-SVM": BagMarginSVMClassifier(),
    "mi-SVM": InstanceMarginSVMClassifier(),
    "SI-SVM": SingleInstanceSVMClassifier(),
    "pipeline": make_pipeline(BagScaler(), OptimalBallClassifier()),
}
each_estimator = pytest.mark.parametrize("name", ESTIMATORS)
FRAMES: dict[str, Any] = {
    "pandas": lambda points, names: pd.DataFrame(points, columns=names),
    "polars": lambda points, names: pl.DataFrame(points, schema=names, orient="row"),
    "pyarrow": lambda points, names: pa.table(dict(zip(names, np.transpose(points), strict=True))),
}
each_library = pytest.mark.parametrize("library", FRAMES)


def framed(library: str = "pandas", order: tuple[int, ...] = (0, 1), bags: Any = BAGS) -> list[Any]:
    """Bags as frames, with their columns in an order."""
    return [FRAMES[library](bag[:, order], [NAMES[place] for place in order]) for bag in bags]


def in_cells(bags: Any) -> Any:
    column = np.empty((len(bags), 1), dtype=object)
    for row, bag in enumerate(bags):
        column[row, 0] = bag
    return column


@each_estimator
def test_columns_in_another_order_are_matched_by_name(name: str) -> None:
    model = clone(ESTIMATORS[name]).fit(framed(), Y)
    expected = clone(ESTIMATORS[name]).fit(BAGS, Y).decision_function(BAGS)

    assert model.feature_names_in_.tolist() == NAMES
    for bags in (framed(), framed(order=(1, 0)), [*framed()[:1], *framed(order=(1, 0))[1:]]):
        assert model.decision_function(bags).tolist() == expected.tolist()


@each_library
def test_it_is_so_for_every_library_and_form(library: str) -> None:
    points, ids = np.concatenate(BAGS), np.repeat(np.arange(24), [len(bag) for bag in BAGS])
    model = OptimalBallClassifier().fit(framed(library), Y)
    expected = model.decision_function(framed(library)).tolist()
    swapped = FRAMES[library](points[:, ::-1], NAMES[::-1])

    assert model.decision_function(framed(library, (1, 0))).tolist() == expected
    assert model.decision_function((swapped, ids)).tolist() == expected
    alone = framed(bags=points[:, np.newaxis])
    assert model.decision_function(swapped).tolist() == model.decision_function(alone).tolist()


def test_predictions_of_instances_match_columns_too() -> None:
    model = CovAggClassifier(random_state=0).fit(framed(), Y)

    assert model.witness(framed(order=(1, 0))).tolist() == model.witness(framed()).tolist()
    committee = clone(ESTIMATORS["committee"]).fit(framed(), Y)
    for one, other in zip(
        committee.influences(framed(order=(1, 0))), committee.influences(framed()), strict=True
    ):
        assert one.tolist() == other.tolist()


def test_missing_and_unseen_columns_are_named() -> None:
    model = OptimalBallClassifier().fit(framed(), Y)
    renamed = [frame.rename(columns={"charge": "spin"}) for frame in framed()]
    with pytest.raises(InputError) as caught:
        model.predict(renamed)
    assert str(caught.value) == (
        "The feature names should match those that were passed during fit.\n"
        "Feature names unseen at fit time:\n- spin\n"
        "Feature names seen at fit time, yet now missing:\n- charge"
    )
    with pytest.raises(InputError, match=r"during fit.\nFeature names unseen at fit time:\n- spin$"):
        model.predict([frame.assign(spin=0.0) for frame in framed()])
    with pytest.raises(InputError, match=r"during fit.\nFeature names seen at .*missing:\n- charge$"):
        model.predict([frame[["mass"]] for frame in framed()])
    many = [frame.assign(**{f"f{i}": 0.0 for i in range(7)}) for frame in framed()]
    with pytest.raises(InputError, match=r"- f4\n- \.\.\.$"):
        model.predict(many)


def test_names_at_fit_only_or_at_predict_only_are_warned_about() -> None:
    named, bare = OptimalBallClassifier().fit(framed(), Y), OptimalBallClassifier().fit(BAGS, Y)
    with pytest.warns(UserWarning, match="X does not have valid feature names, but OptimalBall"):
        named.predict(BAGS)
    with pytest.warns(UserWarning, match="X has feature names, but OptimalBallClassifier was fitted without"):
        bare.predict(framed())
    assert not hasattr(bare, "feature_names_in_")
    assert not hasattr(named.fit(BAGS, Y), "feature_names_in_")


def test_labels_that_are_not_names_match_only_if_they_are_the_same() -> None:
    numbered = [pd.DataFrame(bag) for bag in BAGS]
    model = OptimalBallClassifier().fit(numbered, Y)
    expected = model.predict(numbered).tolist()

    assert not hasattr(model, "feature_names_in_")
    assert model.predict([frame[[1, 0]] for frame in numbered]).tolist() == expected
    assert model.predict([frame.set_axis([7, 8], axis=1) for frame in numbered]).tolist() == expected
    with pytest.raises(InputError, match="X has 1 features, but OptimalBallClassifier is expecting 2"):
        model.predict([frame[[0]] for frame in numbered])


def test_a_bag_set_brings_its_labels() -> None:
    data = BagSet(BAGS, Y == 1)
    model = CovAggClassifier(random_state=0).fit(data)

    assert model.decision_function(data).tolist() == model.fit(BAGS, Y == 1).decision_function(BAGS).tolist()
    assert model.fit(data, Y).classes_.tolist() == [0, 1]
    assert len(BagScaler().fit(data).transform(data)) == 24
    with pytest.raises(InputError, match="requires y to be passed, but the target y is None"):
        model.fit(data.bags)


def test_ensembles_take_a_column_of_bags() -> None:
    model = BaggingClassifier(OptimalBallClassifier(), n_estimators=3, random_state=0)
    model.fit(in_cells(BAGS), Y)

    assert model.score(in_cells(BAGS), Y) > 0.8
    scaled = BaggingClassifier(make_pipeline(BagScaler(), OptimalBallClassifier()), n_estimators=2)
    assert scaled.set_params(random_state=0).fit(in_cells(BAGS), Y).predict(in_cells(BAGS)).shape == (24,)


def test_searches_and_calibration_take_bags_in_cells() -> None:
    cells = in_cells(BAGS)
    search = GridSearchCV(OptimalBallClassifier(), {"normalize": [True, False]}, cv=3).fit(cells, Y)
    calibrated = CalibratedClassifierCV(OptimalBallClassifier(), cv=3).fit(cells, Y)

    assert search.predict(cells).shape == (24,)
    assert cross_val_score(OptimalBallClassifier(), cells, Y, cv=3).mean() > 0.7
    assert calibrated.predict_proba(cells).sum(axis=1) == pytest.approx(np.ones(24))


@each_estimator
def test_copies_learn_and_predict_the_same(name: str) -> None:
    model = clone(ESTIMATORS[name]).fit(framed(), Y)
    expected = model.decision_function(framed()).tolist()

    for twin in (copy.deepcopy(model), pickle.loads(pickle.dumps(model)), clone(model).fit(framed(), Y)):  # noqa: S301  # our own
        assert twin.decision_function(framed(order=(1, 0))).tolist() == expected
        assert twin.get_params().keys() == model.get_params().keys()


@pytest.mark.parametrize("make", [np.random.RandomState, np.random.default_rng])
@pytest.mark.parametrize("name", ["covagg", "EM", "MILES", "committee"])
def test_a_generator_as_random_state_gives_new_seeds_in_turn(name: str, make: Any) -> None:
    model, again = (clone(ESTIMATORS[name]).set_params(random_state=make(3)) for _ in range(2))
    first = model.fit(BAGS, Y).decision_function(BAGS).tolist()

    assert again.fit(BAGS, Y).decision_function(BAGS).tolist() == first
    state = model.random_state
    before = copy.deepcopy(state)
    model.fit(BAGS, Y)
    assert _draw(state) != _draw(before)


def _draw(state: Any) -> list[int]:
    draw = state.randint if hasattr(state, "randint") else state.integers
    drawn: list[int] = draw(0, 2**31, 4).tolist()
    return drawn


CLASSIFIERS = {name: model for name, model in ESTIMATORS.items() if name != "pipeline"}
each_classifier = pytest.mark.parametrize("name", CLASSIFIERS)
WEIGHTED = ("committee", "ball", "density", "EM", "MILES", "MI-SVM", "mi-SVM", "SI-SVM")


@each_classifier
def test_probabilities_agree_with_predictions_and_rise_with_scores(name: str) -> None:
    model = clone(CLASSIFIERS[name]).set_params(probability=True).fit(BAGS, Y)
    shares, scores = model.predict_proba(BAGS), model.decision_function(BAGS)

    assert shares.shape == (24, 2)
    assert shares.sum(axis=1) == pytest.approx(np.ones(24))
    assert (model.classes_[shares.argmax(axis=1)] == model.predict(BAGS)).all()
    assert (np.diff(shares[np.argsort(scores), 1]) >= 0.0).all()
    # Learning what the scores mean does not change them.
    assert scores.tolist() == clone(CLASSIFIERS[name]).fit(BAGS, Y).decision_function(BAGS).tolist()


@each_classifier
def test_without_the_option_only_log_odds_are_probabilities(name: str) -> None:
    model = clone(CLASSIFIERS[name]).fit(BAGS, Y)
    if name in ("committee", "density", "EM"):
        odds = model.decision_function(BAGS)
        assert model.predict_proba(BAGS)[:, 1] == pytest.approx(expit(odds))
    else:
        assert not hasattr(model, "predict_proba")
        with pytest.raises(AttributeError, match="has no attribute 'predict_proba'"):
            model.predict_proba(BAGS)


@each_classifier
def test_three_classes_are_each_told_from_the_others(name: str) -> None:
    names = np.array(["plain", "near", "far"])[np.where(np.arange(24) % 4 == 2, 2, Y)]
    bags = [bag + 200.0 * (label == "far") for bag, label in zip(BAGS, names, strict=True)]
    model = clone(CLASSIFIERS[name]).fit(bags, names)
    scores, shares = model.decision_function(bags), model.predict_proba(bags)

    assert model.classes_.tolist() == ["far", "near", "plain"]
    assert scores.shape == shares.shape == (24, 3)
    assert shares.sum(axis=1) == pytest.approx(np.ones(24))
    assert (model.predict(bags) == model.classes_[scores.argmax(axis=1)]).all()
    assert (shares.argmax(axis=1) == scores.argmax(axis=1)).all()
    for code, machine in enumerate(model.estimators_):
        assert machine.predict_proba(bags)[:, 1] == pytest.approx(expit(scores[:, code]))
        assert type(machine) is type(model)
    method = "witness" if hasattr(model, "witness") else "influences"
    if hasattr(model, method):
        with pytest.raises(InputError, match="has 3 classes: ask one of estimators_"):
            getattr(model, method)(bags)
        assert len(getattr(model.estimators_[0], method)(bags)) == 24
    # Two classes again leave nothing behind.
    again = model.fit(BAGS, Y)
    assert not hasattr(again, "estimators_")
    assert (
        again.decision_function(BAGS).tolist() == clone(model).fit(BAGS, Y).decision_function(BAGS).tolist()
    )


@pytest.mark.parametrize("name", WEIGHTED)
def test_weights_count_and_bags_without_weight_do_not(name: str) -> None:
    kept = np.arange(24) % 6 != 3
    weighted = clone(CLASSIFIERS[name]).fit(BAGS, Y, sample_weight=kept)
    without = clone(CLASSIFIERS[name]).fit(
        [bag for bag, is_in in zip(BAGS, kept, strict=True) if is_in], Y[kept]
    )
    equal = clone(CLASSIFIERS[name]).fit(BAGS, Y, sample_weight=np.full(24, 3.0))
    plain = clone(CLASSIFIERS[name]).fit(BAGS, Y).decision_function(BAGS)

    assert weighted.decision_function(BAGS).tolist() == without.decision_function(BAGS).tolist()
    assert equal.decision_function(BAGS).tolist() == plain.tolist()
    # Contradictions are settled by the heavier bags.
    bags, y = [*BAGS, *BAGS], np.concatenate([Y, 1 - Y])
    heavy = np.repeat([30.0, 1.0], 24)
    believed = clone(CLASSIFIERS[name]).fit(bags, y, sample_weight=heavy).predict(BAGS)
    assert (believed == Y).mean() > 0.6


@pytest.mark.parametrize("name", sorted(set(CLASSIFIERS) - set(WEIGHTED)))
def test_a_method_that_cannot_use_weights_does_not_take_them(name: str) -> None:
    with pytest.raises(InputError, match="Classifier counts bags and cannot use sample_weight: repeat bags"):
        clone(CLASSIFIERS[name]).fit(BAGS, Y, sample_weight=np.ones(24))


def test_a_weight_counts_like_that_many_bags() -> None:
    counts = 1 + np.arange(24) % 3
    weighted = OptimalBallClassifier().fit(BAGS, Y, sample_weight=counts)
    repeated = OptimalBallClassifier().fit(
        [bag for bag, count in zip(BAGS, counts, strict=True) for _ in range(count)], Y.repeat(counts)
    )

    assert weighted.radius_ == repeated.radius_
    assert weighted.centre_.tolist() == repeated.centre_.tolist()
