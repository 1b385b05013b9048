from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from relforest.support.errors import InputError
from relforest.support.progress import Stage, listening
from relforest.worlds.blocks.balance import balance_scale_scenes
from relforest.worlds.blocks.drop_on import drop_on_scenes


@pytest.mark.parametrize("draw", [balance_scale_scenes, drop_on_scenes])
def test_the_source_of_random_numbers_is_a_generator(draw: Any) -> None:
    with pytest.raises(InputError, match=r"rng must be a numpy Generator, .*, got 3"):
        draw(3, 1)


def test_every_scene_is_reported() -> None:
    stages: list[Stage] = []
    with listening(stages.append):
        balance_scale_scenes(np.random.default_rng(0), 3)
    assert stages == [Stage("simulating scenes", done, 3) for done in (1, 2, 3)]
