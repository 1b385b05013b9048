"""Instantiation sequences at a leaf, scene by scene."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, final

import numpy as np

from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.scenes import Scenes

# A table of so many times as many numbers as there are sequences is still faster than sorting them.
_TABLE: Final = 64


@final
@dataclass(frozen=True, slots=True, eq=False)
class Sequences:
    """Instantiation sequences of one leaf."""

    scene: NDArray[np.int64]  # (n,) the scene of each sequence, ascending
    objects: NDArray[np.int64]  # (n, depth) the bound objects, by position in the scene; -1 = no object
    ratio: float = 1.0
    """How many sequences each of them stands for on average: above 1, they are a sample of the leaf's."""

    @classmethod
    def empty(cls, n_scenes: int) -> Sequences:
        """Return one sequence without objects per scene, as at the root."""
        return cls(np.arange(n_scenes), np.empty((n_scenes, 0), dtype=np.int64))

    @property
    def depth(self) -> int:
        """Number of variables bound."""
        return int(self.objects.shape[1])

    @property
    def scenes(self) -> NDArray[np.int64]:
        """The scenes that have sequences, ascending."""
        return self.scene[np.flatnonzero(np.diff(self.scene, prepend=-1))]

    def __len__(self) -> int:
        """Number of sequences."""
        return len(self.scene)

    def where(self, kept: NDArray[np.bool_]) -> Sequences:
        """Return the sequences for which `kept` (n,) is true."""
        return Sequences(self.scene[kept], self.objects[kept], self.ratio)

    def extended(self, counts: NDArray[np.int64], arguments: NDArray[np.int64]) -> Sequences:
        """Return the sequences with one more variable bound.

        Parameters
        ----------
        counts : (n_scenes,) int64
            Objects per scene.
        arguments : (n_scenes, k) int64
            Positions of the action arguments in their scenes, -1 = none. The first k variables are bound
            to them (section 6.2); later ones to every object not yet in the sequence, or to "no
            object" if there is none.
        """
        n = int(n_extensions(self.scene, self.objects, counts, arguments, 1))
        scene = np.empty(n, dtype=np.int64)
        objects = np.empty((n, self.depth + 1), dtype=np.int64)
        _extend((self.scene, self.objects), counts, arguments, scene, objects)
        return Sequences(scene, objects, self.ratio)

    def drawn(
        self,
        counts: NDArray[np.int64],
        arguments: NDArray[np.int64],
        most: int,
        rng: np.random.Generator,
    ) -> Sequences:
        """Return at most `most` sequences with one more variable bound (but at least one per scene).

        Where there would be more, every scene may have the same number; of a scene with more than that,
        one is drawn from each of so many equal parts of its sequences in order, so that each of them is
        equally likely to be drawn.
        """
        n = n_extensions(self.scene, self.objects, counts, arguments, 1)
        if n <= most:
            return self.extended(counts, arguments)
        n_scenes = len(self.scenes)
        uniform = rng.random((n_scenes, max(most // n_scenes, 1)))
        scene = np.empty(uniform.size, dtype=np.int64)
        objects = np.empty((uniform.size, self.depth + 1), dtype=np.int64)
        drawn = _draw((self.scene, self.objects), counts, arguments, uniform, scene, objects)
        return Sequences(scene[:drawn], objects[:drawn], self.ratio * n / drawn)

    def distinct(self, variables: tuple[int, ...]) -> Sequences:
        """Return the distinct tuples of `variables` in each scene, in order of position."""
        if len(variables) == self.depth:
            return Sequences(self.scene, self.objects.take(variables, axis=1))
        scene = np.empty(len(self), dtype=np.int64)
        objects = np.empty((len(self), len(variables)), dtype=np.int64)
        n = _distinct((self.scene, self.objects), np.array(variables, dtype=np.int64), scene, objects)
        return Sequences(scene[:n], objects[:n])


def argument_places(scenes: Scenes) -> NDArray[np.int64]:
    """Return the position of every action argument in its scene, (n_scenes, k); -1 = none."""
    places = np.full(scenes.arguments.shape, -1, dtype=np.int64)
    _find_places((scenes.rows, scenes.starts, scenes.counts), scenes.arguments, places)
    return places


def rows_of(scenes: Scenes, sequences: Sequences) -> NDArray[np.int64]:
    """Return the object rows (n, depth) of sequences, -1 = no object."""
    places = scenes.starts[sequences.scene][:, None] + sequences.objects
    if len(scenes.rows) == 0:
        return np.full(places.shape, -1, dtype=np.int64)
    missing = sequences.objects < 0
    return np.where(missing, -1, scenes.rows[np.where(missing, 0, places)])


@kernel
def n_extensions(
    scene: NDArray[np.int64],
    objects: NDArray[np.int64],
    counts: NDArray[np.int64],
    arguments: NDArray[np.int64],
    n_new: int,
) -> float:
    """How many sequences there are with `n_new` more variables: all arguments, or none of them."""
    depth = objects.shape[1]
    if depth < arguments.shape[1]:
        return float(len(scene))
    total, product = 0.0, 0.0
    for i in range(len(scene)):
        # All sequences of a scene bind equally many objects.
        if i == 0 or scene[i] != scene[i - 1]:
            free = counts[scene[i]]
            for j in range(depth):
                free -= _is_new(objects, i, j)
            product = 1.0
            for step in range(n_new):
                product *= max(free - step, 1)
        total += product
    return total


@kernel
def _is_new(objects: NDArray[np.int64], i: int, j: int) -> int:
    """1 if variable j of sequence i holds an object that no earlier variable holds."""
    if objects[i, j] < 0:
        return 0
    for earlier in range(j):
        # Two arguments of an action may be the same object.
        if objects[i, earlier] == objects[i, j]:
            return 0
    return 1


@kernel
def _extend(
    sequences: tuple[NDArray[np.int64], NDArray[np.int64]],
    counts: NDArray[np.int64],
    arguments: NDArray[np.int64],
    new_scene: NDArray[np.int64],
    new_objects: NDArray[np.int64],
) -> None:
    scene, objects = sequences
    depth = objects.shape[1]
    n = 0
    for i in range(len(scene)):
        first = n
        if depth < arguments.shape[1]:
            new_objects[n, depth] = arguments[scene[i], depth]
            n += 1
        else:
            for place in range(counts[scene[i]]):
                repeated = False
                for j in range(depth):
                    repeated |= objects[i, j] == place
                if not repeated:
                    new_objects[n, depth] = place
                    n += 1
            if n == first:
                new_objects[n, depth] = -1
                n += 1
        for k in range(first, n):
            new_scene[k] = scene[i]
            for j in range(depth):
                new_objects[k, j] = objects[i, j]


@kernel
def _draw(
    sequences: tuple[NDArray[np.int64], NDArray[np.int64]],
    counts: NDArray[np.int64],
    arguments: NDArray[np.int64],
    uniform: NDArray[np.float64],
    new_scene: NDArray[np.int64],
    new_objects: NDArray[np.int64],
) -> int:
    """Draw extensions with the numbers of a row of `uniform` for each scene; how many in all."""
    scene, objects = sequences
    depth = objects.shape[1]
    n, begin, row = 0, 0, 0
    while begin < len(scene):
        end = begin
        while end < len(scene) and scene[end] == scene[begin]:
            end += 1
        # All sequences of a scene bind equally many objects.
        free = counts[scene[begin]]
        for j in range(depth):
            free -= _is_new(objects, begin, j)
        choices = 1 if depth < arguments.shape[1] else max(free, 1)
        total = (end - begin) * choices
        size = min(total, uniform.shape[1])
        for i in range(size):
            chosen = i if size == total else min(int((i + uniform[row, i]) * (total / size)), total - 1)
            source = begin + chosen // choices
            for j in range(depth):
                new_objects[n, j] = objects[source, j]
            if depth < arguments.shape[1]:
                new_objects[n, depth] = arguments[scene[begin], depth]
            else:
                new_objects[n, depth] = _free_object(objects[source], chosen % choices) if free > 0 else -1
            new_scene[n] = scene[begin]
            n += 1
        begin = end
        row += 1
    return n


@kernel
def _free_object(bound: NDArray[np.int64], number: int) -> int:
    """Return the object that has so many others before it, not counting those that are bound."""
    place = -1
    while number >= 0:
        place += 1
        is_free = True
        for other in bound:
            is_free &= other != place
        number -= is_free
    return place


@kernel
def _distinct(
    sequences: tuple[NDArray[np.int64], NDArray[np.int64]],
    variables: NDArray[np.int64],
    scene: NDArray[np.int64],
    objects: NDArray[np.int64],
) -> int:
    """Write the distinct tuples of some variables into `scene` and `objects`; how many there are."""
    scenes, bound = sequences
    base, n_scenes, n_numbers = 1, 0, 1.0
    for i in range(len(scenes)):
        n_scenes += i == 0 or scenes[i] != scenes[i - 1]
        for variable in variables:
            base = max(base, bound[i, variable] + 2)
    for _ in variables:
        n_numbers *= base
    size = n_numbers if n_numbers * n_scenes <= _TABLE * len(scenes) else 0.0
    seen = np.zeros(8 * int(np.ceil(size / 8.0)), dtype=np.uint8)
    table = (seen, seen.view(np.uint64), np.empty(len(seen), dtype=np.int64))
    n, begin = 0, 0
    while begin < len(scenes):
        end = begin
        while end < len(scenes) and scenes[end] == scenes[begin]:
            end += 1
        chosen = _first_of_each(bound[begin:end], variables, base, table)
        for i in chosen:
            scene[n] = scenes[begin]
            for j in range(len(variables)):
                objects[n, j] = bound[begin + i, variables[j]]
            n += 1
        begin = end
    return n


@kernel
def _first_of_each(
    objects: NDArray[np.int64],
    variables: NDArray[np.int64],
    base: int,
    table: tuple[NDArray[np.uint8], NDArray[np.uint64], NDArray[np.int64]],
) -> NDArray[np.int64]:
    """Return a sequence of one scene for each distinct tuple, in order of the tuples.

    `table` says for every number below `base` ** arity whether it was seen, the same for eight numbers at
    once, and in which sequence; it is left as it was found, and empty if sorting is faster.
    """
    seen, eight, where = table
    n = len(objects)
    keys = np.zeros(n, dtype=np.int64)
    for i in range(n):
        for variable in variables:
            keys[i] = keys[i] * base + objects[i, variable] + 1
    chosen, kept = np.empty(n, dtype=np.int64), 0
    if len(seen) == 0:
        order = np.argsort(keys)
        for i in range(n):
            if i == 0 or keys[order[i]] != keys[order[i - 1]]:
                chosen[kept] = order[i]
                kept += 1
        return chosen[:kept]
    for i in range(n):
        seen[keys[i]] = 1
        where[keys[i]] = i
    for group in range(len(eight)):
        if eight[group] == 0:
            continue
        for key in range(8 * group, 8 * group + 8):
            if seen[key]:
                chosen[kept] = where[key]
                kept += 1
        eight[group] = 0
    return chosen[:kept]


@kernel
def _find_places(
    scenes: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]],
    arguments: NDArray[np.int64],
    places: NDArray[np.int64],
) -> None:
    rows, starts, counts = scenes
    for i in range(len(starts)):
        for j in range(arguments.shape[1]):
            for place in range(counts[i]):
                if rows[starts[i] + place] == arguments[i, j]:
                    places[i, j] = place
