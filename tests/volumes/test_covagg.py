"""Covariant aggregation by hand, in its invariances, and on degenerate and bad input."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.special import xlogy

from relforest.support.errors import InputError
from relforest.volumes import Aggregation, Arc, CovAggSettings, Ellipsoid, Objective, aggregate
from relforest.volumes.covagg import prior_of
from strategies import BagSet, bag_sets

Floats = NDArray[np.float64]

OBJECTIVES: tuple[Objective, ...] = ("accuracy", "log-likelihood")
seeds = st.integers(0, 2**20)


def single(points: Any, labels: list[int]) -> BagSet:
    """Bags of one point each; numbers stand for points of a line."""
    array = np.asarray(points, dtype=np.float64).reshape(len(labels), -1)
    return BagSet(array, np.arange(len(labels) + 1), np.array(labels, dtype=np.bool_))


def learn(
    bags: BagSet, *, seed: int = 0, objective: Objective = "accuracy", **options: float
) -> Aggregation | None:
    settings = CovAggSettings(**options)  # type: ignore[arg-type]
    rng = np.random.default_rng(seed)
    return aggregate(*bags, objective=objective, settings=settings, rng=rng)


def learned(
    bags: BagSet, *, seed: int = 0, objective: Objective = "accuracy", **options: float
) -> Aggregation:
    found = learn(bags, seed=seed, objective=objective, **options)
    assert found is not None
    return found


def ellipsoid_of(found: Aggregation) -> Ellipsoid:
    assert isinstance(found.volume, Ellipsoid)
    return found.volume


def witnesses(found: Aggregation, bags: BagSet) -> Floats:
    """Distance of every bag's nearest point, as a user would compute it."""
    distances: Floats = np.minimum.reduceat(found.volume.distance(bags.points), bags.starts[:-1])
    return distances


def rescored(found: Aggregation, bags: BagSet, objective: Objective) -> float:
    """The objective of the volume, from the labels and who is inside."""
    inside = witnesses(found, bags) <= found.volume.radius
    if objective == "accuracy":
        return float((inside == bags.labels).sum())
    total = 0.0
    for leaf in (inside, ~inside):
        positive, negative = int(bags.labels[leaf].sum()), int((~bags.labels[leaf]).sum())
        total += float(xlogy(positive, positive) + xlogy(negative, negative))
        total -= float(xlogy(positive + negative, positive + negative))
    return total


def random_bags(rng: np.random.Generator, dim: int, *, rank: int | None = None, n_bags: int = 14) -> BagSet:
    """Bags of 1 to 4 points of an oblique cloud, of lower dimension if `rank` is given."""
    sizes = rng.integers(1, 5, size=n_bags)
    starts = np.concatenate([[0], np.cumsum(sizes)])
    labels = rng.random(n_bags) < 0.5
    labels[:2] = [True, False]
    spread = rng.standard_normal((rank or dim, dim))
    points = rng.standard_normal((starts[-1], len(spread))) @ spread + 5 * rng.standard_normal(dim)
    return BagSet(points, starts, labels)


def test_two_positives_on_a_line_by_hand() -> None:
    # One key: V = .1 * var(0, 1) = .025, all four bags are right. Adding the other key keeps the score
    # with one key more: mean .5, V = (.5^2 + .5^2) + .025 = .525; witnesses .5 and 2.5 away: midway is 1.5.
    found = learned(single([0, 1, 3, 4], [1, 1, 0, 0]), restarts=1)
    volume = ellipsoid_of(found)

    assert found.score == 4
    assert volume.n_keys == 2
    assert volume.mean.tolist() == [0.5]
    assert volume.covariance.tolist() == [[pytest.approx(0.525)]]
    assert volume.radius == pytest.approx(1.5 / math.sqrt(0.525))
    # The start point, and the one bag that was left.
    assert found.n_models == 2


