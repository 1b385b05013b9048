"""A run folder: everything an interrupted run needs to continue as if nothing had happened.

The files that a state consists of are written first, then ``checkpoint.json``, which commits the iteration:
what it does not mention did not happen. ``metrics.jsonl`` and other files for reading are derived from it,
and restored if an interruption left older ones. The state of random generators is not stored, since every
stream of a run is named by its iteration and purpose.
"""

from __future__ import annotations

import json
import os
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any, Final, Generic, final

from relforest.runs.learner import METRIC_NAMES, Content, Learner, Row, Run, Seconds, Snapshot, State
from relforest.runs.manifest import differences
from relforest.support.documents import well_formed
from relforest.support.errors import ModelFormatError, RunFolderError
from relforest.support.files import (
    append_line,
    is_temporary,
    read_input,
    read_json,
    write_json,
    write_npz,
    write_text,
)
from relforest.support.locks import LOCK

FORMAT: Final = "relforest-checkpoint"
VERSION: Final = 1
CHECKPOINT: Final = "checkpoint.json"
METRICS: Final = "metrics.jsonl"
TIMINGS: Final = "timings.jsonl"

# Files allowed in a folder before the first checkpoint: a lock, the configuration of the caller, a log.
_BESIDE_CHECKPOINT: Final = (LOCK, "run.json", TIMINGS)


@final
@dataclass(frozen=True, slots=True)
class Checkpoint:
    """What ``checkpoint.json`` contains.

    Parameters
    ----------
    configuration : mapping
        What the run depends on, see `relforest.runs.learner.Learner.configuration`.
    metrics : tuple of dict
        A row per iteration, row 0 = before learning.
    document : mapping
        What the learner added.
    """

    configuration: Mapping[str, Any]
    metrics: tuple[Row, ...]
    document: Mapping[str, Any]

    @property
    def iteration(self) -> int:
        """Number of the last iteration."""
        return len(self.metrics) - 1


def read_checkpoint(folder: str | os.PathLike[str]) -> Checkpoint:
    """Read the checkpoint of a run, perhaps while a process continues the run.

    Raises
    ------
    ModelFormatError
        If it is missing or malformed.
    """
    path = Path(folder) / CHECKPOINT
    document = read_json(path, format=FORMAT, version=VERSION)
    with well_formed(f"{path} is damaged", "restore it from a copy or start again in another folder"):
        metrics, configuration = (
            _checked_metrics(document.pop("metrics")),
            dict(document.pop("configuration")),
        )
        if document.pop("iteration") != len(metrics) - 1:
            raise ModelFormatError("its metrics do not end at its iteration")
    return Checkpoint(configuration, metrics, document)


def metrics_of(folder: Path) -> tuple[Row, ...]:
    """Return the metrics of a run so far, a row per iteration; none if it has not begun.

    Raises
    ------
    ModelFormatError
        If its checkpoint is damaged.
    """
    return read_checkpoint(folder).metrics if (folder / CHECKPOINT).exists() else ()


def iterations_of(folder: Path) -> int:
    """Return how many iterations a run has completed; -1 if it has not begun or its checkpoint is damaged."""
    try:
        return len(metrics_of(folder)) - 1
    except ModelFormatError:
        # Continuing the run reports what is wrong with it.
        return -1


