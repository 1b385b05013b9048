"""Bags that test assumptions: what they contain, by label and part."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
import pytest

from relforest.datasets import BagSet, false_frequency, poisoned_presence, poisoned_threshold
from relforest.support.errors import InputError

GENERATORS: tuple[Callable[..., BagSet], ...] = (poisoned_presence, poisoned_threshold, false_frequency)
each_part = pytest.mark.parametrize("part", ["train", "test"])


def counts(data: BagSet, mean: float) -> tuple[list[int], list[int]]:
    """How many points near a mean, in every coordinate, the negative and the positive bags have."""
    near = np.array([int((np.abs(bag - mean).max(axis=1) < 0.5).sum()) for bag in data.bags])
    return near[~data.labels].tolist(), near[data.labels].tolist()


@pytest.mark.parametrize("generator", GENERATORS)
@each_part
def test_half_of_the_bags_are_positive_and_seeds_repeat_them(
    generator: Callable[..., BagSet], part: str
) -> None:
    first, second = (generator(np.random.default_rng(1), part=part, n_bags=21) for _ in range(2))

    assert first.n_positive == 10
    assert first.n_features == 16
    assert all((a == b).all() for a, b in zip(first.bags, second.bags, strict=True))
    # The points of a bag are in random order.
    other = generator(np.random.default_rng(2), part=part, n_bags=21)
    assert [len(bag) for bag in other.bags] != [len(bag) for bag in first.bags]


@each_part
def test_the_sign_is_in_negative_bags_of_training_and_in_positive_ones_of_the_test(
    part: Literal["train", "test"],
) -> None:
    for generator in (poisoned_presence, poisoned_threshold):
        negative, positive = counts(generator(np.random.default_rng(0), part=part), -10.0)
        with_it, without = (negative, positive) if part == "train" else (positive, negative)

        assert set(with_it) == {1}
        assert set(without) == {0}


def test_one_concept_makes_bags_larger_by_one_to_three_points() -> None:
    data = poisoned_presence(np.random.default_rng(0), n_bags=400)
    sizes = np.array([len(bag) for bag in data.bags])

    assert set(sizes[~data.labels]) == {11}
    assert set(sizes[data.labels]) == {11, 12, 13}
    # N(1, I) has a mean square of 2 a coordinate, N(0, 9 I) of 9; the background has 1.
    squares = np.concatenate(
        [(bag**2).mean(axis=1) for bag, label in zip(data.bags, data.labels, strict=True) if label]
    )
    assert 0.25 < (squares > 4.0).sum() / data.n_positive / 2.0 < 0.75


@each_part
def test_positive_bags_have_both_concepts_and_negative_ones_either(part: Literal["train", "test"]) -> None:
    for generator, most in ((poisoned_threshold, 3), (false_frequency, 1)):
        data = generator(np.random.default_rng(0), part=part)
        (twos, both_twos), (threes, both_threes) = counts(data, 2.0), counts(data, 3.0)

        assert both_twos == both_threes
        assert set(both_twos) == set(range(1, most + 1))
        many = set(range(35, 45)) if (part, generator) == ("test", false_frequency) else {1}
        found = set(np.add(twos, threes).tolist())
        assert found <= many
        assert all(0 in pair for pair in zip(twos, threes, strict=True))


@pytest.mark.parametrize("generator", GENERATORS)
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"part": "validation"}, "part must be one of 'train', 'test'|part must be 'train' or 'test'"),
        ({"n_bags": 1}, "n_bags must be an integer of at least 2"),
        ({"n_features": 0}, "n_features must be an integer of at least 1"),
    ],
)
def test_bad_options_are_refused(
    generator: Callable[..., BagSet], options: dict[str, Any], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        generator(np.random.default_rng(0), **options)
