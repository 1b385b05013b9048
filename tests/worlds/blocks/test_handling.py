from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from relforest.support.errors import InputError
from relforest.worlds.blocks.handling import Handling, Noise, spread


def test_the_robot_errs_by_default_as_the_authors_does() -> None:
    assert Handling() == Handling(noise=Noise(0.5, 1.0, 0.025), overlap="original")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"noise": 1.0}, r"noise must be a Noise, such as Noise.none\(\), got 1.0"),
        ({"overlap": "none"}, "overlap must be one of 'original', 'interval', got 'none'"),
    ],
)
def test_handling_is_checked(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Handling(**options)


@pytest.mark.parametrize("field", ["grasp", "carry", "rotate"])
@pytest.mark.parametrize("value", [-0.1, math.nan, math.inf, "much"])
def test_noise_is_checked(field: str, value: object) -> None:
    with pytest.raises(InputError, match=field):
        Noise(**{field: value})  # type: ignore[arg-type]


def test_a_robot_without_noise_draws_the_same_numbers() -> None:
    precise, usual = np.random.default_rng(0), np.random.default_rng(0)

    assert spread(precise, Noise.none().carry) == (0.0, 0.0)
    spread(usual, Noise().carry)
    assert precise.random() == usual.random()


def test_errors_are_independent_in_x_and_y() -> None:
    rng = np.random.default_rng(0)
    errors = np.array([spread(rng, 2.0) for _ in range(4000)])

    assert errors.std(axis=0) == pytest.approx([2.0, 2.0], rel=0.05)
    assert abs(np.corrcoef(errors.T)[0, 1]) < 0.05