@final
class RunStore(Generic[State]):
    """The folder of one run of a learner.

    ========================= ==========================================================================
    ``checkpoint.json``       configuration, metrics, what the learner adds (authoritative)
    files of the learner      what never changes once it is written, such as experience and trees
    ``metrics.jsonl``         a line per iteration, for reading (derived)
    derived files             of the learner, for reading
    ``timings.jsonl``         clock times, appended; never the same twice
    ========================= ==========================================================================

    Whoever writes must hold the lock of the folder.

    Parameters
    ----------
    path : path
        The folder; it is created when something is written.
    learner : Learner
    """

    def __init__(self, path: str | os.PathLike[str], learner: Learner[State]) -> None:
        self._path = Path(path)
        self._learner = learner

    @property
    def holds_run(self) -> bool:
        """Whether the folder contains a checkpoint.

        Raises
        ------
        RunFolderError
            If the checkpoint is missing but other files of a run, or unrelated files, are present.
        """
        if (self._path / CHECKPOINT).exists():
            return True
        if (self._path / METRICS).exists():
            raise RunFolderError(
                f"{CHECKPOINT} is missing from {self._path}, which contains {METRICS}, so the run cannot be "
                "continued; restore that file or choose another folder"
            )
        for name in self._names():
            if not self._is_ours(name):
                raise RunFolderError(
                    f"{self._path} contains {name}, which is not part of a run; choose a new or empty folder"
                )
        return False

    def resume(self) -> Run[State] | None:
        """Return the run in the folder, restored after an interruption; None if it has not begun.

        Raises
        ------
        RunFolderError
            If the folder contains something else, or a run of another configuration; the message names every
            difference.
        ModelFormatError
            If a file is missing or malformed, or the files do not match.
        """
        if not self.holds_run:
            self._tidy({})
            return None
        checkpoint = read_checkpoint(self._path)
        differing = differences(checkpoint.configuration, self._learner.configuration)
        if differing:
            raise RunFolderError(
                f"{self._path} contains a run with a different configuration: {'; '.join(differing)}; "
                "choose another folder, or use the configuration of that run"
            )
        run = read_run(self._learner, checkpoint, self._path)
        snapshot = self._learner.to_plain(run.state, run.iteration)
        if not self._is_derived(snapshot, run):
            self._write_derived(snapshot, run)
        self._tidy(snapshot.files)
        return run

    def write(self, run: Run[State], seconds: Seconds | None = None) -> None:
        """Commit an iteration; files of earlier ones are left unchanged.

        Parameters
        ----------
        run : Run
            A later stage of what `resume` returned.
        seconds : mapping of str to float, optional
            Clock times of the iteration, for ``timings.jsonl``.

        Raises
        ------
        OSError
            If a file cannot be written; the previous checkpoint is then still valid.
        """
        begin = perf_counter()
        snapshot = self._learner.to_plain(run.state, run.iteration)
        for name, content in snapshot.files.items():
            if not (self._path / name).exists():
                self._write(name, content)
        header = {
            "format": FORMAT,
            "version": VERSION,
            "iteration": run.iteration,
            "configuration": self._learner.configuration,
            "metrics": list(run.metrics),
        }
        write_json(self._path / CHECKPOINT, {**header, **snapshot.document})
        self._write_derived(snapshot, run)
        self._tidy(snapshot.files)
        if seconds is not None:
            times = {**seconds, "writing": perf_counter() - begin}
            line = {"iteration": run.iteration} | {name: round(time, 6) for name, time in times.items()}
            append_line(self._path / TIMINGS, json.dumps(line))

    def _write(self, name: str, content: Content) -> None:
        (write_npz if name.endswith(".npz") else write_json)(self._path / name, content)

    def _write_derived(self, snapshot: Snapshot, run: Run[State]) -> None:
        for name, content in snapshot.derived.items():
            self._write(name, content)
        # Last: as long as it is of an earlier iteration, the others may be too.
        write_text(self._path / METRICS, _lines(run.metrics))

    def _is_derived(self, snapshot: Snapshot, run: Run[State]) -> bool:
        """Return whether the derived files are of this iteration."""
        if not all((self._path / name).exists() for name in (METRICS, *snapshot.derived)):
            return False
        return read_input(self._path / METRICS) == _lines(run.metrics).encode()

    def _tidy(self, kept: Container[str]) -> None:
        """Remove what an interruption left behind, and files that the checkpoint no longer needs."""
        for name in tuple(self._names()):
            path = self._path / name
            if is_temporary(path) or (self._learner.files.fullmatch(name) and name not in kept):
                path.unlink()
                if path.parent != self._path and not any(path.parent.iterdir()):
                    path.parent.rmdir()

    def _names(self) -> Iterator[str]:
        """Yield the names of the files in the folder and in its subfolders, and of the folders in those."""
        for path in sorted(self._path.iterdir()) if self._path.is_dir() else ():
            for entry in sorted(path.iterdir()) if path.is_dir() else (path,):
                yield entry.relative_to(self._path).as_posix()

    def _is_ours(self, name: str) -> bool:
        """Return whether a run could have written a file, judging by its name."""
        is_known = name in _BESIDE_CHECKPOINT or self._learner.files.fullmatch(name) is not None
        return is_known or is_temporary(self._path / name)


def read_run(learner: Learner[State], checkpoint: Checkpoint, folder: Path) -> Run[State]:
    """Return the run that a checkpoint and the files beside it describe.

    Raises
    ------
    ModelFormatError
        If a file is missing or malformed, or the files do not match.
    """
    state = learner.from_plain(checkpoint.document, checkpoint.iteration, folder)
    return Run(state, checkpoint.metrics)


def _lines(metrics: Iterable[Row]) -> str:
    return "".join(f"{json.dumps(row, allow_nan=False)}\n" for row in metrics)


def _checked_metrics(rows: object) -> tuple[Row, ...]:
    """Return the metrics of a run: at least one row, numbered from 0, with the keys `METRIC_NAMES`."""
    if not isinstance(rows, list) or not rows:
        raise ModelFormatError("the list of metrics is missing")
    return tuple(_row(number, row) for number, row in enumerate(rows))


def _row(number: int, row: object) -> Row:
    if not isinstance(row, dict) or tuple(row) != METRIC_NAMES or row["iteration"] != number:
        raise ModelFormatError(f"row {number} of the metrics must have the keys {', '.join(METRIC_NAMES)}")
    for name, entry in row.items():
        absent = name == "train_reward" and number == 0 and entry is None
        if not absent and type(entry) not in (int, float):
            raise ModelFormatError(f"{name} of row {number} of the metrics must be a number")
    return dict(row)
