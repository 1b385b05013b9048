from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.datasets import color
from relforest.metrics import peirce_skill_score
from relforest.mil import CovAggClassifier
from relforest.support.errors import InputError

Floats = NDArray[np.float64]
MANY = 20_000
MEANS = np.array([[0.52, 0.16, 0.18], [0.21, 0.44, 0.22], [0.17, 0.18, 0.44]])
YELLOW = np.array([0.70, 0.60, 0.15])


def covariance(mean: Floats) -> Floats:
    """.04 m m' of the light and .06^2 = .0036 of the noise."""
    result: Floats = 0.04 * np.outer(mean, mean) + 0.0036 * np.eye(3)
    return result


def moments(points: Floats) -> tuple[Floats, Floats]:
    flat = points.reshape(-1, 3)
    return flat.mean(axis=0), np.cov(flat.T)


@pytest.fixture(scope="module")
def negatives() -> Floats:
    bags = color(np.random.default_rng(0), n_bags=MANY)
    return np.concatenate([bag for bag, label in zip(bags.bags, bags.labels, strict=True) if not label])


@pytest.fixture(scope="module")
def yellows() -> Floats:
    """The most yellow point of every positive bag: its likelihood ratio to the others is the largest."""
    bags = color(np.random.default_rng(1), n_bags=MANY)
    stacked = np.stack([bag for bag, label in zip(bags.bags, bags.labels, strict=True) if label])

    def logarithm(mean: Floats) -> Floats:
        offset, inverse = stacked - mean, np.linalg.inv(covariance(mean))
        squared = np.einsum("bni,ij,bnj->bn", offset, inverse, offset)
        result: Floats = -0.5 * (squared + np.linalg.slogdet(covariance(mean))[1])
        return result

    ratio = logarithm(YELLOW) - np.logaddexp.reduce([logarithm(mean) for mean in MEANS])
    best: Floats = stacked[np.arange(len(stacked)), ratio.argmax(axis=1)]
    return best


def test_half_of_the_bags_are_positive_and_all_colors_are_in_range() -> None:
    bags = color(np.random.default_rng(0), n_bags=101)
    assert {bag.shape for bag in bags.bags} == {(5, 3)}
    assert bags.n_positive == 50
    assert min(bag.min() for bag in bags.bags) >= 0
    assert max(bag.max() for bag in bags.bags) <= 1


def test_negatives_have_the_moments_of_three_equal_parts(negatives: Floats) -> None:
    # A mixture's covariance: the mean of the parts' covariances and the covariance of the parts' means.
    mean = MEANS.mean(axis=0)
    between = (MEANS - mean).T @ (MEANS - mean) / 3
    found_mean, found = moments(negatives)
    np.testing.assert_allclose(found_mean, mean, atol=0.005)
    np.testing.assert_allclose(found, between + np.mean([covariance(m) for m in MEANS], axis=0), atol=0.001)


def test_yellow_has_its_mean_and_varies_along_its_brightness(yellows: Floats) -> None:
    # Clipping and now and then a point mistaken for the yellow one shift these a little.
    mean, found = moments(yellows)
    np.testing.assert_allclose(mean, YELLOW, atol=0.01)
    variances, axes = np.linalg.eigh(found)
    # The length of m is sqrt(.49 + .36 + .0225) = .934; along it the variance is .04 * .8725 + .0036 = .0385.
    assert variances[2] == pytest.approx(0.0385, rel=0.1)
    assert variances[:2] == pytest.approx(0.0036, rel=0.1)
    assert abs(axes[:, 2] @ YELLOW) / 0.934 == pytest.approx(1, abs=0.01)


def test_red_and_green_of_yellow_vary_together(yellows: Floats) -> None:
    # .04 * .7 * .6 = .0168 of the light; variances .04 * .49 + .0036 = .0232 and .04 * .36 + .0036 = .018.
    red, green, _ = yellows.T
    correlation = np.mean((red - red.mean()) * (green - green.mean())) / (red.std() * green.std())
    assert correlation == pytest.approx(0.0168 / np.sqrt(0.0232 * 0.018), abs=0.03)


def test_covariant_aggregation_finds_yellow() -> None:
    scores = []
    for draw in range(4):
        rng = np.random.default_rng(draw)
        train, test = color(rng), color(rng)
        model = CovAggClassifier(random_state=draw).fit(train.bags, train.labels)
        scores.append(peirce_skill_score(test.labels, model.predict(test.bags)))
    assert np.mean(scores) == pytest.approx(0.93, abs=0.06)


def test_the_same_generator_state_gives_the_same_bags() -> None:
    first, second = (color(np.random.default_rng(3)) for _ in range(2))
    np.testing.assert_array_equal(first.bags, second.bags)
    np.testing.assert_array_equal(first.labels, second.labels)


def test_one_bag_cannot_be_balanced() -> None:
    with pytest.raises(InputError, match="n_bags must be an integer of at least 2"):
        color(np.random.default_rng(0), n_bags=1)
