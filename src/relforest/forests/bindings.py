"""All choices of objects for the free variables of a batch of scenes, and the columns' values for them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from relforest.scenes.arrays import gather

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.forests.columns import Column
    from relforest.scenes import Scenes


class Bindings(NamedTuple):
    """The choices of objects, scene by scene.

    Parameters
    ----------
    rows : (n_choices, n_arguments + n_free) int64
        Rows of ``scenes.matrix``, -1 = no object.
    starts : (n_scenes + 1,) int64
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
    objects = gather(scenes.rows, scenes.starts, scenes.counts)
    owner = np.repeat(np.arange(len(scenes)), scenes.counts)
    is_free = (objects[:, None] != scenes.arguments[owner]).all(axis=1)
    free, n = objects[is_free], np.bincount(owner[is_free], minlength=len(scenes))
    counts = [np.ones_like(n), n, n * np.maximum(n - 1, 0)][n_free]
    drawn = counts
    if counts.sum() > most * len(scenes):
        drawn = np.minimum(counts, most)
    kept = np.concatenate(
        [
            np.arange(size) if size == total else np.sort(rng.choice(total, size, replace=False))
            for size, total in zip(drawn.tolist(), counts.tolist(), strict=True)
        ]
        or [np.empty(0)]
    ).astype(np.int64)
    scene = np.repeat(np.arange(len(scenes)), drawn)
    first = (np.cumsum(n) - n)[scene]
    chosen = [kept] if n_free == 1 else []
    if n_free == 2:
        one, other = np.divmod(kept, n[scene] - 1)
        chosen = [one, other + (other >= one)]
    rows = np.column_stack([scenes.arguments[scene], *(free[first + each] for each in chosen)])
    starts = np.concatenate([[0], np.cumsum(drawn)])
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
