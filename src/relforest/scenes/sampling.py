"""Samples of scenes from a source larger than memory, such as one for each tree of a forest."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from relforest.scenes.arrays import SceneArrays
from relforest.scenes.batch import Scenes, scenes_of
from relforest.scenes.scene_stream import SceneColumns, scene_stream
from relforest.support.errors import InputError
from relforest.support.options import at_least
from relforest.support.rng import RandomState, generator, seed_sequence, stream


def sample_scenes(
    source: str | PathLike[str],
    n_samples: int,
    size: int,
    rng: RandomState = None,
    *,
    label: str | None = None,
    **columns: Unpack[SceneColumns],
) -> list[tuple[Scenes, NDArray[Any] | None]]:
    """Draw samples of whole scenes, each uniform, without replacement and independent of the others.

    Parameters
    ----------
    source : path
        As for `relforest.iter_scene_batches`.
    n_samples, size : int
        How many samples, and how many scenes in each.
    rng : int, Generator, RandomState, SeedSequence or None
        Seed. Sample ``i`` depends neither on ``n_samples`` nor on how the source is divided into files.
    label : str, optional
        A column with one value per scene.
    **columns
        As for `relforest.iter_scene_batches`.

    Returns
    -------
    list of (Scenes, (size,) array or None)
        The scenes of each sample in the order of the source, and their labels if a column was named. Samples
        share the object rows of scenes that are in several of them; `Scenes.compact` separates them.

    Raises
    ------
    InputError
        If the source has fewer scenes than ``size``; and as for `relforest.iter_scene_batches`.

    Notes
    -----
    The scenes are counted first, from their ids alone; then the source is read once. Memory is that of the
    scenes drawn, one batch, and 8 bytes per scene of the source.
    """
    at_least("n_samples", n_samples, 1)
    at_least("size", size, 1)
    seed = seed_sequence(rng)
    scenes = scene_stream(source, label, **columns)
    n_scenes = scenes.count()
    if size > n_scenes:
        raise InputError(f"size must be at most the {n_scenes} scenes of {source}, got {size}")
    draws = [
        np.sort(generator(stream(seed, number)).choice(n_scenes, size, replace=False, shuffle=False))
        for number in range(n_samples)
    ]
    wanted = np.unique(np.concatenate(draws))
    kept: list[Scenes] = []
    labels: list[NDArray[Any]] = []
    n_before = 0
    for batch in scenes.batches():
        begin, end = np.searchsorted(wanted, [n_before, n_before + len(batch.scenes)])
        if begin < end:
            chosen = wanted[begin:end] - n_before
            kept.append(batch.scenes.take(chosen).compact())
            labels += [] if batch.labels is None else [batch.labels[chosen]]
        n_before += len(batch.scenes)
    together = _together(kept)
    values = np.concatenate(labels) if labels else None
    places = (np.searchsorted(wanted, draw) for draw in draws)
    return [(together.take(place), None if values is None else values[place]) for place in places]


def _together(batches: Sequence[Scenes]) -> Scenes:
    """Return the scenes of several batches as one batch."""
    parts = []
    n_rows = n_refs = 0
    for batch in batches:
        shifted = batch.parts._replace(
            rows=batch.rows + n_rows,
            starts=batch.starts + n_refs,
            arguments=np.where(batch.arguments < 0, -1, batch.arguments + n_rows),
            pairs=batch.pairs + np.array([0, n_rows, n_rows]),
        )
        parts.append(shifted[1:])
        n_rows += len(batch.matrix)
        n_refs += len(batch.rows)
    together = SceneArrays(batches[0].schema, *map(np.concatenate, zip(*parts, strict=True)))
    by_relation = np.argsort(together.pairs[:, 0], kind="stable")
    return scenes_of(together._replace(pairs=together.pairs[by_relation]))
