"""What learns in iterations: a protocol, the progress of a run, and one more iteration of it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter
from typing import Any, ClassVar, Final, Generic, Protocol, TypeAlias, TypeVar, final

from numpy.typing import NDArray

from relforest.support.progress import part

METRIC_NAMES: Final = ("iteration", "test_reward", "train_reward", "trees", "leaves")

Row: TypeAlias = dict[str, Any]
Seconds: TypeAlias = dict[str, float]
Content: TypeAlias = Mapping[str, Any] | Mapping[str, NDArray[Any]]
"""The content of a file: a JSON document, or arrays if its name ends in ``.npz``."""

State = TypeVar("State")


@final
@dataclass(frozen=True, slots=True)
class Snapshot:
    """What a learner knows after an iteration, as plain values.

    Parameters
    ----------
    document : mapping
        Plain JSON values for the checkpoint.
    files : mapping of str to content
        Larger parts, by the name of their file within the folder of the run. A file with the same name has
        the same content in every later snapshot.
    derived : mapping of str to content
        Files for reading, which follow from the rest.
    """

    document: Mapping[str, Any]
    files: Mapping[str, Content]
    derived: Mapping[str, Content] = field(default_factory=dict)


class Learner(Protocol[State]):
    """Something that learns from experience in iterations; a run is a chain of its immutable states.

    Its methods are functions of their arguments: all random numbers come from streams that are named by the
    number of the iteration. So an iteration may be repeated, or computed by another process, with the same
    result.
    """

    files: ClassVar[re.Pattern[str]]
    """Which files within the folder of a run `Snapshot.files` may name."""

    @property
    def configuration(self) -> Mapping[str, Any]:
        """Everything that the result depends on, as plain JSON values."""
        ...

    def start(self) -> State:
        """Return the state before learning."""
        ...

    def iterate(self, state: State, number: int) -> State:
        """Gain experience and learn from it; iterations are numbered from 1."""
        ...

    def evaluate(self, state: State, number: int) -> Row:
        """Return the metrics of an iteration, with the keys `METRIC_NAMES` but for the first."""
        ...

    def to_plain(self, state: State, number: int) -> Snapshot:
        """Return the state after an iteration as plain values."""
        ...

    def from_plain(self, document: Mapping[str, Any], number: int, folder: Path) -> State:
        """Return the state after an iteration, from `Snapshot.document` and the files in a folder.

        Raises
        ------
        ModelFormatError
            If something is missing or malformed.
        """
        ...


@final
@dataclass(frozen=True, slots=True, eq=False)
class Run(Generic[State]):
    """The progress of a run.

    Parameters
    ----------
    state : object
        What the learner knows.
    metrics : tuple of dict
        A row per iteration, with the keys `METRIC_NAMES`; row 0 = before learning. None yet if even that has
        not been measured.
    """

    state: State
    metrics: tuple[Row, ...]

    @property
    def iteration(self) -> int:
        """Number of the last iteration; -1 before the state before learning is measured."""
        return len(self.metrics) - 1


def advance(learner: Learner[State], run: Run[State] | None) -> tuple[Run[State], Seconds]:
    """Return a run after its next iteration, and the seconds of ``learning`` and ``testing``.

    Parameters
    ----------
    learner : Learner
    run : Run or None
        None takes the state before learning, and measures it.
    """
    begin = perf_counter()
    run = Run(learner.start(), ()) if run is None else run
    number = run.iteration + 1
    with part(f"iteration {number}"):
        state = learner.iterate(run.state, number) if number else run.state
        learned = perf_counter()
        row = {"iteration": number, **learner.evaluate(state, number)}
    seconds = {"learning": learned - begin, "testing": perf_counter() - learned}
    return Run(state, (*run.metrics, row)), seconds