def test_a_single_positive_bag_by_hand() -> None:
    # Points 0 and 6: V = .1 * 9 = .9. Around 0 the negatives at 2 and 5 are 2 and 5 away; around 6 4 and 1.
    # Both are right about all 3 bags; the first is kept. Midway between 0 and 2 is 1.
    bags = BagSet(np.array([[0.0], [6], [2], [5]]), np.array([0, 2, 3, 4]), np.array([True, False, False]))
    found = learned(bags)
    volume = ellipsoid_of(found)

    assert (found.score, volume.n_keys, volume.mean.tolist()) == (3, 1, [0])
    assert volume.covariance.tolist() == [[pytest.approx(0.9)]]
    assert volume.radius == pytest.approx(1 / math.sqrt(0.9))
    assert found.n_models == 2


def test_the_better_start_point_is_taken() -> None:
    # The negative lies on 0 itself and cannot be separated from it: 1 right around 0, 2 around 6.
    bags = BagSet(np.array([[0.0], [6], [0]]), np.array([0, 2, 3]), np.array([True, False]))
    found = learned(bags)

    assert (found.score, ellipsoid_of(found).mean.tolist()) == (2, [6])
    # Nothing but 6 itself inside: midway to 0.
    assert found.volume.radius * math.sqrt(0.9) == pytest.approx(3)


def test_the_likelihood_of_an_outlier_by_hand() -> None:
    # 0 and 1 inside, 3, 4 and the positive 10 outside: ln(1/3) + 2 ln(2/3).
    found = learned(single([0, 1, 3, 4, 10], [1, 1, 0, 0, 1]), objective="log-likelihood")

    assert found.score == pytest.approx(math.log(1 / 3) + 2 * math.log(2 / 3))
    assert found.volume.contains([[0], [1], [3], [4], [10]]).tolist() == [True, True, False, False, False]


def test_a_perfect_likelihood_is_zero() -> None:
    assert learned(single([0, 1, 3, 4], [1, 1, 0, 0]), objective="log-likelihood").score == 0


def test_posterior_and_conditioning_by_hand() -> None:
    # Positives (0, 0) and (2, 0): P = diag(1, 0), ncov(K) = diag(2, 0), V = diag(2.1, 0). With c = 22 eq. 3.6
    # adds 2.1 / 21 = .1: diag(2.2, .1), whose condition number is 22.
    found = learned(single([(0, 0), (2, 0), (9, 0)], [1, 1, 0]), max_condition=22.0)
    volume = ellipsoid_of(found)

    assert volume.n_keys == 2
    assert volume.mean.tolist() == [1, 0]
    np.testing.assert_allclose(volume.covariance, np.diag([2.2, 0.1]))
    # Witnesses 1 and 8 away along the first axis: midway is 4.5.
    assert volume.radius == pytest.approx(4.5 / math.sqrt(2.2))


def test_the_prior_weighs_the_biased_covariance_of_all_positive_points() -> None:
    # One positive bag: ncov(K) = 0, so V is w times the covariance, divided by p = 4.
    points = np.array([[0.0, 0], [2, 0], [0, 4], [2, 4], [9, 9]])
    bags = BagSet(points, np.array([0, 4, 5]), np.array([True, False]))

    np.testing.assert_allclose(ellipsoid_of(learned(bags, prior_weight=0.5)).covariance, np.diag([0.5, 2.0]))


def test_without_a_negative_bag_everything_is_inside() -> None:
    bags = single([0, 1, 5], [1, 1, 1])
    found = learned(bags)

    assert found.score == 3
    assert found.volume.contains(bags.points).all()
    assert learn(bags, objective="log-likelihood") is None


def test_without_a_positive_bag_there_is_no_volume() -> None:
    for objective in OBJECTIVES:
        assert learn(single([0, 1], [0, 0]), objective=objective) is None


def test_labels_that_no_volume_separates() -> None:
    # Each point occurs in one bag of either class: Yes would never be more probable than No.
    bags = single([0, 0, 1, 1], [1, 0, 1, 0])

    assert learn(bags, objective="log-likelihood") is None
    assert learned(bags).score == 2


