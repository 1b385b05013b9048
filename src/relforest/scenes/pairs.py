"""Which object rows stand in which relation: one sorted array, in which a pair is found by bisection."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes.ids import plain
from relforest.support.errors import InputError
from relforest.support.jit import kernel

if TYPE_CHECKING:
    from collections.abc import Sequence

    from relforest.scenes.arrays import SceneArrays

NO_PAIRS: Final[NDArray[np.int64]] = np.empty((0, 3), dtype=np.int64)
NO_PAIRS.flags.writeable = False


def with_pairs(parts: SceneArrays, given: Sequence[NDArray[np.int64]]) -> SceneArrays:
    """Return the arrays with the pairs of the last relations of their schema, after those that they have.

    Parameters
    ----------
    parts : SceneArrays
    given : sequence of (n, 3) int64
        For each of these relations scene, first and second object row. Of a relation without direction, each
        pair in one order, or all pairs in both.

    Raises
    ------
    InputError
        If an object is related to itself, a pair is given twice in a scene, or only some pairs of a relation
        without direction are given in both orders.
    """
    relations, pairs = parts.schema.relations, [parts.pairs]
    for number, own in enumerate(given, start=len(relations) - len(given)):
        _check_different(parts, relations[number].name, own)
        found = np.unique(own[:, 1:], axis=0)
        if not relations[number].directed:
            found, n_times = np.unique(np.concatenate([found, found[:, ::-1]]), axis=0, return_counts=True)
            if len(found) and n_times.min() < n_times.max():
                once = [_name(parts, row) for row in found[n_times == 1][0]]
                name = relations[number].name
                raise InputError(
                    f"relation {name!r} names some pairs in both orders, but that of {once[0]} and {once[1]} "
                    "in one: name all pairs once, or all in both orders, or declare it as "
                    f"Relation({name!r}, directed=True)"
                )
        pairs.append(np.column_stack([np.full(len(found), number), found]))
    return parts._replace(pairs=np.concatenate(pairs))


@kernel
def is_related(pairs: NDArray[np.int64], relation: int, first: int, second: int) -> bool:
    """Return whether the sorted pairs (n, 3) contain this one."""
    low, high = 0, len(pairs)
    while low < high:
        middle = (low + high) // 2
        a, b, c = pairs[middle, 0], pairs[middle, 1], pairs[middle, 2]
        if a < relation or (a == relation and (b < first or (b == first and c < second))):
            low = middle + 1
        else:
            high = middle
    return bool(
        low < len(pairs) and pairs[low, 0] == relation and pairs[low, 1] == first and pairs[low, 2] == second
    )


@kernel
def are_related(
    pairs: NDArray[np.int64], relation: int, rows: NDArray[np.int64], out: NDArray[np.float64]
) -> None:
    """Write for each two object rows (n, 2) whether they are related, NaN where one is no object (-1)."""
    for i in range(len(rows)):
        out[i] = np.nan
        if rows[i, 0] >= 0 and rows[i, 1] >= 0:
            out[i] = 1.0 if is_related(pairs, relation, rows[i, 0], rows[i, 1]) else 0.0


def _check_different(parts: SceneArrays, name: str, given: NDArray[np.int64]) -> None:
    def said(pair: NDArray[np.int64]) -> str:
        where = f"relation {name!r} of scene {plain(parts.scene_ids[pair[0]])!r}"
        return f"{where} names {_name(parts, pair[1])} and {_name(parts, pair[2])}"

    alone = given[given[:, 1] == given[:, 2]]
    if len(alone):
        raise InputError(f"{said(alone[0])}, the same one: name two objects")
    different, n_times = np.unique(given, axis=0, return_counts=True)
    if len(different) < len(given):
        raise InputError(f"{said(different[n_times > 1][0])} twice: name each pair once")


def _name(parts: SceneArrays, row: int) -> str:
    return f"object {plain(parts.object_ids[row])!r}"
