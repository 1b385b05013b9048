"""Volumes along the axes and of one coordinate: by hand, against the plain twin, and their invariances."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from reference import covagg as twin
from relforest.support.errors import InputError
from relforest.volumes import Aggregation, CovAggSettings, Ellipsoid, Objective, Slab, aggregate
from relforest.volumes.settings import Shape, VolumeLearner
from strategies import BagSet

Floats = NDArray[np.float64]
OBJECTIVES: tuple[Objective, ...] = ("accuracy", "log-likelihood")
LEARNERS: tuple[VolumeLearner, ...] = ("covagg", "diverse-density")
seeds = st.integers(0, 2**20)


def random_bags(rng: np.random.Generator, dim: int, n_bags: int = 14) -> BagSet:
    """Bags of 1 to 4 points of an oblique cloud; most positive ones hold a point near one place."""
    starts = np.concatenate([[0], np.cumsum(rng.integers(1, 5, size=n_bags))])
    labels = np.arange(n_bags) % 2 == 0
    points = rng.standard_normal((starts[-1], dim)) @ rng.standard_normal((dim, dim))
    place = rng.standard_normal(dim)
    for bag in np.flatnonzero(labels & (rng.random(n_bags) < 0.8)):
        points[starts[bag]] = place + 0.3 * rng.standard_normal(dim)
    return BagSet(points, starts, labels)


def learn(
    bags: BagSet,
    shape: Shape,
    seed: int = 0,
    *,
    objective: Objective = "accuracy",
    learner: VolumeLearner = "covagg",
    max_condition: float = 1e5,
) -> Aggregation | None:
    options = CovAggSettings(shape=shape, learner=learner, max_condition=max_condition, restarts=3)
    return aggregate(*bags, rng=np.random.default_rng(seed), objective=objective, settings=options)


def learned(bags: BagSet, shape: Shape, seed: int = 0, *, learner: VolumeLearner = "covagg") -> Aggregation:
    found = learn(bags, shape, seed, learner=learner)
    assert found is not None
    return found


def witnesses(found: Aggregation, bags: BagSet) -> Floats:
    distances: Floats = np.minimum.reduceat(found.volume.distance(bags.points), bags.starts[:-1])
    return distances


def test_a_diagonal_volume_by_hand() -> None:
    # Keys (0, 0) and (2, 4): scatter diag(2, 8) without its products 4; prior .1 * diag(1, 4).
    points = np.array([[0.0, 0.0], [2.0, 4.0], [9.0, 9.0]])
    found = learned(BagSet(points, np.arange(4), np.array([True, True, False])), "diagonal")

    assert isinstance(found.volume, Ellipsoid)
    assert found.volume.mean.tolist() == [1, 2]
    np.testing.assert_allclose(found.volume.covariance, np.diag([2.1, 8.4]))
    # 1 / 2.1 + 4 / 8.4 and 64 / 2.1 + 49 / 8.4: the radius is midway between the roots.
    expected = (np.sqrt(1 / 2.1 + 4 / 8.4) + np.sqrt(64 / 2.1 + 49 / 8.4)) / 2
    assert found.volume.radius == pytest.approx(expected)


def test_an_interval_of_the_only_coordinate_that_tells() -> None:
    # x is the same in all bags; y as in the example on a line.
    points = np.array([[5.0, 0.0], [5.0, 1.0], [5.0, 3.0], [5.0, 4.0]])
    found = learned(BagSet(points, np.arange(5), np.array([True, True, False, False])), "axis")

    assert isinstance(found.volume, Slab)
    assert (found.volume.axis, found.volume.dim, found.score) == (1, 2, 4)
    interval = found.volume.interval
    assert (interval.n_keys, interval.mean.tolist()) == (2, [0.5])
    assert interval.radius * np.sqrt(interval.covariance[0, 0]) == pytest.approx(1.5)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("dim", [2, 3, 5, 12])
def test_diagonal_volumes_are_those_of_the_twin(
    dim: int, objective: Literal["accuracy", "log-likelihood"]
) -> None:
    for seed in range(4):
        bags = random_bags(np.random.default_rng([dim, seed]), dim)
        for max_condition in (5.0, 1e5):
            found = learn(bags, "diagonal", seed, objective=objective, max_condition=max_condition)
            options = twin.Settings(restarts=3, max_condition=max_condition, shape="diagonal")
            rng = np.random.default_rng(seed)
            expected = twin.aggregate(*bags, objective=objective, settings=options, rng=rng)
            assert (found is None) == (expected is None)
            if found is None or expected is None:
                continue
            assert isinstance(found.volume, Ellipsoid)
            assert found.score == pytest.approx(expected.score, rel=1e-10)
            assert found.volume.n_keys == len(expected.keys)
            assert found.volume.radius == pytest.approx(expected.radius, rel=1e-7)
            np.testing.assert_allclose(found.volume.mean, expected.mean, rtol=1e-8, atol=1e-10)
            np.testing.assert_allclose(found.volume.covariance, expected.covariance, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("dim", [2, 3, 5])
def test_slabs_are_the_best_intervals_of_the_twin(
    dim: int, objective: Literal["accuracy", "log-likelihood"]
) -> None:
    for seed in range(4):
        bags = random_bags(np.random.default_rng([dim, 9, seed]), dim)
        found = learn(bags, "axis", seed, objective=objective)
        n_positive = int(bags.labels.sum())
        n_draws = 3 * (1 + 4 * n_positive)
        each = []
        for axis in range(dim):
            # Every coordinate has as many draws of its own, used or not.
            rng = np.random.default_rng(seed)
            rng.random(axis * n_draws)
            column, options = bags.points[:, [axis]], twin.Settings(restarts=3)
            model = twin.aggregate(
                column, bags.starts, bags.labels, objective=objective, settings=options, rng=rng
            )
            each.append((-np.inf, None) if model is None else (model.score, model))
        score, best = max(each, key=lambda one: one[0])
        assert (found is None) == (best is None)
        if found is None or best is None:
            continue
        assert isinstance(found.volume, Slab)
        assert found.score == pytest.approx(score, rel=1e-10)
        assert found.volume.axis == [one[0] for one in each].index(score)
        assert found.volume.radius == pytest.approx(best.radius, rel=1e-7)
        np.testing.assert_allclose(found.volume.interval.mean, best.mean, rtol=1e-8, atol=1e-10)


@pytest.mark.parametrize("learner", LEARNERS)
def test_on_a_line_all_shapes_are_the_same(learner: VolumeLearner) -> None:
    bags = random_bags(np.random.default_rng(3), 1)
    documents = [learned(bags, shape, learner=learner).volume.to_dict() for shape in ("full", "axis")]

    assert documents[0] == documents[1] == learned(bags, "diagonal", learner=learner).volume.to_dict()


@pytest.mark.parametrize("learner", LEARNERS)
@pytest.mark.parametrize("shape", ["diagonal", "axis"])
@settings(max_examples=6)
@given(seed=seeds, dim=st.integers(2, 4))
def test_moving_and_scaling_each_axis_changes_nothing(
    shape: Literal["diagonal", "axis"], learner: VolumeLearner, seed: int, dim: int
) -> None:
    # A power of two rounds nothing; that a shift rounds does not matter for random points.
    rng = np.random.default_rng(seed)
    bags = random_bags(rng, dim, n_bags=8)
    units, shift = 2.0 ** rng.integers(-2, 3, size=dim), rng.uniform(-5, 5, size=dim)
    there = bags._replace(points=(bags.points + shift) * units)
    here = learned(bags, shape, seed, learner=learner)
    moved = learned(there, shape, seed, learner=learner)
    if isinstance(here.volume, Ellipsoid):
        # Otherwise eq. 3.6 would compare variances of different units.
        assume(np.linalg.cond(here.volume.covariance) < 1e3)
        assert (here.volume.covariance == np.diag(np.diag(here.volume.covariance))).all()

    assert moved.score == here.score
    assert moved.n_models == here.n_models
    np.testing.assert_allclose(witnesses(moved, there), witnesses(here, bags), rtol=1e-6, atol=1e-9)
    if isinstance(here.volume, Slab):
        assert isinstance(moved.volume, Slab)
        assert moved.volume.axis == here.volume.axis
        scaled = bags._replace(points=bags.points * units)
        again = learned(scaled, shape, seed, learner=learner)
        assert again.volume.radius == here.volume.radius


@pytest.mark.parametrize("learner", LEARNERS)
@pytest.mark.parametrize("shape", ["full", "diagonal", "axis"])
def test_the_same_generator_gives_the_same_volume(shape: Shape, learner: VolumeLearner) -> None:
    bags = random_bags(np.random.default_rng(1), 3, n_bags=30)
    first, again = (learned(bags, shape, 7, learner=learner).volume.to_dict() for _ in range(2))

    assert first == again


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"shape": "round"}, "shape must be one of 'full', 'diagonal', 'axis', got 'round'"),
        ({"learner": "em-dd"}, "learner must be one of 'covagg', 'diverse-density', got 'em-dd'"),
    ],
)
def test_unknown_options_are_refused(options: dict[str, str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        CovAggSettings(**options)  # type: ignore[arg-type]
