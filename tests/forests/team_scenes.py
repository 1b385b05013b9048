"""Scenes of objects of three teams at random places, and what may be learned of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from forest_scenes import TEAM
from relforest.scenes import Attribute, Scenes, Schema

SCHEMA = Schema([Attribute("location", 2), TEAM])


def scenes_of(rng: np.random.Generator, n: int, n_objects: int = 4) -> Scenes:
    """Objects at random places in a square of side 10, of random teams."""
    matrix = np.column_stack([rng.uniform(0, 10, (n * n_objects, 2)), rng.integers(0, 3, n * n_objects)])
    starts = np.arange(n) * n_objects
    return Scenes(SCHEMA, matrix, np.arange(len(matrix)), starts, np.full(n, n_objects))


def guest_on_the_left(scenes: Scenes) -> NDArray[np.bool_]:
    """Is there an object of team guest with x at most 3?"""
    found = (scenes.matrix[:, 0] <= 3) & (scenes.matrix[:, 2] == 1)
    return np.array([found[scenes.objects(scene)].any() for scene in range(len(scenes))])


def nearest(scenes: Scenes) -> NDArray[np.float64]:
    """Distance between the two nearest objects of each scene."""
    distances = []
    for scene in range(len(scenes)):
        places = scenes.matrix[scenes.objects(scene), :2]
        gaps = np.linalg.norm(places[:, None] - places[None], axis=-1)
        distances.append(gaps[np.triu_indices(len(places), 1)].min())
    return np.array(distances)
