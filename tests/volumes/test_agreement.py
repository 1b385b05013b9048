"""The compiled search against its plain twin: the same draws, hence the same volume."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray

from reference import covagg as twin
from relforest.volumes import Arc, CovAggSettings, Ellipsoid, aggregate

Floats = NDArray[np.float64]
Space = Literal["euclidean", "circle"]
Objective = Literal["accuracy", "log-likelihood"]
Problem = tuple[Floats, NDArray[np.int64], NDArray[np.bool_]]

OBJECTIVES: tuple[Objective, ...] = ("accuracy", "log-likelihood")
# Where three or more keys lie mathematically at one distance, rounding decides; these sets avoid that.
SEEDS = range(8)


def random_problem(rng: np.random.Generator, dim: int) -> Problem:
    """Bags of 1 to 6 points around an oblique cloud; most positive bags hold a point near one place."""
    n_bags = int(rng.integers(4, 40))
    sizes = rng.integers(1, 7, size=n_bags)
    starts = np.concatenate([[0], np.cumsum(sizes)])
    labels = rng.random(n_bags) < 0.5
    labels[0] = True
    points = rng.standard_normal((starts[-1], dim)) @ rng.standard_normal((dim, dim))
    place = rng.standard_normal(dim)
    for bag in np.flatnonzero(labels & (rng.random(n_bags) < 0.8)):
        points[rng.integers(starts[bag], starts[bag + 1])] = place + 0.3 * rng.standard_normal(dim)
    return points, starts, labels


def random_angles(rng: np.random.Generator) -> Problem:
    """The same on the circle; a third of the places are close to the seam at pi."""
    points, starts, labels = random_problem(rng, 1)
    around = np.pi if rng.random() < 1 / 3 else 0.0
    return np.angle(np.exp(1j * (points + around))), starts, labels


def random_settings(rng: np.random.Generator) -> dict[str, int | float]:
    return {
        "window": int(rng.integers(2, 10)),
        "restarts": int(rng.integers(1, 6)),
        "sampled": int(rng.integers(1, 6)),
        "prior_weight": float(rng.choice([0.01, 0.1, 2.0])),
        "max_condition": float(rng.choice([3.0, 100.0, 1e5])),
    }


def check(
    problem: Problem,
    objective: Objective,
    *,
    space: Space = "euclidean",
    seed: int = 0,
    options: dict[str, int | float] | None = None,
) -> twin.Model | None:
    """Assert that both searches find the same and return what the twin found."""
    points, starts, labels = problem
    options = options or {}
    found = aggregate(
        points,
        starts,
        labels,
        space=space,
        objective=objective,
        settings=CovAggSettings(**options),  # type: ignore[arg-type]
        rng=np.random.default_rng(seed),
    )
    settings = twin.Settings(**options)  # type: ignore[arg-type]
    rng = np.random.default_rng(seed)
    expected = twin.aggregate(
        points, starts, labels, space=space, objective=objective, settings=settings, rng=rng
    )
    if found is None or expected is None:
        assert found is None
        assert expected is None
        return None
    volume = found.volume
    assert found.score == pytest.approx(expected.score, rel=1e-10)
    assert volume.radius == pytest.approx(expected.radius, rel=1e-7, abs=1e-12)
    if isinstance(volume, Arc):
        assert np.cos(volume.mean - expected.mean[0]) == pytest.approx(1)
        kappa = twin.kappa(expected, points, starts, labels, settings.prior_weight)
        assert volume.kappa == pytest.approx(kappa, rel=1e-6)
    else:
        assert isinstance(volume, Ellipsoid)
        assert volume.n_keys == len(expected.keys)
        assert volume.prior_weight == settings.prior_weight
        np.testing.assert_allclose(volume.mean, expected.mean, rtol=1e-8, atol=1e-10)
        # In three dimensions the closed form knows a double smallest eigenvalue to 1e-8 of the largest.
        slack = 1e-8 * float(np.trace(expected.covariance))
        np.testing.assert_allclose(volume.covariance, expected.covariance, rtol=1e-7, atol=slack)
    return expected


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("dim", [1, 2, 3, 5])
def test_random_bags_of_different_sizes(dim: int, objective: Objective) -> None:
    for seed in SEEDS:
        rng = np.random.default_rng([dim, seed])
        check(random_problem(rng, dim), objective, seed=seed)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("dim", [1, 2, 3, 5])
def test_random_settings(dim: int, objective: Objective) -> None:
    for seed in SEEDS:
        rng = np.random.default_rng([10, dim, seed])
        check(random_problem(rng, dim), objective, seed=seed, options=random_settings(rng))


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_random_angles(objective: Objective) -> None:
    for seed in SEEDS:
        rng = np.random.default_rng([20, seed])
        check(random_angles(rng), objective, space="circle", seed=seed, options=random_settings(rng))


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_points_that_repeat_within_a_class(dim: int, objective: Objective) -> None:
    for seed in SEEDS:
        rng = np.random.default_rng([30, dim, seed])
        points, starts, labels = random_problem(rng, dim)
        in_negative = np.flatnonzero(~np.repeat(labels, np.diff(starts)))
        if len(in_negative):
            points[in_negative] = points[rng.choice(in_negative[:5], size=len(in_negative))]
        check((points, starts, labels), objective, seed=seed)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_equal_distances_of_both_classes(dim: int, objective: Objective) -> None:
    # A single positive bag keeps the mean at one of its points, so that copies lie at equal distances.
    for seed in SEEDS:
        rng = np.random.default_rng([40, dim, seed])
        points, starts, _ = random_problem(rng, dim)
        points = points[rng.integers(6, size=len(points))]
        labels = np.zeros(len(starts) - 1, dtype=np.bool_)
        labels[rng.integers(len(labels))] = True
        check((points, starts, labels), objective, seed=seed)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("dim", [1, 2, 3, 5])
def test_all_positive_points_are_the_same(dim: int, objective: Objective) -> None:
    # No spread at all: the covariance falls back to the identity, so distances are Euclidean.
    labels = np.array([True, False, True, False, True])
    points = np.zeros((5, dim))
    points[labels] = 2.0
    points[3, 0] = 5.0
    found = check((points, np.arange(6), labels), objective)
    assert found is not None
    assert len(found.keys) == 3
    np.testing.assert_array_equal(found.covariance, np.eye(dim))
    # The positives lie at 0; the nearer negative at |(2, ..) - (0, ..)| or |(2, ..) - (5, 0, ..)|: halfway.
    nearest = min(2 * np.sqrt(dim), np.sqrt(9 + 4 * (dim - 1)))
    assert found.radius == pytest.approx(nearest / 2)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_a_constant_component(objective: Objective) -> None:
    # The second component never varies: the prior is singular and conditioning has to repair it.
    rng = np.random.default_rng(5)
    points, starts, labels = random_problem(rng, 2)
    points[:, 1] = 3.0
    found = check((points, starts, labels), objective)
    assert found is not None
    assert np.linalg.cond(found.covariance) == pytest.approx(1e5, rel=1e-6)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("label", [True, False])
def test_one_class(objective: Objective, *, label: bool) -> None:
    points, starts, labels = random_problem(np.random.default_rng(6), 2)
    labels[:] = label
    found = check((points, starts, labels), objective)
    assert (found is None) == (objective == "log-likelihood" or not label)


def test_opposite_angles_have_no_mean() -> None:
    # Two keys half a turn apart: whichever comes first, the step that joins them is not admissible.
    points = np.array([[0.0], [np.pi], [1.5], [-1.5]])
    labels = np.array([True, True, False, False])
    found = check((points, np.arange(5), labels), "accuracy", space="circle")
    assert found is not None
    assert len(found.keys) == 1
