"""Looking up objects by identifier within a scene, for whole batches at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from relforest.scenes.arrays import IntArray
from relforest.scenes.arrow import ArrowArray, is_text
from relforest.scenes.columns import Codes, listed
from relforest.scenes.ids import IdArray, plain
from relforest.support.errors import InputError

_INTEGERS = (r"^-?(0|[1-9]\d{0,14})$", r"^-?(0|[1-9]\d{0,14})\.0$")


@final
@dataclass(frozen=True, slots=True, eq=False)
class ObjectIndex:
    """The objects of all scenes, sorted by scene and identifier code."""

    scene_ids: IdArray  # (n_scenes,)
    object_ids: IdArray  # (k,), by code
    keys: IntArray  # (n_refs,), sorted: scene * k + code
    positions: IntArray  # (n_refs,), where each key stood in the arrays that were indexed

    def find(self, scenes: IntArray, codes: IntArray) -> IntArray:
        """Return the position of the object with each code in each scene, -1 if absent."""
        if not len(self.keys):
            return np.full(len(scenes), -1)
        wanted = scenes * len(self.object_ids) + codes
        nearest = np.minimum(np.searchsorted(self.keys, wanted), len(self.keys) - 1)
        return np.where((codes >= 0) & (self.keys[nearest] == wanted), self.positions[nearest], -1)

    def describe(self, scene: int) -> str:
        """Return the identifiers of one scene's objects, for messages."""
        low, high = np.searchsorted(
            self.keys, [scene * len(self.object_ids), (scene + 1) * len(self.object_ids)]
        )
        ids = self.object_ids[self.keys[low:high] % max(len(self.object_ids), 1)]
        return listed(ids.tolist()) or "none"


def index_objects(scene_ids: IdArray, scenes: IntArray, objects: Codes) -> ObjectIndex:
    """Index objects by their scenes (n_refs,) and their identifiers (n_refs,), which are not null.

    Raises
    ------
    InputError
        If two objects of a scene have the same identifier.
    """
    keys = scenes * len(objects) + objects.codes
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    twice = np.flatnonzero(keys[1:] == keys[:-1])
    if twice.size:
        scene, code = divmod(int(keys[twice[0]]), len(objects))
        raise InputError(
            f"object {plain(objects.ids[code])!r} occurs twice in scene {plain(scene_ids[scene])!r}: the "
            "ids of a scene's objects must differ"
        )
    return ObjectIndex(scene_ids, objects.ids, keys, order)


def bind_arguments(index: ObjectIndex, parameter: str, values: ArrowArray) -> IntArray:
    """Return the position of the object that each scene binds to one parameter, -1 where the value is null.

    The values are identifiers from `id_column`, one per scene.

    Raises
    ------
    InputError
        If a value is not the identifier of an object of its scene.
    """
    codes = places_of(values, index.object_ids)
    positions = index.find(np.arange(len(codes)), codes)
    unbound = np.flatnonzero((positions < 0) & pc.is_valid(values).to_numpy(zero_copy_only=False))
    if unbound.size:
        scene = int(unbound[0])
        raise InputError(
            f"argument {parameter!r} of scene {plain(index.scene_ids[scene])!r} is "
            f"{values[scene].as_py()!r}, which is not an object of that scene (it has "
            f"{index.describe(scene)}): use the id of one of them, or null for none"
        )
    return positions


def places_of(values: ArrowArray, among: IdArray) -> IntArray:
    """Return the place of each identifier from `id_column` among different ones, -1 if it is none of them."""
    ids = pa.array(among, from_pandas=True)
    ids = pc.cast(ids, pa.large_string() if among.dtype == object else pa.int64())
    if values.type != ids.type:
        # Types may differ, as where no argument reveals that ids are strings. As text, 07 is still not 7.
        ids, values = pc.cast(ids, pa.large_string()), pc.cast(values, pa.large_string())
    if is_text(ids.type) and all(map(_are_integers, (ids, values))):
        ids, values = (pc.replace_substring(texts, ".0", "") for texts in (ids, values))
    places: IntArray = pc.fill_null(pc.cast(pc.index_in(values, value_set=ids), pa.int64()), -1).to_numpy(
        zero_copy_only=False
    )
    return places


def _are_integers(texts: ArrowArray) -> bool:
    """Return whether all texts are integers, or all with the ``.0`` that pandas adds if one is missing."""
    return any(pc.all(pc.match_substring_regex(texts, pattern)).as_py() for pattern in _INTEGERS)
