from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from relforest.datasets import BagSet
from relforest.experiments.mil_ablation.made_up import (
    digit_mixture,
    digits,
    elements,
    rare,
    three_parts,
    wide,
)


@pytest.mark.parametrize(
    ("draw", "n_features", "n_positive"),
    [
        (three_parts, 6, 30),
        (rare, 8, 8),
        (wide, 120, 30),
        (elements, 8, 40),
        (digits, 64, 30),
        (digit_mixture, 64, 30),
    ],
)
def test_sixty_bags(
    draw: Callable[[np.random.Generator, int], BagSet], n_features: int, n_positive: int
) -> None:
    data = draw(np.random.default_rng(0), 60)

    assert (len(data), data.n_features, data.n_positive) == (60, n_features, n_positive)
    again, other = draw(np.random.default_rng(0), 60), draw(np.random.default_rng(1), 60)
    assert all((a == b).all() for a, b in zip(data.bags, again.bags, strict=True))
    assert data.n_instances != other.n_instances or (data.bags[0] != other.bags[0]).any()


def test_halves_of_the_digits_have_no_image_in_common() -> None:
    rng = np.random.default_rng(0)
    first, second = (
        {image.tobytes() for bag in digits(rng, 200, half=half).bags for image in bag} for half in (0, 1)
    )

    assert not first & second


def test_forty_features_of_the_wide_bags_are_constant() -> None:
    points = np.concatenate(wide(np.random.default_rng(0), 40).bags)

    assert np.count_nonzero(np.ptp(points, axis=0) == 0.0) == 40
