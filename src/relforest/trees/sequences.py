"""Instantiation sequences at a leaf, scene by scene."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.scenes import Scenes


@final
@dataclass(frozen=True, slots=True, eq=False)
class Sequences:
    """Instantiation sequences of one leaf.

    Parameters
    ----------
    scene : int64 ndarray (n,)
        The scene of each sequence, ascending.
    objects : int64 ndarray (n, depth)
        The bound objects, by position in the scene; -1 = no object.
    """

    scene: NDArray[np.int64]
    objects: NDArray[np.int64]

    @classmethod
    def empty(cls, n_scenes: int) -> Sequences:
        """Return one sequence without objects per scene, as at the root."""
        return cls(np.arange(n_scenes), np.empty((n_scenes, 0), dtype=np.int64))

    @property
    def depth(self) -> int:
        """Number of variables bound."""
        return int(self.objects.shape[1])

    def __len__(self) -> int:
        """Number of sequences."""
        return len(self.scene)

    def where(self, kept: NDArray[np.bool_]) -> Sequences:
        """Return the sequences for which `kept` (n,) is true."""
        return Sequences(self.scene[kept], self.objects[kept])

    def extended(self, counts: NDArray[np.int64], arguments: NDArray[np.int64]) -> Sequences:
        """Return the sequences with one more variable bound.

        Parameters
        ----------
        counts : int64 ndarray (n_scenes,)
            Objects per scene.
        arguments : int64 ndarray (n_scenes, k)
            Positions of the action arguments in their scenes, -1 = none. The first k variables are bound
            to them (section 6.2); later ones to every object not yet in the sequence, or to "no
            object" if there is none.
        """
        n = n_extensions(self.scene, self.objects, counts, arguments)
        scene = np.empty(n, dtype=np.int64)
        objects = np.empty((n, self.depth + 1), dtype=np.int64)
        _extend((self.scene, self.objects), counts, arguments, scene, objects)
        return Sequences(scene, objects)

    def distinct(self, variables: tuple[int, ...]) -> Sequences:
        """Return the distinct tuples of `variables` in each scene, in order of position."""
        chosen = self.objects[:, variables]
        if len(variables) == self.depth:
            return Sequences(self.scene, chosen)
        base = int(chosen.max(initial=0)) + 2
        keys = self.scene.copy()
        for column in chosen.T:
            keys = keys * base + (column + 1)
        _, first = np.unique(keys, return_index=True)
        return Sequences(self.scene[first], chosen[first])


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
) -> int:
    """How many sequences `Sequences.extended` would make."""
    depth = objects.shape[1]
    if depth < arguments.shape[1]:
        return len(scene)
    total = 0
    for i in range(len(scene)):
        free = counts[scene[i]]
        for j in range(depth):
            free -= _is_new(objects, i, j)
        total += max(free, 1)
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
