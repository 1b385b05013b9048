"""`BagScaler`: units measured over all instances, given back in the form of the bags."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pytest
from sklearn import config_context
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import MinMaxScaler, StandardScaler
from sklearn.utils.estimator_checks import check_estimator

from relforest.mil import CovAggClassifier
from relforest.mil.scaling import BagScaler, feature_units
from relforest.support.errors import InputError

METHODS = ["standard", "minmax", "deviation"]
# Feature 0 holds 1, 5, 1, 5: mean 3, deviation 2, from 1 to 5. Feature 1 is constant.
BAGS = [[[1.0, 0.1], [5.0, 0.1]], [[1.0, 0.1]], [[5.0, 0.1]]]


def as_lists(bags: Any) -> Any:
    return [bag.tolist() for bag in bags]


@pytest.mark.parametrize(
    ("method", "low", "high"), [("standard", -1.0, 1.0), ("minmax", 0.0, 1.0), ("deviation", 0.5, 2.5)]
)
def test_each_method_by_hand(method: str, low: float, high: float) -> None:
    scaled = BagScaler(method=method).fit_transform(BAGS)

    assert as_lists(scaled) == [[[low, 0.1], [high, 0.1]], [[low, 0.1]], [[high, 0.1]]]


def test_it_agrees_with_scikit_learn_over_all_instances() -> None:
    rng = np.random.default_rng(0)
    bags = [rng.standard_normal((size, 3)) * [1, 50, 1e-3] + [0, 1e3, 5] for size in (1, 4, 2, 9)]
    rows = np.concatenate(bags)
    for method, peer in (("standard", StandardScaler()), ("minmax", MinMaxScaler())):
        scaled = np.concatenate(BagScaler(method=method).fit_transform(bags))
        np.testing.assert_allclose(scaled, peer.fit_transform(rows), rtol=1e-9, atol=1e-12)
    deviations = np.concatenate(BagScaler(method="deviation").fit_transform(bags)).std(axis=0)
    np.testing.assert_allclose(deviations, 1)


def test_other_bags_are_scaled_by_the_training_bags() -> None:
    scaler = BagScaler().fit(BAGS)

    assert as_lists(scaler.transform([[[9.0, 2.0]]])) == [[[3.0, 2.0]]]
    assert (scaler.shift_.tolist(), scaler.width_.tolist(), scaler.n_features_in_) == ([3, 0], [2, 1], 2)


def test_bags_come_back_in_their_form() -> None:
    scaler = BagScaler(method="minmax").fit(BAGS)
    cube = np.array([BAGS[0], BAGS[0]])

    assert scaler.transform(cube).tolist() == [[[0, 0.1], [1, 0.1]]] * 2
    assert scaler.transform(cube[0]).tolist() == [[0, 0.1], [1, 0.1]]
    # Rows of a nested list are bags of one, as everywhere.
    assert scaler.transform(cube[0].tolist()).tolist() == [[0, 0.1], [1, 0.1]]
    points, ids = scaler.transform((cube[0], ["b", "a"]))
    assert (points.tolist(), ids) == ([[0, 0.1], [1, 0.1]], ["b", "a"])
    # A tuple of two bags is no tuple of points and ids.
    assert as_lists(scaler.transform((BAGS[0], BAGS[1]))) == [[[0, 0.1], [1, 0.1]], [[0, 0.1]]]


def test_the_bags_given_are_left_alone() -> None:
    cube = np.array([BAGS[0]])
    BagScaler().fit_transform(cube)

    assert cube.tolist() == [BAGS[0]]


def test_it_stands_before_a_classifier() -> None:
    rng = np.random.default_rng(0)
    bags = list(rng.standard_normal((20, 3, 2)))
    y = np.arange(20) % 2
    for bag in bags[1::2]:
        bag[0] = [4, 4] + 0.2 * rng.standard_normal(2)
    far = [bag * [1e20, 1e-20] for bag in bags]
    model = make_pipeline(BagScaler(), CovAggClassifier(random_state=0)).fit(far, y)

    assert model.predict(far).tolist() == y.tolist()
    assert model.decision_function(far).shape == (20,)


def test_features_that_hardly_vary_count_as_constant() -> None:
    # 0.1 summed thrice and divided has a deviation of rounding only.
    units = feature_units(np.array([[0.1, 0.0], [0.1, 1e-40], [0.1, 0.0]]), "standard")

    assert units.width.tolist() == [0, 0]
    assert units.shift.tolist() == [0, 0]
    assert units.factors.tolist() == [0, 0]


@pytest.mark.parametrize("method", METHODS)
def test_no_check_of_scikit_learn_fails(method: str) -> None:
    results = check_estimator(BagScaler(method=method), on_fail=None, on_skip=None)
    outcomes = {result["check_name"]: (result["status"], result["exception"]) for result in results}

    assert {name: outcome for name, outcome in outcomes.items() if outcome[0] != "passed"} == {}


NAMES = ["mass", "charge"]
FRAMES = [pd.DataFrame(bag, columns=NAMES, index=[f"i{k}" for k in range(len(bag))]) for bag in BAGS]


def test_frames_become_arrays_with_the_columns_of_fit() -> None:
    scaler = BagScaler(method="minmax").fit(FRAMES)

    assert scaler.get_feature_names_out().tolist() == NAMES
    assert as_lists(scaler.transform(FRAMES)) == as_lists(scaler.transform([f[NAMES[::-1]] for f in FRAMES]))
    assert isinstance(scaler.transform(FRAMES)[0], np.ndarray)
    with pytest.raises(InputError, match="yet now missing:\n- charge"):
        scaler.transform([frame[["mass"]] for frame in FRAMES])


@pytest.mark.parametrize(("library", "frame_type"), [("pandas", pd.DataFrame), ("polars", pl.DataFrame)])
def test_set_output_gives_a_frame_for_every_array(library: str, frame_type: type) -> None:
    scaler = BagScaler(method="minmax").fit(FRAMES)
    expected = as_lists(scaler.transform(FRAMES))
    framed = clone(scaler).set_output(transform=library).fit(FRAMES)

    for scaled in (framed.transform(FRAMES), clone(framed).fit_transform(FRAMES)):
        assert all(isinstance(frame, frame_type) for frame in scaled)
        assert [np.asarray(frame).tolist() for frame in scaled] == expected
        assert list(scaled[0].columns) == NAMES
    points, ids = framed.transform((FRAMES[0], ["b", "a"]))
    assert (np.asarray(points).tolist(), ids) == (expected[0], ["b", "a"])
    assert isinstance(framed.transform(FRAMES[0]), frame_type)
    bare = BagScaler().set_output(transform=library).fit(BAGS)
    cube = bare.transform(np.array([BAGS[0], BAGS[0]]))
    assert [list(frame.columns) for frame in cube] == [["x0", "x1"]] * 2
    # None leaves the choice as it is.
    assert isinstance(framed.set_output().transform(FRAMES)[0], frame_type)
    assert isinstance(framed.set_output(transform="default").transform(FRAMES)[0], np.ndarray)


def test_frames_keep_the_index_of_pandas() -> None:
    scaled = BagScaler().set_output(transform="pandas").fit_transform(FRAMES)

    assert [list(frame.index) for frame in scaled] == [list(frame.index) for frame in FRAMES]


def test_the_output_may_be_chosen_for_all_of_scikit_learn() -> None:
    scaler = BagScaler().fit(FRAMES)
    with config_context(transform_output="pandas"):
        assert isinstance(scaler.transform(FRAMES)[0], pd.DataFrame)
    model = make_pipeline(BagScaler(), CovAggClassifier(random_state=0)).set_output(transform="pandas")
    assert model.fit(FRAMES, [1, 0, 0])[-1].feature_names_in_.tolist() == NAMES


def test_other_outputs_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(
        InputError, match="transform must be one of 'default', 'pandas', 'polars', got 'arrow'"
    ):
        BagScaler().set_output(transform="arrow")
    scaler = BagScaler().set_output(transform="polars").fit(BAGS)

    def not_installed(*_args: Any, **_options: Any) -> None:
        raise ModuleNotFoundError

    monkeypatch.setattr("narwhals.from_numpy", not_installed)
    with pytest.raises(InputError, match=r"set_output\(transform='polars'\) needs polars"):
        scaler.transform(BAGS)


def test_scattered_rows_come_back_in_their_places() -> None:
    scaler = BagScaler().fit([[[0.0], [2.0]]])
    points, _ = scaler.transform((np.array([[3.0], [1.0], [5.0]]), ["b", "a", "b"]))

    assert points.tolist() == [[2], [0], [4]]


def test_parameters_are_those_of_scikit_learn() -> None:
    assert clone(BagScaler(method="minmax")).get_params() == {"method": "minmax"}


@pytest.mark.parametrize(
    ("bags", "message"),
    [
        ([], "there are no bags"),
        ([[[0.0]], []], "bag 1 is empty"),
        ([[[0.0]], [[0.0, 1.0]]], "bag 1 has points of 2 components"),
        ([[[np.nan]]], "Input X contains NaN or infinity"),
        ([[[-1e31]]], "values beyond 1e.30: use other units"),
    ],
)
def test_bad_bags_are_refused(bags: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        BagScaler().fit(bags)


def test_other_misuse_is_refused() -> None:
    with pytest.raises(InputError, match="method must be one of 'standard', 'minmax', 'deviation', got 'l2'"):
        BagScaler(method="l2").fit(BAGS)
    with pytest.raises(NotFittedError):
        BagScaler().transform(BAGS)
    with pytest.raises(InputError, match="X has 3 features, but BagScaler is expecting 2 features"):
        BagScaler().fit(BAGS).transform(np.zeros((2, 1, 3)))
    with pytest.raises(InputError, match=r"values beyond 1e.30"):
        BagScaler().fit(BAGS).transform(np.full((2, 1, 2), 1e31))
