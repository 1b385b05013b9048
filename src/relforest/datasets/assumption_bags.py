"""Bags that show whether a learner keeps the rules of multiple-instance learning (Raff and Holt 2023).

In each set, the bags for training allow two explanations of their labels. One of them follows the rule by
which bags are labelled: what a bag contains makes it positive. The other is easier to learn but breaks the
rule, and in the bags for testing it is wrong.

Distributions and ranges of counts are those of the implementation in torchmil, which names the paper as its
source (we have not compared the two); where a count is not given there, it is ours.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from relforest.datasets.bag_set import BagSet
from relforest.support.options import at_least, one_of

Part: TypeAlias = Literal["train", "test"]

_PARTS: Final = ("train", "test")
_BACKGROUND: Final = 10
# Mean of every coordinate: of points that never make a bag positive, and of the two concepts.
_SIGN: Final = -10.0
_CONCEPTS: Final = (2.0, 3.0)
_NARROW: Final = 0.1


def poisoned_presence(
    rng: np.random.Generator, *, part: Part = "train", n_bags: int = 200, n_features: int = 16
) -> BagSet:
    """Draw bags with one concept, and a sign that tempts to call bags without it positive.

    Every bag has 10 points of N(0, I), and a positive bag 1 to 3 more of the concept: each of N(0, 9 I) or of
    N(1, I), where 1 is the vector of ones. One point of N(-10, 0.01 I), the sign, is added to every negative
    bag for training, and to every positive bag for testing. As nothing a bag contains can make it negative,
    the sign is no evidence; a learner that takes it for evidence scores below chance in the test.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    part : {"train", "test"}
        Whether negative or positive bags get the sign.
    n_bags : int
        Number of bags, at least 2; ``n_bags // 2`` of them are positive.
    n_features : int
        Dimension of the points, at least 1.

    Raises
    ------
    InputError
        If an argument is out of range.

    References
    ----------
    Raff and Holt (2023), "Reproducibility in multiple instance learning: a case for algorithmic unit tests",
    NeurIPS 36, Algorithm 1.
    """

    def points_of(positive: bool, dim: int) -> list[NDArray[np.float64]]:  # noqa: FBT001 - of our own loop
        points = [rng.standard_normal((_BACKGROUND, dim))]
        if positive:
            concept = rng.standard_normal((rng.integers(1, 4), dim))
            is_wide = rng.random((len(concept), 1)) < 0.5
            points.append(np.where(is_wide, 3.0 * concept, 1.0 + concept))
        if positive == (part == "test"):
            points.append(_around(rng, _SIGN, 1, dim))
        return points

    return _drawn(rng, part, (n_bags, n_features), points_of)


def poisoned_threshold(
    rng: np.random.Generator, *, part: Part = "train", n_bags: int = 200, n_features: int = 16
) -> BagSet:
    """Draw bags that are positive if they contain two concepts, with a sign as in `poisoned_presence`.

    Every bag has 1 to 9 points of N(0, I). The concepts are N(2, 0.01 I) and N(3, 0.01 I), in each
    coordinate; a positive bag has 1 to 3 points of both, a negative bag one point of either. A learner for
    which a single instance decides cannot do better than chance; one that takes the sign for evidence does
    worse.

    Parameters, errors and source, Algorithm 2: as for `poisoned_presence`.
    """

    def points_of(positive: bool, dim: int) -> list[NDArray[np.float64]]:  # noqa: FBT001 - of our own loop
        points = [rng.standard_normal((rng.integers(1, 10), dim))]
        if positive:
            count = int(rng.integers(1, 4))
            points += [_around(rng, mean, count, dim) for mean in _CONCEPTS]
        else:
            points.append(_around(rng, _CONCEPTS[rng.integers(2)], 1, dim))
        if positive == (part == "test"):
            points.append(_around(rng, _SIGN, 1, dim))
        return points

    return _drawn(rng, part, (n_bags, n_features), points_of)


def false_frequency(
    rng: np.random.Generator, *, part: Part = "train", n_bags: int = 200, n_features: int = 16
) -> BagSet:
    """Draw bags that are positive if they contain two concepts, where counting instances misleads.

    The points and concepts are those of `poisoned_threshold`, without the sign. A positive bag has one point
    of both concepts. A negative bag has points of either: one if for training, 35 to 44 for testing. A
    learner that adds up evidence instead of asking for both concepts calls the latter positive.

    Parameters, errors and source, Algorithm 3: as for `poisoned_presence`; `part` tells how many points of a
    concept negative bags have.
    """

    def points_of(positive: bool, dim: int) -> list[NDArray[np.float64]]:  # noqa: FBT001 - of our own loop
        points = [rng.standard_normal((rng.integers(1, 10), dim))]
        if positive:
            points += [_around(rng, mean, 1, dim) for mean in _CONCEPTS]
        else:
            count = 1 if part == "train" else int(rng.integers(35, 45))
            points.append(_around(rng, _CONCEPTS[rng.integers(2)], count, dim))
        return points

    return _drawn(rng, part, (n_bags, n_features), points_of)


def _drawn(
    rng: np.random.Generator,
    part: str,
    size: tuple[int, int],
    points_of: Callable[[bool, int], list[NDArray[np.float64]]],
) -> BagSet:
    """Return so many bags of points with so many features; `points_of` says what a bag contains."""
    one_of("part", part, _PARTS)
    n_bags, dim = at_least("n_bags", size[0], 2), at_least("n_features", size[1], 1)
    labels: NDArray[np.bool_] = np.arange(n_bags) < n_bags // 2
    rng.shuffle(labels)
    bags = [rng.permutation(np.concatenate(points_of(bool(positive), dim))) for positive in labels]
    return BagSet(bags, labels)


def _around(rng: np.random.Generator, mean: float, count: int, dim: int) -> NDArray[np.float64]:
    return mean + _NARROW * rng.standard_normal((count, dim))
