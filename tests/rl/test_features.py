from __future__ import annotations

import numpy as np

from relforest.rl.features import forest_features
from relforest.scenes import Scenes
from rl.small_worlds import SCHEMA, near


def scenes_at(*locations: float) -> Scenes:
    """One scene per location, with one object and no arguments."""
    numbers = np.arange(len(locations))
    return Scenes(SCHEMA, np.array(locations)[:, None], numbers, numbers, np.ones_like(numbers))


def test_a_forest_has_a_bias_first() -> None:
    trees, scenes = [near(SCHEMA), near(SCHEMA, mean=0.8)], scenes_at(0.35, 0.75)
    assert forest_features(trees, scenes, "bits").tolist() == [
        [1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
        [1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0],
    ]
    assert forest_features([], scenes, "bits").tolist() == [[1.0], [1.0]]
