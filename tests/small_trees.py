"""Scenes and trees small enough to be worked out by hand."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from relforest.mappings import Mapping
from relforest.scenes import Attribute, Scenes, Schema
from relforest.trees import Instantiation, Leaf, Question, Tree
from relforest.volumes import Ellipsoid

LOCATION = Attribute("location", 2)
Place = tuple[float, float]
NOWHERE: Place = (np.nan, np.nan)


def plane(*parameters: str, operations: Sequence[str] | None = None) -> Schema:
    """Schema of a location."""
    return Schema((Attribute("location", 2, operations=operations),), parameters)


def scenes_in(
    schema: Schema, places: Sequence[Sequence[Place]], arguments: Sequence[Sequence[int]] = ()
) -> Scenes:
    """Scenes of objects with a location; arguments are positions within the scene, -1 = none."""
    counts = np.array([len(scene) for scene in places], dtype=np.int64)
    starts = np.cumsum(counts) - counts
    matrix = np.array([place for scene in places for place in scene], dtype=np.float64).reshape(-1, 2)
    bound = np.array(arguments, dtype=np.int64).reshape(len(places), schema.n_parameters)
    rows = np.where(bound < 0, -1, bound + starts[:, None])
    return Scenes(schema, matrix, np.arange(len(matrix)), starts, counts, rows)


def ball(centre: ArrayLike, radius: float) -> Ellipsoid:
    """A round volume with a density of exp(-distance^2 / 2)."""
    mean = np.array(centre, dtype=np.float64)
    return Ellipsoid(mean, np.eye(len(mean)), radius, 1, 0.0)


def leaf(probability: float) -> Leaf:
    """A leaf whose counts do not matter."""
    return Leaf(probability, 0, 0)


def near_tree(schema: Schema, radius: float = 3.0, probabilities: Sequence[float] = (0.9, 0.1, 0.3)) -> Tree:
    """Is B within a distance of A?"""
    question = Question(Mapping("distance", schema["location"]), (0, 1), ball([0.0], radius), 3, 4, 5)
    return Tree(schema, (Instantiation(1), Instantiation(2), question, *map(leaf, probabilities)))
