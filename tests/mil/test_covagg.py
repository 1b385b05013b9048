"""`CovAggClassifier`: every form of bags and labels, and how it refuses bad ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import sparse
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.model_selection import cross_val_score

from relforest import CovAggClassifier
from relforest.support.errors import InputError
from relforest.volumes import Ellipsoid, Slab

Floats = NDArray[np.float64]
N_BAGS, SIZE = 24, 3
Y = np.arange(N_BAGS) % 2


def squeezed(seed: int = 0) -> Floats:
    """Bags (24, 3, 2) of standard normal points; the odd ones hold a point near (4, 4) at any place."""
    rng = np.random.default_rng(seed)
    bags = rng.standard_normal((N_BAGS, SIZE, 2))
    for bag in range(1, N_BAGS, 2):
        bags[bag, rng.integers(SIZE)] = [4, 4] + 0.3 * rng.standard_normal(2)
    return bags


BAGS = squeezed()


def scattered(bags: Floats, seed: int = 1) -> tuple[Floats, NDArray[np.int64]]:
    """The points of all bags in any order, but with the bags' first points in the bags' order."""
    n_bags, size = bags.shape[:2]
    first = np.arange(n_bags) * size
    rest = np.setdiff1d(np.arange(n_bags * size), first)
    rows = np.concatenate([first, np.random.default_rng(seed).permutation(rest)])
    return bags.reshape(-1, bags.shape[2])[rows], rows // size * 10 + 7


FORMS: dict[str, Any] = {
    "list": list(BAGS),
    "list of lists": BAGS.tolist(),
    "tuple with grouped ids": (BAGS.reshape(-1, 2), np.repeat(np.arange(N_BAGS), SIZE)),
    "tuple with scattered ids": scattered(BAGS),
    "tuple with names": (BAGS.reshape(-1, 2), [f"bag {i // SIZE}" for i in range(N_BAGS * SIZE)]),
    "array": BAGS,
    "single precision": BAGS.astype(np.float32),
}


def fitted(bags: Any = BAGS, y: Any = Y, **options: Any) -> CovAggClassifier:
    return CovAggClassifier(random_state=0, **options).fit(bags, y)


def ellipsoid_of(model: CovAggClassifier) -> Ellipsoid:
    assert isinstance(model.volume_, Ellipsoid)
    return model.volume_


@pytest.mark.parametrize("form", FORMS)
def test_all_forms_of_bags_give_the_same_volume_and_predictions(form: str) -> None:
    model, expected = fitted(FORMS[form]), fitted()

    assert model.volume_.radius == pytest.approx(expected.volume_.radius, rel=1e-5)
    np.testing.assert_allclose(model.volume_.mean, expected.volume_.mean, rtol=1e-5)
    np.testing.assert_allclose(ellipsoid_of(model).covariance, ellipsoid_of(expected).covariance, rtol=1e-5)
    assert model.predict(FORMS[form]).tolist() == expected.predict(BAGS).tolist() == Y.tolist()
    np.testing.assert_allclose(
        model.decision_function(FORMS[form]), expected.decision_function(BAGS), rtol=1e-5
    )


def test_one_instance_per_bag_may_be_a_plain_array() -> None:
    rows = BAGS[:, 0]
    model, expected = fitted(rows), fitted(rows[:, None])

    assert model.volume_.to_dict() == expected.volume_.to_dict()
    assert model.predict(rows).tolist() == expected.predict(list(rows[:, None])).tolist()
    assert model.n_features_in_ == 2


def test_it_learns_the_concept() -> None:
    model = fitted()
    test = squeezed(5)

    assert np.linalg.norm(model.volume_.mean - 4) < 0.5
    assert (model.predict(test) == Y).mean() > 0.9
    assert model.score(BAGS, Y) == 1.0


@pytest.mark.parametrize(
    ("no", "yes"),
    [(0, 1), (-1, 1), (False, True), ("far", "near"), (3, 7), (0.0, 1.0), ("a", "b")],
)
def test_labels_of_any_type(no: Any, yes: Any) -> None:
    y = [yes if label else no for label in Y]
    model = fitted(BAGS, y)

    assert model.classes_.tolist() == [no, yes]
    assert model.predict(BAGS).tolist() == y
    assert model.volume_.to_dict() == fitted().volume_.to_dict()


def test_labels_in_an_object_array() -> None:
    y = np.array(["no", "yes"], dtype=object)[Y]

    assert fitted(BAGS, y).predict(BAGS).tolist() == y.tolist()


def test_the_second_class_is_the_positive_one() -> None:
    # With the classes exchanged the bags without the squeezed point are positive, a harder concept.
    swapped = fitted(BAGS, 1 - Y)

    assert swapped.classes_.tolist() == [0, 1]
    assert swapped.score(BAGS, 1 - Y) >= 0.5


@pytest.mark.parametrize("form", ["list", "tuple with scattered ids", "array"])
def test_decision_is_radius_minus_witness_distance(form: str) -> None:
    model = fitted()
    distances = model.volume_.distance(BAGS.reshape(-1, 2)).reshape(N_BAGS, SIZE)
    decision = model.decision_function(FORMS[form])

    np.testing.assert_allclose(decision, model.volume_.radius - distances.min(axis=1))
    assert (model.predict(FORMS[form]) == (decision >= 0)).all()


def test_a_witness_on_the_boundary_is_inside() -> None:
    # Keys 0 and 2: mean 1; the boundary lies midway between 2 and 6, that is at 4 and -2.
    model = fitted([[[0.0]], [[2.0]], [[6.0]]], [1, 1, 0])
    on_boundary = model.volume_.mean[0] + ellipsoid_of(model).axes[0, 0]

    assert abs(on_boundary - 1) == pytest.approx(3)
    assert model.decision_function([[[on_boundary]]]) == pytest.approx(0, abs=1e-12)
    assert model.predict([[[3.999]], [[4.001]], [[-1.999]]]).tolist() == [1, 0, 1]
    # Exactly on it: 3, 4, 5.
    model = fitted()
    model.volume_ = Ellipsoid(np.zeros(2), np.eye(2), 5.0, 1, 0.1)
    assert model.decision_function([[[3.0, 4.0]]]).tolist() == [0]
    assert model.predict([[[3.0, 4.0]]]).tolist() == [1]
    assert model.predict_instances([[[3.0, 4.0], [3.0, 4.1]]])[0].tolist() == [True, False]


def test_instances_and_witnesses_come_in_the_order_of_the_bags() -> None:
    model = fitted()
    distances = model.volume_.distance(BAGS.reshape(-1, 2)).reshape(N_BAGS, SIZE)
    inside = model.predict_instances(BAGS)

    assert [bag.tolist() for bag in inside] == (distances <= model.volume_.radius).tolist()
    assert all(bag.dtype == np.bool_ for bag in inside)
    assert model.witness(BAGS).tolist() == distances.argmin(axis=1).tolist()
    assert [bool(bag.any()) for bag in inside] == (model.predict(BAGS) == 1).tolist()


def test_scattered_rows_are_counted_within_their_bag() -> None:
    # Rows of bag "p": 0, 3, 4; of bag "q": 1, 2.
    model = fitted([[[0.0]], [[2.0]], [[6.0]]], [1, 1, 0])
    points = np.array([[9.0], [1.0], [8.0], [7.0], [0.5]])
    ids = ["p", "q", "q", "p", "p"]

    assert model.witness((points, ids)).tolist() == [2, 0]
    assert [bag.tolist() for bag in model.predict_instances((points, ids))] == [
        [False, False, True],
        [True, False],
    ]
    assert model.predict((points, ids)).tolist() == [1, 1]


def test_the_first_of_equally_near_instances_is_the_witness() -> None:
    model = fitted([[[0.0]], [[2.0]], [[6.0]]], [1, 1, 0])

    assert model.witness([[[3.0], [1.0], [1.0]], [[0.0], [2.0]]]).tolist() == [1, 0]


def test_bags_of_different_sizes() -> None:
    bags = [np.array(bag, dtype=np.float64) for bag in ([[0.0]], [[2.0], [9.0]], [[6.0], [7.0], [8.0]])]
    model = fitted(bags, [1, 1, 0])

    assert [len(bag) for bag in model.predict_instances(bags)] == [1, 2, 3]
    assert model.predict(bags).tolist() == [1, 1, 0]


def test_constant_features_change_nothing() -> None:
    padded = np.concatenate([np.full((N_BAGS, SIZE, 1), 7.0), BAGS, np.zeros((N_BAGS, SIZE, 2))], axis=2)
    model, expected = fitted(padded), fitted()

    assert model.predict(padded).tolist() == expected.predict(BAGS).tolist()
    np.testing.assert_allclose(model.volume_.mean, [7, *expected.volume_.mean, 0, 0], rtol=1e-9)


def test_duplicate_instances_change_nothing_but_the_prior() -> None:
    # The prior is the spread of all points divided by their number, and twice each point has the same.
    model = fitted(np.concatenate([BAGS, BAGS], axis=1))

    np.testing.assert_allclose(model.volume_.mean, fitted().volume_.mean)
    np.testing.assert_allclose(ellipsoid_of(model).covariance, ellipsoid_of(fitted()).covariance)


def test_many_more_features_than_bags() -> None:
    rng = np.random.default_rng(0)
    bags = rng.standard_normal((N_BAGS, 2, 1500))
    bags[Y == 1, 0, :100] += 2.0
    model = fitted(bags)

    assert model.score(bags, Y) >= 0.9
    covariance = ellipsoid_of(model).covariance
    assert (covariance == covariance.T).all()


def test_the_same_seed_gives_the_same_volume() -> None:
    assert fitted().volume_.to_dict() == fitted().volume_.to_dict()
    sequence = np.random.SeedSequence(0)
    again = CovAggClassifier(random_state=sequence).fit(BAGS, Y)
    assert again.volume_.to_dict() == fitted().volume_.to_dict()


def test_numpy_numbers_as_parameters() -> None:
    # Such as a grid search over arrays passes; the volume must still go into JSON.
    model = fitted(window=np.int64(8), prior_weight=np.float32(0.25), max_condition=np.int64(100))

    assert type(ellipsoid_of(model).prior_weight) is float
    assert model.volume_.to_dict()["prior_weight"] == 0.25


def test_parameters_are_those_of_scikit_learn() -> None:
    model = CovAggClassifier(window=3, restarts=2)
    copy = clone(model).set_params(sampled=1)

    assert copy.get_params() == {
        "window": 3,
        "prior_weight": 0.1,
        "max_condition": 1e5,
        "restarts": 2,
        "sampled": 1,
        "shape": "full",
        "learner": "covagg",
        "probability": False,
        "random_state": None,
    }


def test_cross_validation_takes_bags_in_an_array() -> None:
    scores = cross_val_score(CovAggClassifier(random_state=0), BAGS, Y, cv=3)

    assert scores.mean() > 0.8


@pytest.mark.parametrize(
    ("bags", "y", "message"),
    [
        ([], [], "there are no bags"),
        ([[[0.0]], []], [0, 1], "bag 1 is empty"),
        ([[[0.0]], [[0.0, 1.0]]], [0, 1], "bag 1 has points of 2 components, but bag 0 of 1"),
        ([[[0.0]], [[np.nan]]], [0, 1], "Input X contains NaN or infinity: bag 1, row 0, component 0"),
        ([[[0.0]], [[np.inf]]], [0, 1], "Input X contains NaN or infinity"),
        ([[[0.0]], [[1e31]]], [0, 1], "values beyond 1e.30"),
        ([0.0, 1.0], [0, 1], "Expected 2D array, got 1D array"),
        (np.zeros((2, 1, 1, 1)), [0, 1], "bags must be a 2-D or 3-D array"),
        (np.zeros((2, 0, 1)), [0, 1], "every bag is empty"),
        (np.zeros((2, 0)), [0, 1], "0 feature"),
        (sparse.csr_array(np.eye(2)), [0, 1], "sparse"),
        ((np.zeros((2, 1)), [0]), [0, 1], "bag_ids must have one entry for each of the 2 points, got 1"),
        (np.zeros((2, 1)), [0], "got 1 labels for 2 bags: give one label for each"),
        (np.zeros((2, 1)), [0, 1, 1], "got 3 labels for 2 bags"),
        (np.zeros((2, 1)), None, "requires y to be passed, but the target y is None"),
        (np.zeros((2, 1)), [1, 1], "labels of 2 classes are needed, but 2 bags have only 1 class: 1"),
        (np.zeros((3, 1)), [0, 1, 2], "3 bags have 3 classes"),
        (np.zeros((2, 1)), [0.5, 1.7], "Unknown label type: continuous"),
        (np.zeros((2, 1)), [np.nan, 1.0], "labels contain NaN or infinite values"),
        (np.zeros((2, 1)), [[0, 1], [1, 0]], "y should be a 1d array"),
    ],
)
def test_bad_bags_and_labels_are_refused(bags: Any, y: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        CovAggClassifier().fit(bags, y)


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("window", 1, "window must be an integer of at least 2, got 1"),
        ("prior_weight", -1.0, "prior_weight must be a number above 0"),
        ("max_condition", 0.5, "max_condition must be a number above 1"),
        ("restarts", 0, "restarts must be an integer of at least 1, got 0"),
        ("sampled", 2.5, "sampled must be an integer of at least 1, got 2.5"),
        ("random_state", -1, "random_state must be an integer of at least 0"),
        ("random_state", "7", "random_state must be an integer of at least 0"),
    ],
)
def test_bad_parameters_are_refused_by_fit(option: str, value: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        CovAggClassifier(**{option: value}).fit(BAGS, Y)


@pytest.mark.parametrize("method", ["predict", "decision_function", "predict_instances", "witness"])
def test_prediction_needs_a_fitted_model_and_points_of_its_space(method: str) -> None:
    with pytest.raises(NotFittedError, match="not fitted yet"):
        getattr(CovAggClassifier(), method)(BAGS)
    with pytest.raises(InputError, match="X has 3 features, but CovAggClassifier is expecting 2 features"):
        getattr(fitted(), method)(np.zeros((4, 3)))
    with pytest.raises(InputError, match="contains NaN or infinity"):
        getattr(fitted(), method)([[[np.nan, 0.0]]])
    with pytest.raises(InputError, match=r"values beyond 1e.30"):
        getattr(fitted(), method)([[[4.0, 4.0], [1e200, 0.0]]])


@pytest.mark.parametrize("learner", ["covagg", "diverse-density"])
@pytest.mark.parametrize("shape", ["full", "diagonal", "axis"])
def test_other_volumes(shape: Any, learner: Any) -> None:
    model, again = (fitted(shape=shape, learner=learner) for _ in range(2))

    assert model.score(BAGS, Y) >= 0.9
    assert isinstance(model.volume_, Slab) == (shape == "axis")
    assert model.volume_.to_dict() == again.volume_.to_dict()
    inside = [bool(model.volume_.contains(bag).any()) for bag in BAGS]
    assert model.predict(BAGS).tolist() == inside


@pytest.mark.parametrize("option", ["shape", "learner"])
def test_unknown_volumes_are_refused(option: str) -> None:
    with pytest.raises(InputError, match=f"{option} must be one of"):
        fitted(**{option: "round"})


def test_a_search_without_result_is_a_fault_of_the_library(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("relforest.mil.covagg.aggregate", lambda *_args, **_options: None)
    with pytest.raises(AssertionError, match="no volume was found although both classes are present"):
        CovAggClassifier().fit(BAGS, Y)


def test_a_failed_fit_leaves_the_model_unfitted() -> None:
    model = CovAggClassifier()
    with pytest.raises(InputError, match="only 1 class"):
        model.fit(BAGS, np.zeros(N_BAGS, dtype=int))
    with pytest.raises(NotFittedError, match="not fitted yet"):
        model.predict(BAGS)