def test_all_points_equal() -> None:
    # The covariance falls back to the identity, and everything is inside a ball of radius 0.
    bags = single([(3, 3)] * 4, [1, 1, 1, 0])
    found = learned(bags)
    volume = ellipsoid_of(found)

    assert found.score == 3
    assert volume.radius == 0
    np.testing.assert_array_equal(volume.covariance, np.eye(2))
    assert volume.contains(bags.points).all()
    assert learn(bags, objective="log-likelihood") is None


@pytest.mark.parametrize("dim", [1, 2, 3, 5])
def test_equal_positives_still_have_a_volume(dim: int) -> None:
    points = np.zeros((4, dim))
    points[2:, 0] = [4.0, 6.0]
    found = learned(single(points, [1, 1, 0, 0]))

    # Identity: plain distances 0 and 4, halfway 2.
    assert found.score == 4
    assert found.volume.radius == pytest.approx(2)


def test_a_constant_dimension_is_held_tightly() -> None:
    bags = single([(0, 7), (1, 7), (2, 7), (1, 8)], [1, 1, 1, 0])
    volume = ellipsoid_of(learned(bags))

    assert np.linalg.cond(volume.covariance) == pytest.approx(1e5, rel=1e-6)
    assert volume.contains([[1, 7], [1, 8]]).tolist() == [True, False]


def test_duplicated_bags_change_neither_shape_nor_decision() -> None:
    bags = single([0, 1, 3, 4] * 2, [1, 1, 0, 0] * 2)
    found = learned(bags)

    assert found.score == 8
    assert found.volume.contains(bags.points).tolist() == bags.labels.tolist()


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize(("dim", "rank"), [(1, 1), (2, 1), (2, 2), (3, 1), (3, 2), (3, 3), (4, 2), (5, 5)])
def test_the_score_is_what_the_volume_achieves(dim: int, rank: int, objective: Objective) -> None:
    # Also for points on a line or in a plane, where the covariance is as flat as conditioning allows.
    n_found = 0
    for seed in range(12):
        rng = np.random.default_rng([dim, rank, seed])
        bags = random_bags(rng, dim, rank=rank)
        found = learn(bags, seed=seed, objective=objective)
        if found is None:
            continue
        n_found += 1
        assert found.score == pytest.approx(rescored(found, bags, objective), abs=1e-9)
        # No witness lies on the boundary: it is midway between two, or beyond the last.
        assert (np.abs(witnesses(found, bags) - found.volume.radius) > 1e-12).all()
    assert n_found >= 6


@given(bag_sets(max_bags=8), seeds)
def test_accuracy_is_never_worse_than_a_constant_answer(bags: BagSet, seed: int) -> None:
    # One positive bag alone inside is always possible for some centre; all inside is the other extreme.
    found = learned(bags, seed=seed)

    assert found.score >= bags.labels.sum()
    assert found.score <= len(bags.labels)


