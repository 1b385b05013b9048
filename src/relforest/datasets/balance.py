"""Rejection sampling: as many positive as negative scenes, whatever the share among those drawn.

Letters: m candidate scenes, n the largest number of objects of one of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes import Scenes, Schema
from relforest.support.errors import InputError
from relforest.support.options import at_least

_MOST_BATCHES: Final = 1000


@final
@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """Scenes as one padded array."""

    objects: NDArray[np.float64]  # (m, n, width)
    counts: NDArray[np.int64]  # (m,)
    labels: NDArray[np.bool_]  # (m,)


def is_object(counts: NDArray[np.int64], n: int) -> NDArray[np.bool_]:
    """Return (m, n) bool: the slots of a padded array that hold an object."""
    holds: NDArray[np.bool_] = np.arange(n) < counts[:, np.newaxis]
    return holds


def balanced(rng: np.random.Generator, n_scenes: int, draw: Callable[[int], Candidates]) -> Candidates:
    """Draw candidates until ``n_scenes // 2`` are positive and the others negative; their order is random.

    A call of `draw` returns the given number of candidates, all with the same padding.

    Raises
    ------
    InputError
        If ``n_scenes`` is less than 2, or one of the labels is too rare.
    """
    n_scenes = at_least("n_scenes", n_scenes, 2)
    labels = np.arange(n_scenes) < n_scenes // 2
    rng.shuffle(labels)
    wanted = {True: np.flatnonzero(labels), False: np.flatnonzero(~labels)}
    first = draw(n_scenes)
    objects, counts = np.empty_like(first.objects), np.empty_like(first.counts)
    batch = first
    for _ in range(_MOST_BATCHES):
        for label, places in wanted.items():
            found = np.flatnonzero(batch.labels == label)[: len(places)]
            filled, wanted[label] = places[: len(found)], places[len(found) :]
            objects[filled], counts[filled] = batch.objects[found], batch.counts[found]
        if not len(wanted[True]) and not len(wanted[False]):
            return Candidates(objects, counts, labels)
        batch = draw(n_scenes)
    missing = "positive" if len(wanted[True]) else "negative"
    raise InputError(
        f"too few of {_MOST_BATCHES * n_scenes} drawn scenes are {missing}: choose another n_objects"
    )


def to_scenes(schema: Schema, candidates: Candidates) -> tuple[Scenes, NDArray[np.bool_]]:
    """Return the candidates as a batch, with labels; the first objects of a scene are its arguments."""
    counts = candidates.counts
    matrix = candidates.objects[is_object(counts, candidates.objects.shape[1])]
    starts = np.cumsum(counts) - counts
    arguments = starts[:, np.newaxis] + np.arange(len(schema.parameters))
    scenes = Scenes(schema, matrix, np.arange(len(matrix)), starts, counts.copy(), arguments)
    return scenes, candidates.labels
