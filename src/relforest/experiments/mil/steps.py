"""Work in numbered steps, done in a process of its own: what is asked for, and what was measured."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any, Final, TypeAlias, final

from relforest.experiments.table import Cell
from relforest.support.errors import ModelFormatError, RunFolderError
from relforest.support.files import read_json, write_json

DONE: Final = "done"
STOPPED: Final = "stopped"
"""The step took more CPU time than allowed."""

_FORMAT: Final = "relforest-mil-steps"
_VERSION: Final = 1


@final
@dataclass(frozen=True, slots=True)
class Task:
    """One step.

    Parameters
    ----------
    run : callable
        The work that is timed and limited.
    judge : callable
        Turns its result into plain values, untimed.
    """

    run: Callable[[], Any]
    judge: Callable[[Any], dict[str, Cell]]


Prepare: TypeAlias = Callable[[Mapping[str, Any]], Callable[[int], Task]]
"""Returns, for what is asked for in plain JSON values, a function from the number of a step to its task."""


@final
@dataclass(frozen=True, slots=True)
class Step:
    """What was measured of a step.

    Parameters
    ----------
    state : str
        `DONE` or `STOPPED`.
    cpu_seconds : float or None
        User and system time of all threads while it ran; None if it was stopped.
    peak_bytes : int
        Largest memory of its process up to its end.
    values : mapping
        What the task was judged to be; empty if it was stopped.
    """

    state: str
    cpu_seconds: float | None
    peak_bytes: int
    values: Mapping[str, Cell] = field(default_factory=dict)


@final
@dataclass(frozen=True, slots=True, eq=False)
class Job:
    """Steps to be done one after the other, and saved one by one.

    Parameters
    ----------
    prepare : callable
        A function of a module.
    asked : mapping
        Its argument.
    n_steps : int
    cpu_limit : float
        CPU seconds of a step.
    file : path
        Where the steps are saved. If some of the same job are there, only the rest is done.
    ends_when_stopped : bool
        Whether a step that was stopped is the last one.
    """

    prepare: Prepare
    asked: Mapping[str, Any]
    n_steps: int
    cpu_limit: float
    file: Path
    ends_when_stopped: bool = True

    def saved(self) -> list[Step]:
        """Return the steps done so far.

        Raises
        ------
        RunFolderError
            If the file is damaged, or of another job.
        """
        if not self.file.exists():
            return []
        remedy = "delete the file to compute it again"
        try:
            document = read_json(self.file, format=_FORMAT, version=_VERSION)
            steps = [_checked(Step(**step)) for step in document["steps"]]
        except (ModelFormatError, KeyError, TypeError) as error:
            raise RunFolderError(f"{self.file} is damaged ({error}); {remedy}") from error
        if document.get("asked") != dict(self.asked) or len(steps) > self.n_steps:
            raise RunFolderError(f"{self.file} belongs to other work; {remedy}")
        return steps

    def save(self, steps: list[Step]) -> None:
        """Save all steps done so far."""
        document = {"format": _FORMAT, "version": _VERSION, "asked": dict(self.asked)}
        write_json(self.file, {**document, "steps": [asdict(step) for step in steps]})

    def is_over(self, steps: list[Step]) -> bool:
        """Whether nothing is left to do after these steps."""
        stopped = self.ends_when_stopped and any(step.state == STOPPED for step in steps)
        return stopped or len(steps) == self.n_steps

    def to_dict(self) -> dict[str, Any]:
        """Return the job as plain JSON values."""
        return {
            "prepare": [self.prepare.__module__, self.prepare.__qualname__],
            "asked": dict(self.asked),
            "n_steps": self.n_steps,
            "cpu_limit": self.cpu_limit,
            "file": str(self.file.absolute()),
            "ends_when_stopped": self.ends_when_stopped,
        }

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> Job:
        """Undo `to_dict`."""
        module, name = document["prepare"]
        prepare: Prepare = getattr(import_module(module), name)
        return cls(**{**document, "prepare": prepare, "file": Path(document["file"])})


def _checked(step: Step) -> Step:
    is_known = step.state in (DONE, STOPPED)
    is_measured = isinstance(step.cpu_seconds, float | int | None) and isinstance(step.peak_bytes, int)
    if not is_known or not is_measured or not isinstance(step.values, Mapping):
        raise TypeError(f"not a step: {step!r:.200}")
    if not all(isinstance(value, str | float | int | None) for value in step.values.values()):
        raise TypeError(f"values that are not plain: {step.values!r:.200}")
    return step
