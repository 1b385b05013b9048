"""All choices of objects for the free variables of a batch of scenes, and the columns' values for them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.forests.columns import Column
    from relforest.scenes import Scenes


class Bindings(NamedTuple):
    """The choices of objects, scene by scene.

    Parameters
    ----------
    rows : int64 ndarray (n_choices, n_arguments + n_free)
        Rows of ``scenes.matrix``, -1 = no object.
    starts : int64 ndarray (n_scenes + 1,)
        Where the choices of each scene begin.
    """

    rows: NDArray[np.int64]
    starts: NDArray[np.int64]


def bindings(scenes: Scenes, n_free: int, *, most: int, rng: np.random.Generator) -> tuple[Bindings, int]:
    """Return the choices of `n_free` free variables, and the number of scenes where only some were drawn.

    Parameters
    ----------
    scenes : Scenes
    n_free : int
        0, 1 or 2.
    most : int
        Most choices on average per scene. Where there are more in total, every scene keeps a random sample
        of at most so many.
    rng : Generator
    """
    free = np.maximum(scenes.counts - _n_distinct(scenes.arguments), 0)
    counts = [np.ones_like(free), free, free * np.maximum(free - 1, 0)][n_free]
    drawn = counts
    if counts.sum() > most * len(scenes):
        drawn = np.minimum(counts, most)
    starts = np.concatenate([[0], np.cumsum(drawn)])
    rows = np.full((starts[-1], scenes.arguments.shape[1] + n_free), -1, dtype=np.int64)
    table = (scenes.rows, scenes.starts, scenes.counts, scenes.arguments)
    kept = np.concatenate(
        [
            np.arange(n) if n == total else np.sort(rng.choice(total, n, replace=False))
            for n, total in zip(drawn.tolist(), counts.tolist(), strict=True)
        ]
        or [np.empty(0)]
    ).astype(np.int64)
    _fill(table, n_free, starts, kept, rows)
    return Bindings(rows, starts), int(np.count_nonzero(drawn < counts))


def column_values(
    scenes: Scenes, columns: tuple[Column, ...], rows: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the value of every column for every choice, (n_columns, n_choices), NaN where undefined."""
    values = np.empty((len(columns), len(rows)))
    mapped: dict[tuple[object, tuple[int, ...]], NDArray[np.float64]] = {}
    for number, column in enumerate(columns):
        key = (column.mapping, column.variables)
        if key not in mapped:
            chosen = np.ascontiguousarray(rows[:, column.variables])
            mapped[key] = column.mapping.evaluate(scenes.schema, scenes.matrix, chosen)
        values[number] = mapped[key][:, column.component]
    return values


def _n_distinct(arguments: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return how many objects are arguments of each scene."""
    ordered = np.sort(arguments, axis=1)
    new = np.ones(ordered.shape, dtype=np.bool_)
    new[:, 1:] = ordered[:, 1:] != ordered[:, :-1]
    return np.asarray(np.count_nonzero(new & (ordered >= 0), axis=1))


@kernel
def _fill(
    scenes: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]],
    n_free: int,
    starts: NDArray[np.int64],
    kept: NDArray[np.int64],
    rows: NDArray[np.int64],
) -> None:
    """Write the rows of the choices with the numbers `kept` of each scene."""
    objects, first, counts, arguments = scenes
    n_arguments = arguments.shape[1]
    free = np.empty(max(counts.max(), 1), dtype=np.int64)
    for scene in range(len(first)):
        n = 0
        for place in range(counts[scene]):
            row, is_free = objects[first[scene] + place], True
            for k in range(n_arguments):
                is_free &= arguments[scene, k] != row
            if is_free:
                free[n] = row
                n += 1
        for choice in range(starts[scene], starts[scene + 1]):
            for k in range(n_arguments):
                rows[choice, k] = arguments[scene, k]
            if n_free == 1:
                rows[choice, n_arguments] = free[kept[choice]]
            elif n_free == 2:
                one, other = kept[choice] // (n - 1), kept[choice] % (n - 1)
                rows[choice, n_arguments] = free[one]
                rows[choice, n_arguments + 1] = free[other + (1 if other >= one else 0)]
