"""A policy of ``smrf-q`` as plain values, and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from numpy.typing import NDArray

from relforest.rl.fitted.forest_arrays import ForestArrays, forests_of
from relforest.rl.fitted.horizon import Horizon, Measured
from relforest.rl.fitted.questions import Question
from relforest.rl.fitted.sum import Sum
from relforest.rl.fitted.value import QValue
from relforest.rl.fitted.view import View
from relforest.runs.store import Checkpoint
from relforest.scenes import Schema
from relforest.smdp import ActionType
from relforest.support.documents import LARGEST_NUMBER, well_formed
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.files import read_npz
from relforest.support.options import between, in_range

KEY: Final = "fitted"
"""What a checkpoint keeps the policy under."""
START: Final = "start"
"""What it keeps the policy under that the run began with."""
FORMAT: Final = "relforest-q-policy"
VERSION: Final = 1
FOREST_FILES: Final = r"forests/iteration-\d{4}\.npz"
"""A regular expression for the names of files with forests."""
_MOST_TYPES: Final = 1000
_MOST_CONDITIONS: Final = 10_000


def describe(value: QValue) -> dict[str, Any]:
    """Return a policy, but for its forests, as plain JSON values."""
    learned = value.learned
    actions = [
        {"name": action_type.name, "parameters": list(action_type.parameters)}
        for action_type in value.action_types
    ]
    document = {"view": value.view.to_dict(), "actions": actions}
    if isinstance(learned, Sum):
        questions = [[question.to_dict() for question in own] for own in learned.questions]
        return document | {
            "sum": {
                "base": learned.base,
                "constants": list(learned.constants),
                "questions": questions,
                "has_trees": learned.trees is not None,
            }
        }
    measured = [[each.to_dict() for each in own] for own in learned.measured]
    return document | {"horizon": {"measured": measured}}


def forest_files(value: QValue | None, iteration: int) -> dict[str, Mapping[str, NDArray[Any]]]:
    """Return the forests of a policy, if it has any, by the name of their file."""
    forests = None if value is None else value.learned.trees
    return {} if forests is None else {_forest_file(iteration): forests._asdict()}


def learned_value(checkpoint: Checkpoint, folder: Path) -> QValue:
    """Return the policy of a run of ``smrf-q``.

    Raises
    ------
    InputError
        If it has not learned anything yet, or is a run of another learner.
    ModelFormatError
        If the policy is damaged.
    """
    if KEY not in checkpoint.document:
        raise InputError(f"{folder} is not a run of smrf-q: give the folder of one")
    if checkpoint.document[KEY] is None:
        raise InputError(f"{folder} has not learned anything yet: wait for its first iteration")
    return value_of(checkpoint.document[KEY], folder, checkpoint.iteration)


def value_of(document: Any, folder: Path, iteration: int) -> QValue:  # noqa: ANN401 - not checked yet
    """Return the policy of an iteration from what `describe` and `forest_files` returned.

    Raises
    ------
    ModelFormatError
        If it is not such a document, or the file with its forests is missing or damaged.
    """
    with well_formed(f"the policy in {folder} is damaged"):
        view = View.from_dict(document["view"])
        if not isinstance(document["actions"], list) or len(document["actions"]) > _MOST_TYPES:
            raise ModelFormatError(f"actions must be a list of at most {_MOST_TYPES}")
        types = tuple(ActionType(each["name"], tuple(each["parameters"])) for each in document["actions"])
        schemas = view.schemas(types)
        if "sum" in document:
            return QValue(view, types, _sum(document["sum"], schemas, folder / _forest_file(iteration)))
        measured = tuple(
            tuple(Measured.from_dict(each, schema) for each in own)
            for own, schema in zip(document["horizon"]["measured"], schemas, strict=True)
        )
        widths = [sum(1 + (each.condition.n_free > 0) for each in own) + 1 for own in measured]
        trees = _forests(folder / _forest_file(iteration), widths)
        return QValue(view, types, Horizon(schemas, measured, trees))


def _sum(document: Any, schemas: tuple[Schema, ...], path: Path) -> Sum:  # noqa: ANN401 - not checked yet
    base, constants = document["base"], document["constants"]
    if base is not None:
        base = between("base", base, 0, len(schemas) - 1)
    questions = tuple(
        tuple(Question.from_dict(each, schema) for each in own)
        for own, schema in zip(document["questions"], schemas, strict=True)
    )
    if len(constants) != len(schemas) or any(len(own) > _MOST_CONDITIONS for own in questions):
        raise ModelFormatError("each action type needs a constant and a list of questions")
    numbers = tuple(float(in_range("constant", each, -LARGEST_NUMBER, LARGEST_NUMBER)) for each in constants)
    trees = _forests(path, [len(own) for own in questions]) if document["has_trees"] else None
    return Sum(schemas, base, numbers, questions, trees)


def _forests(path: Path, widths: Sequence[int]) -> ForestArrays:
    return forests_of(read_npz(path, ForestArrays._fields), widths, origin=str(path))


def _forest_file(iteration: int) -> str:
    return f"forests/iteration-{iteration:04d}.npz"
