"""`VolumeCommitteeClassifier`: what it learns, that it repeats itself, and odd or bad input."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from sklearn.base import clone
from sklearn.exceptions import NotFittedError

from interpreted import compiled_only
from relforest.metrics import peirce_skill_score
from relforest.mil import CovAggClassifier, VolumeCommitteeClassifier
from relforest.mil.volume_panels import PANELS, VOLUME_PANELS
from relforest.support.errors import InputError

pytestmark = compiled_only

Floats = NDArray[np.float64]
SMALL: dict[str, Any] = {"n_splits": 2, "n_volumes": 4, "n_balls": 60}


def two_sided(n_bags: int = 60, seed: int = 0, size: int = 6) -> tuple[Floats, NDArray[np.int64]]:
    """Bags (n, 6, 2) of standard normal points; the odd ones hold a point near (4, 0) or (-4, 0)."""
    rng = np.random.default_rng(seed)
    y = np.arange(n_bags) % 2
    bags = rng.standard_normal((n_bags, size, 2))
    sides = rng.choice([-4.0, 4.0], size=n_bags)
    for bag in np.flatnonzero(y):
        bags[bag, rng.integers(size)] = [sides[bag], 0.0] + 0.4 * rng.standard_normal(2)
    return bags, y


BAGS, Y = two_sided()
TEST, TEST_Y = two_sided(seed=1)


def fitted(bags: Any = BAGS, y: Any = Y, **options: Any) -> VolumeCommitteeClassifier:
    return VolumeCommitteeClassifier(random_state=0, **SMALL | options).fit(bags, y)


def test_it_learns_a_concept_of_two_parts() -> None:
    score = peirce_skill_score(TEST_Y, fitted().predict(TEST))
    single = CovAggClassifier(random_state=0).fit(BAGS, Y).predict(TEST)

    assert score >= 0.8
    assert score >= peirce_skill_score(TEST_Y, single) + 0.2


def test_the_rarer_class_counts_as_much() -> None:
    bags, y = two_sided(100)
    keep = np.flatnonzero((y == 0) | (np.arange(100) < 20))  # 50 negative, 10 positive bags
    predicted = fitted(bags[keep], y[keep]).predict(TEST)

    assert predicted[TEST_Y == 1].mean() >= 0.6
    assert predicted[TEST_Y == 0].mean() <= 0.3


@pytest.mark.parametrize("panel", PANELS)
def test_every_panel_alone_is_a_classifier(panel: str) -> None:
    model = fitted(panels=(panel,))

    # With so few volumes, "whole" has one, which finds one of the two parts.
    assert peirce_skill_score(TEST_Y, model.predict(TEST)) >= (0.4 if panel == "whole" else 0.6)
    assert list(model.panel_weights_) == [panel]
    assert {volume.panel for volume in model.volumes_} == {panel} & set(VOLUME_PANELS)
    assert model.balls_.near_weights.any() == (panel == "near balls")
    assert model.balls_.share_weights.any() == (panel == "ball shares")


def test_the_score_is_the_intercept_and_the_weighted_nearness_of_witnesses() -> None:
    model = fitted(n_volumes=2, n_balls=5)
    bag = TEST[0]
    total = model.intercept_
    for volume in model.volumes_:
        scaled = (bag[:, volume.view.columns] - volume.view.centre) / volume.view.scale
        rotation = np.eye(scaled.shape[1]) if volume.view.rotation is None else volume.view.rotation
        offsets = scaled @ rotation.T - volume.ellipsoid.mean
        squared = [offset @ np.linalg.solve(volume.ellipsoid.covariance, offset) for offset in offsets]
        total += volume.weight * 2.0 ** -(min(squared) / volume.ellipsoid.radius**2)
    balls = model.balls_
    scaled = (bag - balls.view.centre) / balls.view.scale
    for centre, near, share in zip(balls.centres, balls.near_weights, balls.share_weights, strict=True):
        squared_distances = ((scaled - centre) ** 2).sum(axis=1)
        total += near * 2.0 ** -(squared_distances.min() / balls.near_radius**2)
        total += share * (2.0 ** -(squared_distances / balls.share_radius**2)).mean()

    assert model.decision_function([bag]) == pytest.approx(total, rel=1e-9, abs=1e-12)


def test_volumes_come_weightiest_first_and_in_the_units_of_the_data() -> None:
    model = fitted(1000.0 + 10.0 * BAGS)
    weights = [abs(volume.weight) for volume in model.volumes_]

    assert weights == sorted(weights, reverse=True)
    assert all(abs(volume.centre[1] - 1000) < 60 for volume in model.volumes_)
    # 2 splits of 4 + 2 volumes, by turns of positive and of negative bags, and of 1 of positive bags.
    assert len(model.volumes_) == 14
    assert sum(volume.seeks_positive for volume in model.volumes_) == 8


def test_an_instance_has_the_influence_that_its_bag_would_lose() -> None:
    model = fitted()
    bag = TEST[1]
    score = model.decision_function([bag])[0]
    lost = [score - model.decision_function([np.delete(bag, row, axis=0)])[0] for row in range(len(bag))]

    np.testing.assert_allclose(model.influences([bag, TEST[0]])[0], lost, atol=1e-9)
    alone = model.influences([bag[:1]])[0]
    np.testing.assert_allclose(alone, model.decision_function([bag[:1]]) - model.intercept_, atol=1e-9)


def test_influences_come_in_the_order_of_the_rows_of_each_bag() -> None:
    model = fitted()
    points, ids = TEST[:2].reshape(-1, 2), np.repeat([0, 1], 6)
    order = np.random.default_rng(0).permutation(12)
    order = np.concatenate([[0], order[order != 0]])  # the first bag stays the first
    shuffled = model.influences((points[order], ids[order]))
    grouped = model.influences(TEST[:2])

    for bag in (0, 1):
        rows = order[ids[order] == bag] - 6 * bag
        np.testing.assert_allclose(shuffled[bag], grouped[bag][rows], atol=1e-9)


def test_two_equal_instances_have_no_influence_through_what_they_share() -> None:
    model = fitted(panels=("parts",))

    np.testing.assert_allclose(model.influences([[[3.0, 1.0], [3.0, 1.0]]])[0], [0, 0])


def test_the_same_seed_gives_the_same_scores_however_many_jobs() -> None:
    expected = fitted().decision_function(TEST)

    assert (fitted().decision_function(TEST) == expected).all()
    assert (fitted(n_jobs=2).decision_function(TEST) == expected).all()
    other = VolumeCommitteeClassifier(random_state=1, **SMALL).fit(BAGS, Y)
    assert (other.decision_function(TEST) != expected).any()


def test_prediction_does_not_depend_on_the_order_of_bags_or_instances() -> None:
    model = fitted()
    rng = np.random.default_rng(0)
    order = rng.permutation(len(TEST))
    shuffled = [rng.permutation(bag) for bag in TEST[order]]

    np.testing.assert_allclose(
        model.decision_function(shuffled), model.decision_function(TEST)[order], atol=1e-9
    )


def test_units_of_the_features_do_not_matter() -> None:
    units, origin = np.array([1e-4, 1e4]), np.array([5.0, -3e4])
    expected = fitted().decision_function(TEST)
    found = fitted(origin + units * BAGS).decision_function(origin + units * TEST)

    np.testing.assert_allclose(found, expected, atol=1e-6)


def test_constant_features_are_ignored() -> None:
    padded = np.concatenate([np.full((60, 6, 1), 7.0), BAGS, np.zeros((60, 6, 2))], axis=2)
    model = fitted(padded)

    assert model.n_features_in_ == 5
    assert model.balls_.view.columns.tolist() == [1, 2]
    assert (model.predict(padded) == fitted().predict(BAGS)).all()


def test_points_without_any_difference_get_one_label() -> None:
    model = fitted(np.full((8, 3, 2), 0.1), np.arange(8) % 2)

    assert len(set(model.predict(np.full((4, 2, 2), 0.1)).tolist())) == 1


def test_ten_thousand_features() -> None:
    rng = np.random.default_rng(0)
    bags = rng.standard_normal((12, 2, 10_000))
    bags[1::2, 0, :200] += 3.0
    y = np.arange(12) % 2
    model = fitted(bags, y)

    assert (model.predict(bags) == y).all()
    assert max(volume.view.dim for volume in model.volumes_) <= 20


def test_one_instance_per_bag() -> None:
    rng = np.random.default_rng(0)
    y = np.arange(40) % 2
    points = rng.standard_normal((40, 2)) + 3.0 * y[:, None]
    model = fitted(points, y)

    assert (model.predict(points) == y).mean() > 0.9
    np.testing.assert_allclose(model.decision_function(points), model.decision_function(points[:, None]))


@pytest.mark.parametrize("y", [[0, 1], [0, 0, 1], [0, 1, 1, 1]])
def test_too_few_bags_to_leave_some_out(y: list[int]) -> None:
    bags = [[[float(label), float(number)], [0.0, 0.5]] for number, label in enumerate(y)]
    model = fitted(bags, y)

    assert np.isfinite(model.decision_function(bags)).all()
    # Nothing was compared: all five panels count 1 / 5.
    assert list(model.panel_weights_.values()) == pytest.approx([0.2] * 5)


def test_balls_may_all_lie_in_bags_left_out() -> None:
    model = fitted(n_balls=1)

    assert len(model.balls_.centres) <= 1
    assert np.isfinite(model.decision_function(TEST)).all()


def test_values_far_beyond_those_of_training() -> None:
    model = fitted()

    np.testing.assert_allclose(
        model.decision_function([np.vstack([TEST[1], [[1e30, -1e30]]]), TEST[1]])[1],
        model.decision_function(TEST[1:2])[0],
    )
    with pytest.raises(InputError, match=r"values beyond 1e.30: use other units \(bag 0, row 1, component 0"):
        model.predict([[[6.0, 6.0], [1e200, 1e200]]])


def test_duplicate_instances_and_bags_of_many_sizes() -> None:
    bags = [np.repeat(bag[: 1 + number % 6], 2, axis=0) for number, bag in enumerate(BAGS)]
    model = fitted(bags)

    assert np.isfinite(model.decision_function(bags)).all()
    assert [len(values) for values in model.influences(bags)] == [len(bag) for bag in bags]


def test_a_bag_with_more_points_than_a_block() -> None:
    model = fitted()
    large = np.tile(TEST[1], (500, 1))

    np.testing.assert_allclose(
        model.decision_function([TEST[0], large, TEST[2]]), model.decision_function(TEST[:3]), atol=1e-9
    )


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("n_splits", 0, "n_splits must be an integer of at least 1, got 0"),
        ("n_volumes", 0, "n_volumes must be an integer of at least 1, got 0"),
        ("part_size", 1.5, "part_size must be an integer of at least 1, got 1.5"),
        ("n_components", 0, "n_components must be an integer of at least 1, got 0"),
        ("n_balls", 0, "n_balls must be an integer of at least 1, got 0"),
        ("panels", (), "panels must name at least one panel"),
        ("panels", ("parts", "parts"), "none twice"),
        ("panels", "wings", "each of panels must be one of 'parts', 'components'"),
        ("n_jobs", 0, "n_jobs must be a positive integer"),
        ("random_state", -1, "random_state must be an integer of at least 0"),
    ],
)
def test_bad_parameters_are_refused_by_fit(option: str, value: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        VolumeCommitteeClassifier(**{option: value}).fit(BAGS, Y)


@pytest.mark.parametrize(
    ("bags", "y", "message"),
    [
        (BAGS, np.zeros(60), "only 1 class"),
        ([[[0.0]], [[np.nan]]], [0, 1], "NaN or infinity"),
        ([[[0.0]], [[1e31]]], [0, 1], "values beyond 1e.30"),
        ([[[0.0]], []], [0, 1], "bag 1 is empty"),
    ],
)
def test_bad_bags_and_labels_are_refused(bags: Any, y: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        VolumeCommitteeClassifier().fit(bags, y)


def test_it_must_be_fitted_first() -> None:
    with pytest.raises(NotFittedError):
        VolumeCommitteeClassifier().influences(BAGS)


def test_parameters_are_those_of_scikit_learn() -> None:
    model = clone(VolumeCommitteeClassifier(n_splits=3, panels=["parts"]))

    assert model.get_params()["n_splits"] == 3
    assert model.get_params()["panels"] == ["parts"]
