"""Batches of experience as files of a run, one for each iteration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from numpy.typing import NDArray

from relforest.rl.experience import COLUMNS, OPTIONAL_COLUMNS, Experience
from relforest.scenes import Schema
from relforest.smdp import ActionType
from relforest.support.errors import ModelFormatError
from relforest.support.files import read_npz

_FOLDER: Final = "experience"
EXPERIENCE_FILES: Final = rf"{_FOLDER}/iteration-\d{{4}}\.npz"
"""A regular expression for their names."""


def experience_files(batches: Sequence[Experience]) -> dict[str, Mapping[str, NDArray[Any]]]:
    """Return batches of the iterations from 1, by the names of their files within the folder of a run."""
    return {_name(number): batch.arrays() for number, batch in enumerate(batches, start=1)}


def read_experience(
    folder: Path, iterations: int, schema: Schema, action_types: Sequence[ActionType]
) -> tuple[Experience, ...]:
    """Return the batches of the iterations from 1 of a run in a folder.

    Raises
    ------
    ModelFormatError
        If a file is missing or malformed, or does not fit the attributes or action types.
    """
    arity = max((action_type.arity for action_type in action_types), default=0)
    batches = []
    for number in range(1, iterations + 1):
        path = folder / _name(number)
        batch = Experience.from_arrays(read_npz(path, COLUMNS, optional=OPTIONAL_COLUMNS), origin=str(path))
        fits = batch.matrix.shape[1] == schema.width and batch.arguments.shape[1] == arity
        if not fits or batch.types.max(initial=0) >= len(action_types):
            raise ModelFormatError(f"{path} belongs to a different world than the checkpoint beside it")
        batches.append(batch)
    return tuple(batches)


def _name(number: int) -> str:
    return f"{_FOLDER}/iteration-{number:04d}.npz"