@given(seeds, st.integers(1, 4))
def test_affine_maps_move_the_volume_along(seed: int, dim: int) -> None:
    # Mahalanobis distances do not change as long as conditioning stays out of it.
    rng = np.random.default_rng(seed)
    bags = random_bags(rng, dim)
    turn = np.linalg.qr(rng.standard_normal((dim, dim)))[0]
    linear = turn @ np.diag(rng.uniform(0.3, 3, size=dim)) @ np.linalg.qr(rng.standard_normal((dim, dim)))[0]
    offset = rng.uniform(-5, 5, size=dim)
    there = bags._replace(points=bags.points @ linear.T + offset)
    here = learned(bags, seed=seed, max_condition=1e7)
    moved = learned(there, seed=seed, max_condition=1e7)
    volume, other = ellipsoid_of(here), ellipsoid_of(moved)
    assume(max(np.linalg.cond(volume.covariance), np.linalg.cond(other.covariance)) < 1e6)

    assert moved.score == here.score
    assert moved.n_models == here.n_models
    assert other.n_keys == volume.n_keys
    assert other.radius == pytest.approx(volume.radius, rel=1e-6)
    np.testing.assert_allclose(other.mean, linear @ volume.mean + offset, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(other.covariance, linear @ volume.covariance @ linear.T, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(witnesses(moved, there), witnesses(here, bags), rtol=1e-6)


@given(seeds, st.integers(2, 4))
def test_rotations_move_the_volume_along_even_when_conditioned(seed: int, dim: int) -> None:
    rng = np.random.default_rng(seed)
    bags = random_bags(rng, dim)
    turn = np.linalg.qr(rng.standard_normal((dim, dim)))[0]
    there = bags._replace(points=bags.points @ turn.T)
    here, moved = learned(bags, seed=seed, max_condition=3.0), learned(there, seed=seed, max_condition=3.0)

    assert moved.score == here.score
    assert moved.volume.radius == pytest.approx(here.volume.radius, rel=1e-6)
    expected = turn @ ellipsoid_of(here).covariance @ turn.T
    np.testing.assert_allclose(ellipsoid_of(moved).covariance, expected, rtol=1e-6, atol=1e-6)


@given(bag_sets(max_bags=8), seeds, st.sampled_from([2.0**-20, 0.5, 8.0, 2.0**20]))
def test_units_do_not_matter(bags: BagSet, seed: int, unit: float) -> None:
    # A power of two rounds nothing, so that even ties stay ties.
    assume(np.var(bags.points) > 1e-6 or np.ptp(bags.points) == 0)
    scaled = bags._replace(points=bags.points * unit)
    here, there = learned(bags, seed=seed), learned(scaled, seed=seed)
    assume(not np.array_equal(ellipsoid_of(here).covariance, np.eye(bags.points.shape[1])))

    assert there.score == here.score
    assert there.volume.radius == pytest.approx(here.volume.radius, rel=1e-12)
    np.testing.assert_allclose(ellipsoid_of(there).mean, ellipsoid_of(here).mean * unit, rtol=1e-12, atol=0)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_the_same_generator_gives_the_same_volume(objective: Objective) -> None:
    bags = random_bags(np.random.default_rng(1), 2, n_bags=30)
    first, again = (learned(bags, seed=7, objective=objective) for _ in range(2))

    assert first.score == again.score
    assert first.volume.to_dict() == again.volume.to_dict()


def test_the_input_is_left_alone() -> None:
    bags = random_bags(np.random.default_rng(1), 2)
    copies = [part.copy() for part in bags]
    learned(bags)

    for part, copy in zip(bags, copies, strict=True):
        np.testing.assert_array_equal(part, copy)


def test_the_order_of_instances_in_a_bag_does_not_matter() -> None:
    rng = np.random.default_rng(3)
    for seed in range(5):
        bags = random_bags(rng, 2)
        order = np.concatenate(
            [rng.permutation(np.arange(*bags.starts[i : i + 2])) for i in range(len(bags.labels))]
        )
        here, shuffled = (
            learned(bags, seed=seed),
            learned(bags._replace(points=bags.points[order]), seed=seed),
        )
        assert shuffled.score == here.score


def test_a_shifted_clock_learns_a_shifted_arc() -> None:
    # Keys 0 and 1 hours of a clock of 2 pi; the mean direction is halfway, the negatives stand opposite.
    angles = np.array([[0.0], [1.0], [3.0], [-2.0]])
    labels, starts = np.array([True, True, False, False]), np.arange(5)
    for shift in (0.0, 1.0, 2.5, -3.0):
        turned = np.angle(np.exp(1j * (angles + shift)))
        found = aggregate(turned, starts, labels, space="circle", rng=np.random.default_rng(0))
        assert found is not None
        assert isinstance(found.volume, Arc)
        assert found.score == 4
        assert np.cos(found.volume.mean - (0.5 + shift)) == pytest.approx(1)
        # Witnesses .5 and 2.5 away.
        assert found.volume.radius == pytest.approx(1.5)


def test_concentration_by_hand() -> None:
    # Two keys at -h and h: R_K = cos h; the points are the same: R = cos h, kappa = R (2 - R^2) / (1 - R^2).
    h = 0.4
    angles, labels = np.array([[-h], [h], [3.0]]), np.array([True, True, False])
    found = aggregate(angles, np.arange(4), labels, space="circle", rng=np.random.default_rng(0))
    length = math.cos(h)

    assert found is not None
    assert isinstance(found.volume, Arc)
    assert found.volume.kappa == pytest.approx(length * (2 - length**2) / (1 - length**2))


def test_equal_angles_have_a_large_but_finite_concentration() -> None:
    angles, labels = np.array([[0.5], [0.5], [3.0]]), np.array([True, True, False])
    found = aggregate(angles, np.arange(4), labels, space="circle", rng=np.random.default_rng(0))

    assert found is not None
    assert isinstance(found.volume, Arc)
    # R = 1 - 1e-9: about 1 / (2e-9).
    assert found.volume.kappa == pytest.approx(5e8, rel=1e-6)


def test_opposite_keys_have_no_mean_direction() -> None:
    # All is inside around one key; the other one may be tried, but half a turn away it gives no centre.
    angles, labels = np.array([[0.0], [math.pi]]), np.array([True, True])
    found = aggregate(angles, np.arange(3), labels, space="circle", rng=np.random.default_rng(0))

    assert found is not None
    assert found.score == 2
    # Two start points, and the other key for each of them.
    assert found.n_models == 4
    assert found.volume.mean in {0.0, math.pi}
    assert found.volume.contains(angles).all()


def test_more_restarts_and_samples_than_bags_cost_nothing() -> None:
    bags = single([0, 1, 3, 4], [1, 1, 0, 0])
    few = learned(bags, restarts=2, sampled=2)
    many = learned(bags, restarts=10**15, sampled=10**15, window=10**15)

    assert many.volume.to_dict() == few.volume.to_dict()


EXTREME_OPTIONS: list[dict[str, Any]] = [
    {},
    {"max_condition": 1e7, "prior_weight": 1e6},
    {"prior_weight": 1e-300},
]


# Values whose squares would vanish or whose products would overflow without the limits; these crashed once.
@pytest.mark.parametrize("dim", [1, 2, 3, 4])
@pytest.mark.parametrize(
    ("positive", "negative"),
    [
        (1e-160, 1.0),
        (1e-45, 1e-45),
        (4e-45, 1.0),
        (1e-40, 1.0),
        (1e30, 1e30),
        (1.0, 1e30),
        (1e-50, 1e30),
        (0.0, 1e-300),
    ],
)
def test_extreme_values_are_harmless(dim: int, positive: float, negative: float) -> None:
    points = np.zeros((5, dim))
    points[1:3, 0] = positive, -positive
    points[1:3, -1] = positive, positive / 2
    points[3:, 0] = negative, -negative
    bags = single(points, [1, 1, 1, 0, 0])
    for objective in OBJECTIVES:
        for options in EXTREME_OPTIONS:
            found = learn(bags, objective=objective, **options)
            if found is not None:
                assert math.isfinite(found.volume.radius)
                assert np.isfinite(ellipsoid_of(found).covariance).all()


@pytest.mark.parametrize("max_condition", [1.0000001, 1e5, 1e7])
@pytest.mark.parametrize("dim", [2, 3, 4])
def test_grey_colors_lie_on_a_line(dim: int, max_condition: float) -> None:
    # All but one eigenvalue vanish; at larger limits the closed forms used to break down.
    for seed in range(5):
        rng = np.random.default_rng(seed)
        grey = rng.uniform(size=(40, 1)) * np.linspace(1, 0.3, dim)
        bags = BagSet(grey, np.arange(41), rng.random(40) < 0.5)
        found = learned(bags, seed=seed, max_condition=max_condition)
        assert found.score == rescored(found, bags, "accuracy")
        assert np.linalg.cond(ellipsoid_of(found).covariance) <= max_condition * (1 + 1e-3)


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("window", 1, "window must be an integer of at least 2, got 1"),
        ("window", 2.0, "window must be an integer"),
        ("restarts", 0, "restarts must be an integer of at least 1, got 0"),
        ("sampled", -4, "sampled must be an integer of at least 1, got -4"),
        ("prior_weight", 0.0, "prior_weight must be a number above 0 and of at most 1e.06, got 0.0"),
        ("prior_weight", 2e6, "prior_weight must be a number above 0 and of at most 1e.06"),
        ("prior_weight", math.nan, "prior_weight must be"),
        ("max_condition", 1.0, "max_condition must be a number above 1 and of at most 1e.07, got 1.0"),
        ("max_condition", math.inf, "max_condition must be a number above 1 and of at most 1e.07, got inf"),
    ],
)
def test_options_out_of_range_are_refused(option: str, value: float, message: str) -> None:
    with pytest.raises(InputError, match=message):
        CovAggSettings(**{option: value})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("points", "starts", "labels", "message"),
    [
        (np.zeros(3), [0, 3], [True], r"points \(3,\), starts \(2,\) and labels \(1,\) do not match"),
        (np.zeros((3, 0)), [0, 3], [True], "do not match"),
        (np.zeros((3, 1)), [0, 3], [True, False], "do not match"),
        (np.zeros((0, 1)), [0], [], "do not match"),
        (np.zeros((3, 1)), [0, 2], [True], "starts must rise from 0 to the number of points"),
        (np.zeros((3, 1)), [1, 3], [True], "starts must rise from 0"),
        (np.zeros((3, 1)), [0, 3, 3], [True, False], "no empty bag: drop empty bags first"),
        (np.zeros((3, 1)), [0, 4, 3], [True, False], "starts must rise"),
        (np.array([[0.0], [np.nan]]), [0, 1, 2], [True, False], "points contain NaN, infinite values"),
        (np.array([[0.0], [np.inf]]), [0, 1, 2], [True, False], "points contain NaN, infinite values"),
        (np.array([[0.0], [-2e30]]), [0, 1, 2], [True, False], r"beyond 1e\+30: drop .*use other units"),
    ],
)
def test_bad_bags_are_refused(points: Floats, starts: list[int], labels: list[bool], message: str) -> None:
    with pytest.raises(InputError, match=message):
        aggregate(points, np.array(starts), np.array(labels, dtype=np.bool_), rng=np.random.default_rng(0))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"space": "sphere"}, "space must be one of 'euclidean', 'circle', 'category', got 'sphere'"),
        (
            {"objective": "auc"},
            "objective must be one of 'accuracy', 'log-likelihood', 'weighted-log-likelihood', 'squared-err",
        ),
        ({"objective": "squared-error"}, "objective 'squared-error' needs evidence"),
        ({"evidence": np.ones((1, 2))}, "objective 'accuracy' takes no evidence"),
        (
            {"objective": "squared-error", "evidence": np.ones((3, 1))},
            "evidence must be two finite numbers for each of",
        ),
        ({"space": "circle"}, "points on the circle are angles, one column, got 2 columns"),
    ],
)
def test_unknown_spaces_and_objectives_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        aggregate(*single([(0, 0), (1, 1)], [1, 0]), rng=np.random.default_rng(0), **options)


@given(bag_sets())
def test_the_prior_is_the_covariance_of_all_positive_points(bags: BagSet) -> None:
    chosen = bags.points[np.repeat(bags.labels, np.diff(bags.starts))]
    expected = 0.1 * np.atleast_2d(np.cov(chosen, rowvar=False, bias=True))
    found = prior_of(*bags, 0.1)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12 * (1.0 + np.abs(chosen).max() ** 2))
    np.testing.assert_array_equal(found, found.T)
