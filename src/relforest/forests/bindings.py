"""All choices of objects for the free variables of a batch of scenes, and the columns' values for them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from relforest.mappings import Related
from relforest.scenes.arrays import gather, occurrences

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
        of at most so many, in which related pairs come first: there are few of them among many objects.
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
    related: dict[int, NDArray[np.int64]] = {}
    if n_free == 2 and len(scenes.pairs) and (drawn < counts).any():
        related = _related_choices(scenes, is_free)
    kept = np.concatenate(
        [
            np.arange(size) if size == total else _sample(total, size, related.get(number), rng)
            for number, (size, total) in enumerate(zip(drawn.tolist(), counts.tolist(), strict=True))
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


def _related_choices(scenes: Scenes, is_free: NDArray[np.bool_]) -> dict[int, NDArray[np.int64]]:
    """Return for each scene the numbers of those choices of two free objects that are related."""
    starts = np.cumsum(scenes.counts) - scenes.counts
    before = np.concatenate([[0], np.cumsum(is_free)])
    first, second, _ = occurrences(scenes.parts)
    both = is_free[first] & is_free[second]
    scene = np.searchsorted(starts, first[both], "right") - 1
    n = before[starts + scenes.counts] - before[starts]
    one, other = (before[place[both]] - before[starts[scene]] for place in (first, second))
    choice = one * (n[scene] - 1) + other - (other > one)
    return {int(each): np.unique(choice[scene == each]) for each in np.unique(scene)}


def _sample(
    total: int, size: int, first: NDArray[np.int64] | None, rng: np.random.Generator
) -> NDArray[np.int64]:
    """Return `size` of so many numbers, ascending; those of `first` come before others."""
    if first is None:
        return np.sort(rng.choice(total, size, replace=False))
    if len(first) >= size:
        return np.sort(rng.choice(first, size, replace=False))
    others = np.setdiff1d(np.arange(total), first)
    return np.sort(np.append(first, rng.choice(others, size - len(first), replace=False)))


def column_values(scenes: Scenes, columns: tuple[Column, ...], choices: Bindings) -> NDArray[np.float64]:
    """Return the value of every column for every choice, (n_columns, n_choices), NaN where undefined."""
    rows, scene = choices.rows, np.repeat(np.arange(len(scenes)), np.diff(choices.starts))
    values = np.empty((len(columns), len(rows)))
    mapped: dict[tuple[object, tuple[int, ...]], NDArray[np.float64]] = {}
    for number, column in enumerate(columns):
        key = (column.mapping, column.variables)
        if key not in mapped:
            chosen = np.ascontiguousarray(rows[:, column.variables])
            mapped[key] = (
                column.mapping.evaluate(scenes, chosen, scene)
                if isinstance(column.mapping, Related)
                else column.mapping.evaluate(scenes.schema, scenes.matrix, chosen)
            )
        values[number] = mapped[key][:, column.component]
    return values
