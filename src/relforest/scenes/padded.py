"""Scenes from padded arrays, the form of Gymnasium observations."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from relforest.scenes.arrays import FloatArray, IntArray, SceneArrays
from relforest.scenes.relations import with_pairs
from relforest.scenes.schema import Attribute, Schema
from relforest.support.errors import InputError


def arrays_from_padded(
    observation: Mapping[str, ArrayLike], *, schema: Schema | None, mask: str, arguments: str
) -> SceneArrays:
    """Read scenes from padded arrays; see `Scenes.from_padded`."""
    if mask not in observation:
        raise InputError(
            f"array {mask!r} is missing from {', '.join(map(repr, observation))}: name it with mask="
        )
    present, batched = _read_mask(observation[mask], mask)
    relations = () if schema is None else schema.relations
    slots = {
        name: _read_slots(name, values, present.shape, batched=batched)
        for name, values in observation.items()
        if name not in (mask, arguments, *(relation.name for relation in relations))
    }
    if schema is None:
        schema = Schema([Attribute(name, array.shape[2]) for name, array in slots.items()])
        if arguments in observation:
            raise InputError(f"the array {arguments!r} binds arguments of unknown names: pass schema=")
    _check_slots(schema, slots)
    matrix = np.concatenate([slots[name][present] for name in schema.names], axis=1)
    counts = present.sum(axis=1)
    starts = np.cumsum(counts) - counts
    bound = np.empty((len(present), 0), dtype=np.int64)
    if schema.n_parameters:
        bound = _read_arguments(observation, arguments, schema, present, batched=batched)
    ids = np.broadcast_to(np.arange(present.shape[1]), present.shape)[present]
    parts = SceneArrays(
        schema, matrix, np.arange(len(matrix)), starts, counts, bound, np.arange(len(present)), ids
    )
    return with_pairs(
        parts, [_read_pairs(observation, each.name, present, batched=batched) for each in relations]
    )


def _read_mask(values: ArrayLike, name: str) -> tuple[NDArray[np.bool_], bool]:
    """Return the mask with a batch axis, and whether it had one."""
    array = np.asarray(values)
    if array.ndim not in (1, 2) or not np.isin(array, (0, 1)).all():
        raise InputError(
            f"the mask {name!r} must be 0 or 1 for each slot, shape (n_scenes, n_slots) or (n_slots,), got "
            f"shape {array.shape}"
        )
    batched = array.ndim == 2
    return (array if batched else array[np.newaxis]).astype(np.bool_), batched


def _read_slots(name: str, values: ArrayLike, shape: tuple[int, ...], *, batched: bool) -> FloatArray:
    """Return one attribute as (n_scenes, n_slots, dim)."""
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"the array {name!r} must contain numbers: {error}") from error
    array = array if batched else array[np.newaxis]
    array = array[:, :, np.newaxis] if array.ndim == 2 else array
    if array.ndim != 3 or array.shape[:2] != shape:
        raise InputError(
            f"the array {name!r} must have one entry for each slot of the mask, {shape[0]} scenes of "
            f"{shape[1]} slots, got shape {np.shape(values)}"
        )
    return array


def _check_slots(schema: Schema, slots: Mapping[str, FloatArray]) -> None:
    for name in slots:
        if name not in schema:
            raise InputError(
                f"the array {name!r} is not in the schema, which has {', '.join(map(repr, schema.names))}"
            )
    for attribute in schema.attributes:
        if attribute.name not in slots:
            raise InputError(f"the array of attribute {attribute.name!r} is missing from the observation")
        found = slots[attribute.name].shape[2]
        if found != attribute.dim:
            raise InputError(
                f"the array {attribute.name!r} has {found} components, but the dim is {attribute.dim}"
            )


def _rows(present: NDArray[np.bool_]) -> IntArray:
    """Return the object row of every slot, -1 if it is empty."""
    return np.where(present, np.cumsum(present).reshape(present.shape) - 1, -1)


def _read_pairs(
    observation: Mapping[str, ArrayLike], name: str, present: NDArray[np.bool_], *, batched: bool
) -> IntArray:
    """Return scene and two object rows for each two filled slots that are related, (n, 3)."""
    if name not in observation:
        raise InputError(f"the array of relation {name!r} is missing from the observation")
    array = np.asarray(observation[name])
    array = array if batched else array[np.newaxis]
    if array.shape != (*present.shape, present.shape[1]) or not np.isin(array, (0, 1)).all():
        raise InputError(
            f"the array {name!r} of a relation must be 0 or 1 for each two slots of the mask, shape "
            f"(n_scenes, n_slots, n_slots), got {array.dtype} {np.shape(observation[name])}"
        )
    scene, *slots = np.nonzero(array.astype(np.bool_) & present[:, :, None] & present[:, None, :])
    rows = _rows(present)
    return np.column_stack([scene, *(rows[scene, slot] for slot in slots)])


def _read_arguments(
    observation: Mapping[str, ArrayLike],
    name: str,
    schema: Schema,
    present: NDArray[np.bool_],
    *,
    batched: bool,
) -> IntArray:
    """Turn slot numbers into object rows."""
    if name not in observation:
        raise InputError(
            f"the schema has the arguments {', '.join(schema.parameters)}, but array {name!r} is missing"
        )
    slots = np.asarray(observation[name])
    slots = slots if batched else slots[np.newaxis]
    if slots.shape != (len(present), schema.n_parameters) or slots.dtype.kind not in "iu":
        raise InputError(
            f"the array {name!r} must contain a slot number for each argument, shape ({len(present)}, "
            f"{schema.n_parameters}), got {slots.dtype} {slots.shape}"
        )
    rows = _rows(present)
    # One more, empty slot, for the slot numbers that do not exist.
    rows = np.pad(rows, ((0, 0), (0, 1)), constant_values=-1)
    inside = (slots >= 0) & (slots < present.shape[1])
    bound = np.take_along_axis(rows, np.where(inside, slots, present.shape[1]), axis=1)
    wrong = np.argwhere((bound < 0) & (slots != -1))
    if wrong.size:
        scene, parameter = wrong[0]
        raise InputError(
            f"argument {schema.parameters[parameter]!r} of scene {scene} is slot {slots[scene, parameter]}, "
            "which the mask leaves empty: use the slot of an object, or -1 for none"
        )
    return bound
