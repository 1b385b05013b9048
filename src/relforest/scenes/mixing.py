"""Scenes made of those that there are, to see where models differ."""

from __future__ import annotations

from typing import Final

import numpy as np

from relforest.scenes.arrays import IntArray, SceneArrays, gather, occurrences
from relforest.scenes.batch import Scenes, scenes_of

SHARE: Final = 0.5
"""Share of the objects that are exchanged."""


def mixed(scenes: Scenes, n: int, rng: np.random.Generator) -> Scenes:
    """Return scenes drawn from others, in which each object may have turned into one of another scene.

    Arguments and relations belong to the places of the objects, not to their attributes: they stay.

    Parameters
    ----------
    scenes : Scenes
        At least one.
    n : int
        How many to draw, with replacement.
    rng : Generator
    """
    drawn = scenes.take(rng.integers(len(scenes), size=n)).parts
    rows = gather(drawn.rows, drawn.starts, drawn.counts)
    first, second, pair = occurrences(drawn)
    matrix = drawn.matrix[rows]
    is_other = rng.random(len(rows)) < SHARE
    matrix[is_other] = drawn.matrix[rows[rng.integers(len(rows), size=int(is_other.sum()))]]
    pairs = np.column_stack([drawn.pairs[pair, 0], first, second])
    return scenes_of(
        drawn._replace(
            matrix=matrix,
            rows=np.arange(len(rows)),
            starts=np.cumsum(drawn.counts) - drawn.counts,
            arguments=_places(drawn, rows),
            scene_ids=np.arange(n),
            object_ids=np.arange(len(rows)),
            pairs=pairs[np.lexsort(pairs.T[::-1])],
        )
    )


def _places(parts: SceneArrays, rows: IntArray) -> IntArray:
    """Return the places of the arguments among all objects of all scenes, (n_scenes, k), -1 for none."""
    owner, width = np.repeat(np.arange(len(parts.starts)), parts.counts), len(parts.matrix)
    order = np.argsort(owner * width + rows)
    wanted = np.arange(len(parts.starts))[:, None] * width + parts.arguments
    place = np.searchsorted((owner * width + rows)[order], wanted)
    return np.where(parts.arguments >= 0, np.append(order, -1)[place], -1)
