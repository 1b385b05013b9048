from __future__ import annotations

from typing import Any

import pytest

from relforest.support.errors import InputError
from relforest.worlds.blocks.handling import Handling
from relforest.worlds.blocks.noise import Noise


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
