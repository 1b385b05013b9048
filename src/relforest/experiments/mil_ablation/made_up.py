"""Made-up bags with the difficulties of published sets: many features, rare positives, other units, mixtures.

They take the place of the published sets while a learner is designed, so that those can be kept for one final
comparison. Three of them imitate facts of published sets that were known before: `elements` the pairs of
element and type and the charges of Mutagenesis, `rare` the 13 % positive bags and the units of Thioredoxin,
`wide` the constant features of Elephant, Fox and Tiger. They contain no bags of these sets, and all
other numbers are ours. The truth of each set is the same in every draw.
"""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray
from sklearn.datasets import load_digits

from relforest.datasets import BagSet

_RARE_POSITIVES: Final = 20
_RARE_BAGS: Final = 150
_UNITS: Final = np.array([1.0, 1e4, 10.0, 100.0, 1.0, 1e3, 30.0, 1.0])
_SEVENTH: Final = 27
_SIXTH: Final = 22


def three_parts(rng: np.random.Generator, n_bags: int = 100) -> BagSet:
    """Draw bags of 6 points in 6 dimensions: positives on any of three thick planes, negatives N(0, I)."""
    truth = np.random.default_rng(3)
    centres = truth.standard_normal((3, 6))
    centres *= 2.6 / np.linalg.norm(centres, axis=1)[:, None]
    planes = 0.8 * truth.standard_normal((3, 6, 2))
    labels = _alternate(n_bags)
    bags = []
    for positive in labels:
        bag = rng.standard_normal((6, 6))
        if positive:
            part = rng.integers(3)
            bag[0] = centres[part] + planes[part] @ rng.standard_normal(2) + 0.25 * rng.standard_normal(6)
        bags.append(bag)
    return BagSet(bags, labels)


def rare(rng: np.random.Generator, n_bags: int = _RARE_BAGS) -> BagSet:
    """Draw 20 to 59 points of 8 skewed features in units from 1 to 1e4; 13 % of the bags are positive.

    One or two points of a positive bag lie along a line in three of the features.
    """
    mixing = 0.4 * np.random.default_rng(5).standard_normal((8, 8)) + np.eye(8)
    labels = np.arange(n_bags) < n_bags * _RARE_POSITIVES // _RARE_BAGS
    bags = []
    for positive in labels:
        bag = rng.standard_normal((rng.integers(20, 60), 8)) @ mixing
        if positive:
            found = bag[: rng.integers(1, 3)]
            along = 0.6 * rng.standard_normal(len(found))
            found[:, 0] = 1.8 + along
            found[:, 1] = 1.8 - along + 0.15 * rng.standard_normal(len(found))
            found[:, 2] = 1.2 + 0.3 * rng.standard_normal(len(found))
        bag[:, 3] = np.exp(bag[:, 3])
        bag[:, 5] = np.exp(0.5 * bag[:, 5])
        bags.append(bag * _UNITS)
    return BagSet(bags, labels)


def wide(rng: np.random.Generator, n_bags: int = 100) -> BagSet:
    """Draw 2 to 12 points of 120 features, 40 of them constant, that are sparse images of 8 hidden ones.

    Four of five positive bags hold a point of one of two hidden clusters, and two of five negative bags one
    of two others.
    """
    truth = np.random.default_rng(9)
    image = truth.standard_normal((8, 120)) * (truth.random((8, 120)) < 0.3)
    seen, unseen = 1.6 * truth.standard_normal((2, 8)), 1.6 * truth.standard_normal((2, 8))
    labels = _alternate(n_bags)
    bags = []
    for positive in labels:
        hidden = rng.standard_normal((rng.integers(2, 13), 8))
        if rng.random() < (0.8 if positive else 0.4):
            centre = (seen if positive else unseen)[rng.integers(2)]
            hidden[0] = centre + 0.6 * rng.standard_normal(8)
        bag = np.maximum(hidden @ image + 0.5 * rng.standard_normal((len(hidden), 120)), 0.0)
        bag[:, 80:] = 0.0
        bag[:, :20] *= 100.0
        bags.append(bag)
    return BagSet(bags, labels)


def elements(rng: np.random.Generator, n_bags: int = 150) -> BagSet:
    """Draw 4 to 20 points, each an element (6 columns, 2 never used), a type and a charge; 2/3 positive.

    A hidden trait of the bag makes one type more frequent, the bag larger and it positive; so does, less, the
    presence of the rarest element.
    """
    wanted = {True: n_bags * 2 // 3, False: n_bags - n_bags * 2 // 3}
    bags: list[NDArray[np.float64]] = []
    labels: list[bool] = []
    while len(bags) < n_bags:
        trait = rng.standard_normal()
        size = int(np.clip(8 + 3 * trait + 2 * rng.standard_normal(), 4, 20))
        element = rng.choice(4, size, p=[0.45, 0.35, 0.12, 0.08])
        ring = np.where(rng.random(size) < 1.0 / (1.0 + np.exp(-trait)), _SEVENTH, _SIXTH)
        types = np.where(element == 0, ring, np.array([0, 3, 38, 40])[element])
        charge = np.array([-0.1, 0.14, 0.8, -0.4])[element] + 0.03 * rng.standard_normal(size)
        charge += 0.05 * (types == _SEVENTH) + 0.02 * trait
        positive = bool(trait + 0.5 * rng.standard_normal() + 0.8 * (element == 3).any() > 0.0)
        if labels.count(positive) < wanted[positive]:
            bags.append(np.column_stack([charge, types, np.eye(6)[element]]))
            labels.append(positive)
    return BagSet(bags, np.array(labels))


def digits(rng: np.random.Generator, n_bags: int = 100, *, half: int = 0) -> BagSet:
    """Draw bags of 4 to 11 handwritten digits, 8 x 8 pixels; positive ones hold exactly one 9.

    The two halves of the images, 0 and 1, have none in common.
    """
    images, numbers = _digits(half)
    nines, others = np.flatnonzero(numbers == 9), np.flatnonzero(numbers != 9)
    labels = _alternate(n_bags)
    bags = []
    for positive in labels:
        rows = rng.choice(others, rng.integers(4, 12))
        if positive:
            rows[0] = rng.choice(nines)
        bags.append(images[rows])
    return BagSet(bags, labels)


def digit_mixture(rng: np.random.Generator, n_bags: int = 100, *, half: int = 0) -> BagSet:
    """Draw bags of 3 to 9 handwritten digits: positive bags have more low ones, but none is a sign.

    The two halves of the images, 0 and 1, have none in common.
    """
    images, numbers = _digits(half)
    frequency = np.array([3.0, 3.0, 2.0, 2.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0])
    labels = _alternate(n_bags)
    bags = []
    for positive in labels:
        weights = (frequency if positive else frequency[::-1])[numbers]
        bags.append(images[rng.choice(len(images), rng.integers(3, 10), p=weights / weights.sum())])
    return BagSet(bags, labels)


@cache
def _digits(half: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    images, numbers = load_digits(return_X_y=True)
    rows = np.random.default_rng(0).permutation(len(images))[half::2]
    return images[rows], numbers[rows]


def _alternate(n_bags: int) -> NDArray[np.bool_]:
    labels: NDArray[np.bool_] = np.arange(n_bags) % 2 == 1
    return labels
