from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.datasets import BagSet, covariant1, covariant2, disjunctive
from relforest.support.errors import InputError

Floats = NDArray[np.float64]
Matrix = list[list[float]]
MANY = 20_000

GENERATORS: tuple[Callable[..., BagSet], ...] = (covariant1, covariant2, disjunctive)


def points(bags: BagSet, *, positive: bool | None = None) -> Floats:
    """All points, or those of the positive or of the negative bags, (n, size, d)."""
    stacked = np.stack(bags.bags)
    return stacked if positive is None else stacked[bags.labels == positive]


def second_moment(points: Floats) -> Floats:
    flat = points.reshape(-1, points.shape[-1])
    moment: Floats = flat.T @ flat / len(flat)
    return moment


@pytest.mark.parametrize("generator", GENERATORS)
def test_half_of_the_bags_are_positive_in_random_order(generator: Callable[..., BagSet]) -> None:
    bags = generator(np.random.default_rng(0), n_bags=101)
    assert points(bags).shape == (101, 10 if generator is disjunctive else 3, 2)
    assert bags.labels.shape == (101,)
    assert bags.labels.sum() == 50
    assert 10 < bags.labels[:50].sum() < 40


@pytest.mark.parametrize("generator", GENERATORS)
def test_the_same_generator_state_gives_the_same_bags(generator: Callable[..., BagSet]) -> None:
    first, second = (generator(np.random.default_rng(3)) for _ in range(2))
    np.testing.assert_array_equal(points(first), points(second))
    np.testing.assert_array_equal(first.labels, second.labels)


@pytest.mark.parametrize("generator", GENERATORS)
def test_bags_are_read_only(generator: Callable[..., BagSet]) -> None:
    bags = generator(np.random.default_rng(0))
    assert not any(bag.flags.writeable for bag in bags.bags)
    assert not bags.labels.flags.writeable


# Negatives +-(c, -c) + N(0, I) have second moment I + c^2 [[1, -1], [-1, 1]]: 3 and -2 for c^2 = 2, 5 and -4
# for c = 2. In a positive bag one of three points has S = [[.52, .48], [.48, .52]] instead: (2 * 3 + .52) / 3
# = 2.1733 and (2 * -2 + .48) / 3 = -1.1733; (2 * 5 + .52) / 3 = 3.5067 and (-8 + .48) / 3 = -2.5067.
@pytest.mark.parametrize(
    ("reading", "negative", "positive"),
    [
        ("sqrt2", [[3, -2], [-2, 3]], [[2.1733, -1.1733], [-1.1733, 2.1733]]),
        ("printed", [[5, -4], [-4, 5]], [[3.5067, -2.5067], [-2.5067, 3.5067]]),
    ],
)
def test_covariant1_has_the_moments_of_its_mixtures(reading: str, negative: Matrix, positive: Matrix) -> None:
    bags = covariant1(np.random.default_rng(1), reading=reading, n_bags=MANY)  # type: ignore[arg-type]
    np.testing.assert_allclose(second_moment(points(bags, positive=False)), negative, atol=0.1)
    np.testing.assert_allclose(second_moment(points(bags, positive=True)), positive, atol=0.1)
    np.testing.assert_allclose(points(bags).mean(axis=(0, 1)), 0, atol=0.05)


def test_covariant1_negatives_come_in_two_clouds_of_unit_variance() -> None:
    bags = covariant1(np.random.default_rng(2), reading="printed", n_bags=MANY)
    negatives = points(bags, positive=False).reshape(-1, 2)
    # Along (1, -1) / sqrt 2 the clouds lie at +-2 sqrt 2: they hardly overlap, so the sign tells them apart.
    along = (negatives[:, 0] - negatives[:, 1]) / np.sqrt(2)
    cloud = along[along > 0]
    assert cloud.mean() == pytest.approx(2 * np.sqrt(2), abs=0.05)
    assert cloud.std() == pytest.approx(1, abs=0.05)
    assert (along > 0).mean() == pytest.approx(0.5, abs=0.01)


def test_covariant2_has_the_moments_of_its_mixtures() -> None:
    bags = covariant2(np.random.default_rng(1), n_bags=MANY)
    np.testing.assert_allclose(second_moment(points(bags, positive=False)), np.eye(2), atol=0.05)
    # (2 * 1 + .52) / 3 = .84 and (2 * 0 + .48) / 3 = .16
    np.testing.assert_allclose(
        second_moment(points(bags, positive=True)), [[0.84, 0.16], [0.16, 0.84]], atol=0.05
    )


def test_disjunctive_has_the_moments_of_its_mixtures() -> None:
    bags = disjunctive(np.random.default_rng(1), n_bags=MANY)
    np.testing.assert_allclose(second_moment(points(bags, positive=False)), np.eye(2), atol=0.05)
    # x: (9 * 1 + 9 + .5) / 10 = 1.85, y: (9 * 1 + .5) / 10 = .95
    np.testing.assert_allclose(second_moment(points(bags, positive=True)), [[1.85, 0], [0, 0.95]], atol=0.05)
    np.testing.assert_allclose(points(bags).mean(axis=(0, 1)), 0, atol=0.05)


def test_the_positive_point_is_equally_often_at_every_place() -> None:
    bags = disjunctive(np.random.default_rng(4), n_bags=MANY)
    # A normal x lies beyond 2.5 with probability .0124; one around +-3 with variance 1/2 with .7603.
    # So each of ten places should see (9 * .0124 + .7603) / 10 = .0872 of the positive bags beyond.
    beyond = (np.abs(points(bags, positive=True)[..., 0]) > 2.5).mean(axis=0)
    np.testing.assert_allclose(beyond, 0.0872, atol=0.015)


@pytest.mark.parametrize("generator", GENERATORS)
def test_one_bag_cannot_be_balanced(generator: Callable[..., BagSet]) -> None:
    with pytest.raises(InputError, match="n_bags must be an integer of at least 2"):
        generator(np.random.default_rng(0), n_bags=1)


def test_an_unknown_reading_is_refused() -> None:
    with pytest.raises(InputError, match="reading must be one of 'sqrt2', 'printed'"):
        covariant1(np.random.default_rng(0), reading="rotated")  # type: ignore[arg-type]


# Studies that were run must be repeatable: a seed keeps its bags.
@pytest.mark.parametrize(
    ("generator", "first", "total", "labels"),
    [
        (covariant1, [1.4743571649705336, -0.07399831681856162], -9.058317, [True, False, False, True]),
        (covariant2, [0.0012301533574825742, 0.2987455375084699], -7.095267, [True, False, True, False]),
        (disjunctive, [0.0012301533574825742, 0.2987455375084699], -10.592832, [False, False, True, True]),
    ],
)
def test_a_seed_keeps_its_bags(
    generator: Callable[..., BagSet], first: list[float], total: float, labels: list[bool]
) -> None:
    bags = generator(np.random.default_rng(7), n_bags=4)
    np.testing.assert_allclose(bags.bags[0][0], first, rtol=1e-12)
    assert points(bags).sum() == pytest.approx(total, abs=1e-5)
    assert bags.labels.tolist() == labels
