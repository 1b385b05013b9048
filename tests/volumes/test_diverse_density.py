"""The volume learner of 2012 by hand, and against a plain version of it."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import xlogy

from reference.covagg import conditioned
from relforest.volumes import Aggregation, Arc, CovAggSettings, Ellipsoid, Objective, aggregate
from relforest.volumes.diverse_density import log_diverse_density, most_apart
from strategies import BagSet

Floats = NDArray[np.float64]


def learn(
    bags: BagSet,
    seed: int = 0,
    *,
    space: Literal["euclidean", "circle", "category"] = "euclidean",
    objective: Objective = "log-likelihood",
    evidence: Floats | None = None,
    settings: CovAggSettings | None = None,
) -> Aggregation | None:
    return aggregate(
        *bags,
        rng=np.random.default_rng(seed),
        space=space,
        objective=objective,
        evidence=evidence,
        settings=settings or CovAggSettings(learner="diverse-density"),
    )


def random_bags(rng: np.random.Generator, dim: int, n_bags: int = 16) -> BagSet:
    """Bags of 1 to 4 points; most positive ones hold a point near one place."""
    starts = np.concatenate([[0], np.cumsum(rng.integers(1, 5, size=n_bags))])
    labels = np.arange(n_bags) % 2 == 0
    points = rng.standard_normal((starts[-1], dim))
    place = rng.standard_normal(dim)
    for bag in np.flatnonzero(labels & (rng.random(n_bags) < 0.8)):
        points[starts[bag]] = place + 0.3 * rng.standard_normal(dim)
    return BagSet(points, starts, labels)


def plain(
    bags: BagSet, seed: int, sides: Floats, settings: CovAggSettings, *, circular: bool = False
) -> tuple[Floats, Floats, float] | None:
    """Mean, covariance (of the angles: nothing) and radius; `sides` (2, n_bags) as for `most_apart`."""
    points, starts, labels = bags
    positives = np.flatnonzero(labels).tolist()
    positive_points = points[np.repeat(labels, np.diff(starts))]
    prior = settings.prior_weight * np.atleast_2d(np.cov(positive_points.T, bias=True))
    scale = settings.prior_weight
    if circular:
        scale = 0.5 / (1 - abs(np.exp(1j * positive_points).mean()))

    def shape(scatter: Floats) -> Floats:
        total = scatter + prior
        return conditioned(
            np.diag(np.diag(total)) if settings.shape == "diagonal" else total, settings.max_condition
        )

    def squared(mean: Floats, covariance: Floats) -> Floats:
        if circular:
            turned: Floats = np.angle(np.exp(1j * (points[:, 0] - mean[0])))
            return turned**2
        offsets = points - mean
        distances: Floats = np.einsum("ij,ij->i", offsets @ np.linalg.inv(covariance), offsets)
        return distances

    rng = np.random.default_rng(seed)
    pool, centres = list(positives), []
    for i in range(min(settings.restarts, len(pool))):
        swap = i + int(rng.random() * (len(pool) - i))
        pool[i], pool[swap] = pool[swap], pool[i]
        centres += points[starts[pool[i]] : starts[pool[i] + 1]].tolist()
    start = shape(np.zeros_like(prior))
    diversity = []
    for centre in centres:
        nearest = np.minimum.reduceat(scale * squared(np.array(centre), start), starts[:-1])
        closeness = np.exp(-nearest / 2)
        terms = xlogy(sides[1], closeness) + xlogy(sides[0], 1 - closeness)
        diversity.append(float(terms.sum()))
    best: tuple[Floats, Floats, float] | None = None
    furthest = -math.inf
    for number in np.argsort(-np.array(diversity), kind="stable")[: settings.sampled]:
        mean, covariance, before = np.array(centres[number]), start, [-1]
        while True:
            distances = squared(mean, covariance)
            keys = [starts[b] + int(np.argmin(distances[starts[b] : starts[b + 1]])) for b in positives]
            if keys == before:
                break
            before, own = keys, points[keys]
            mean = np.array([np.angle(np.exp(1j * own).sum())]) if circular else own.mean(axis=0)
            covariance = shape((own - mean).T @ (own - mean))
        witness = np.sqrt(np.minimum.reduceat(distances, starts[:-1]))
        shares = sides / sides.sum(axis=1, keepdims=True)
        for edge in np.sort(witness):
            inside = shares[:, witness <= edge].sum(axis=1)
            if inside[1] - inside[0] > furthest + 1e-12:
                beyond = witness[witness > edge]
                radius = (edge + beyond.min()) / 2 if len(beyond) else edge
                furthest, best = inside[1] - inside[0], (mean, covariance, float(radius))
    return best


def check(found: Aggregation | None, expected: tuple[Floats, Floats, float] | None) -> None:
    assert found is not None
    assert expected is not None
    mean, covariance, radius = expected
    volume = found.volume
    assert volume.radius == pytest.approx(radius, rel=1e-6)
    if isinstance(volume, Arc):
        assert math.cos(volume.mean - mean[0]) == pytest.approx(1)
        return
    assert isinstance(volume, Ellipsoid)
    np.testing.assert_allclose(volume.mean, mean, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(volume.covariance, covariance, rtol=1e-6, atol=1e-9)


def sides_of(labels: NDArray[np.bool_]) -> Floats:
    return np.stack([~labels, labels]).astype(np.float64)


@pytest.mark.parametrize("shape", ["full", "diagonal"])
@pytest.mark.parametrize("dim", [1, 2, 3, 5, 12])
def test_random_bags(dim: int, shape: Literal["full", "diagonal"]) -> None:
    settings = CovAggSettings(restarts=3, sampled=2, shape=shape, learner="diverse-density")
    for seed in range(4):
        bags = random_bags(np.random.default_rng([dim, seed]), dim)
        expected = plain(bags, seed, sides_of(bags.labels), settings)
        check(learn(bags, seed, settings=settings), expected)


def test_random_angles() -> None:
    settings = CovAggSettings(learner="diverse-density")
    for seed in range(6):
        points, starts, labels = random_bags(np.random.default_rng([7, seed]), 1)
        bags = BagSet(np.angle(np.exp(1j * (points + np.pi))), starts, labels)
        expected = plain(bags, seed, sides_of(labels), settings, circular=True)
        check(learn(bags, seed, space="circle", settings=settings), expected)


def test_weights_and_real_values() -> None:
    # Real values: the bags labelled positive are set against the others, by weight.
    settings = CovAggSettings(learner="diverse-density")
    for seed in range(4):
        rng = np.random.default_rng([8, seed])
        bags = random_bags(rng, 2)
        weights = rng.uniform(0.5, 2, size=len(bags.labels))
        sides = sides_of(bags.labels) * weights
        values = np.stack([weights, weights * (bags.labels - 0.5)], axis=1)
        for objective, evidence in (("weighted-log-likelihood", sides.T), ("squared-error", values)):
            found = learn(bags, seed, objective=objective, evidence=evidence)  # type: ignore[arg-type]
            check(found, plain(bags, seed, sides, settings))


def test_two_positives_on_a_line_by_hand() -> None:
    # Both centres lead to the keys 0 and 1: mean .5, V = .5 + .1 * .25; witnesses .5 and 2.5 away.
    bags = BagSet(np.array([[0.0], [1], [3], [4]]), np.arange(5), np.array([True, True, False, False]))
    found = learn(bags, objective="accuracy")

    assert found is not None
    assert isinstance(found.volume, Ellipsoid)
    assert (found.score, found.n_models, found.volume.n_keys) == (4, 4, 2)
    assert found.volume.mean.tolist() == [0.5]
    assert found.volume.covariance[0, 0] == pytest.approx(0.525)
    assert found.volume.radius == pytest.approx(1.5 / math.sqrt(0.525))


def test_the_threshold_is_kolmogorovs_whatever_the_objective() -> None:
    # Shares: 1 of 2 positives within 1; both, but also 1 of 4 negatives, within 3: .5 < .75.
    squared, labels = np.array([1.0, 3, 2, 4, 5, 6]), np.array([True, True, False, False, False, False])

    assert most_apart(squared, sides_of(labels)) == (2 * 4 - 1 * 2, 3.0)
    # Not separated: the second positive and a negative at one distance.
    squared[2] = 3.0
    assert most_apart(squared, sides_of(labels))[1] == 3.0
    # No negative inside and no positive left outside either: the smaller of equals.
    assert most_apart(np.array([1.0, 2, 3]), sides_of(np.array([True, False, False]))) == (2.0, 1.0)
    # Everything inside is no distance, but a cut; without negatives, the share of positives counts.
    assert most_apart(np.array([2.0, 1]), sides_of(np.array([True, False]))) == (0.0, 2.0)
    assert most_apart(np.array([2.0, 1]), sides_of(np.array([True, True]))) == (2.0, 2.0)


def test_diverse_density_by_hand() -> None:
    sides = np.array([[0.0, 1.0], [1.0, 0.0]])

    # A positive at distance 1, a negative at distance 2: exp(-1/2) (1 - exp(-2)).
    expected = math.log(math.exp(-0.5) * (1 - math.exp(-2)))
    assert log_diverse_density(np.array([1.0, 4.0]), sides) == pytest.approx(expected)
    assert log_diverse_density(np.array([1.0, 0.0]), sides) == -math.inf
    # Weights are exponents.
    heavy = log_diverse_density(np.array([1.0, 4.0]), np.array([[0.0, 3.0], [2.0, 0.0]]))
    assert heavy == pytest.approx(2 * -0.5 + 3 * math.log(1 - math.exp(-2)))


@pytest.mark.parametrize("objective", ["accuracy", "log-likelihood"])
def test_degenerate_bags(objective: Objective) -> None:
    same = BagSet(np.full((4, 2), 3.0), np.arange(5), np.array([True, True, True, False]))
    found = learn(same, objective=objective)
    assert (found is None) == (objective == "log-likelihood")
    assert found is None or found.score == 3
    # Opposite angles have no mean; no positive bag, no volume.
    opposite = BagSet(np.array([[0.0], [np.pi], [1.5]]), np.arange(4), np.array([True, True, False]))
    assert learn(opposite, objective=objective, space="circle") is None
    none = BagSet(np.zeros((2, 1)), np.arange(3), np.zeros(2, dtype=np.bool_))
    assert learn(none, objective=objective) is None
    # All positive: nothing to separate, though all of them are right.
    both = BagSet(np.array([[0.0], [1]]), np.arange(3), np.ones(2, dtype=np.bool_))
    assert (learn(both, objective=objective) is None) == (objective == "log-likelihood")


def test_categories_are_tried_one_by_one() -> None:
    bags = BagSet(np.array([[0.0], [2], [1]]), np.arange(4), np.array([True, True, False]))
    found = learn(bags, space="category", objective="accuracy")

    assert found is not None
    assert found.score == 2
