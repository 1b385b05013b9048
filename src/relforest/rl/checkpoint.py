"""A run folder: everything an interrupted run needs to continue as if nothing had happened.

``experience/`` and ``trees/`` are written first, then ``checkpoint.json``, which commits the iteration.
``metrics.jsonl``, ``policy.json`` and ``weights.npz`` are derived from the checkpoint, and restored from it
if an interruption left an older version. The state of random generators is not stored: every stream of a run
is named by its iteration and purpose.
"""

from __future__ import annotations

import json
import os
import re
import reprlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, final

import numpy as np

from relforest.rl import policy_file
from relforest.rl.experience import COLUMNS, OPTIONAL_COLUMNS, Experience
from relforest.rl.policy_file import (
    POLICY,
    TREES,
    WEIGHTS,
    TreeNames,
    describe,
    rebuild,
    slugs,
    write_policy,
    write_tree,
)
from relforest.rl.value import ValueFunction
from relforest.scenes.arrays import FloatArray
from relforest.support.documents import well_formed
from relforest.support.errors import ModelFormatError, RunFolderError
from relforest.support.files import (
    is_temporary,
    read_json,
    read_npz,
    remove_temporary_files,
    write_json,
    write_npz,
    write_text,
)

FORMAT: Final = "relforest-checkpoint"
VERSION: Final = 1
CHECKPOINT: Final = "checkpoint.json"
METRICS: Final = "metrics.jsonl"
TIMINGS: Final = "timings.jsonl"
EXPERIENCE: Final = "experience"

# Files allowed in a folder before the first checkpoint: a lock, the configuration of the caller, a log.
_BESIDE_CHECKPOINT: Final = (".lock", "run.json", TIMINGS)
_TREE_FILE: Final = re.compile(r"\d{4}-.+-\d+\.json")
_EXPERIENCE_FILE: Final = re.compile(r"iteration-\d{4}\.npz")

METRIC_NAMES: Final = ("iteration", "test_reward", "train_reward", "trees", "leaves")

Row = dict[str, Any]


@final
@dataclass(frozen=True, slots=True, eq=False)
class Progress:
    """The progress of a run.

    Parameters
    ----------
    value : ValueFunction
    tree_names : tuple of tuple of str
        The file names of the trees of `value`.
    metrics : tuple of dict
        One row per iteration, row 0 = before learning; the keys are `METRIC_NAMES`.
    batches : tuple of Experience
        Training experience, one batch per iteration.
    """

    value: ValueFunction
    tree_names: TreeNames
    metrics: tuple[Row, ...]
    batches: tuple[Experience, ...]

    @property
    def iteration(self) -> int:
        """Number of the last iteration; -1 before the first measurement."""
        return len(self.metrics) - 1


@final
class RunFolder:
    """The folder of one run.

    ========================= ==========================================================================
    ``checkpoint.json``       configuration, metrics, weights, names of the trees (authoritative)
    ``experience/``           ``iteration-0001.npz``, ...: training experience
    ``trees/``                ``0001-left-1.json``, ...: the accepted trees
    ``metrics.jsonl``         a line per iteration, for reading (derived)
    ``policy.json``,          the policy, for reading (derived)
    ``weights.npz``
    ``timings.jsonl``         clock times, appended; never the same twice
    ========================= ==========================================================================

    Parameters
    ----------
    path : path
        The folder; it is created when something is written.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._path = Path(path)

    @property
    def path(self) -> Path:
        """The folder."""
        return self._path

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
        for name in (METRICS, POLICY, WEIGHTS):
            if (self._path / name).exists():
                raise RunFolderError(
                    f"{CHECKPOINT} is missing from {self._path}, which contains {name}, so the run cannot be "
                    "continued; restore that file or choose another folder"
                )
        for path in self._entries():
            if not self._is_ours(path):
                raise RunFolderError(
                    f"{self._path} contains {path.relative_to(self._path)}, which is not part of a run; "
                    "choose a new or empty folder"
                )
        return False

    def write(self, progress: Progress, configuration: Mapping[str, Any]) -> None:
        """Write the progress of a run; files of earlier iterations are left unchanged.

        Raises
        ------
        OSError
            If a file cannot be written; the previous checkpoint is then still valid.
        """
        last = f"{progress.iteration:04d}-"
        for number, batch in enumerate(progress.batches, start=1):
            path = self._experience(number)
            if number == progress.iteration or not path.exists():
                write_npz(path, batch.arrays())
        for name, tree in _named_trees(progress):
            if name.startswith(last) or not (self._path / TREES / name).exists():
                write_tree(self._path, name, tree)
        weights = dict(zip(slugs(progress.value.action_types), progress.value.weights, strict=True))
        write_json(
            self._path / CHECKPOINT,
            {
                "format": FORMAT,
                "version": VERSION,
                "iteration": progress.iteration,
                "configuration": configuration,
                "metrics": list(progress.metrics),
                "policy": describe(progress.value, progress.tree_names),
                "weights": {name: vector.tolist() for name, vector in weights.items()},
            },
        )
        self._write_derived(progress)

    def read(self) -> tuple[Progress, dict[str, Any]]:
        """Read progress and configuration.

        Raises
        ------
        ModelFormatError
            If a file is missing or malformed, or the files do not match.
        """
        path = self._path / CHECKPOINT
        document = read_json(path, format=FORMAT, version=VERSION)
        with well_formed(f"{path} is damaged", "restore it from a copy or start again in another folder"):
            metrics = checked_metrics(document["metrics"])
            weights = {name: _vector(name, vector) for name, vector in document["weights"].items()}
            configuration, policy = dict(document["configuration"]), dict(document["policy"])
            if document.get("iteration") != len(metrics) - 1:
                raise ModelFormatError("its metrics do not end at its iteration")
        value, names = rebuild(policy, weights, self._path, str(path))
        batches = tuple(self._read_batch(number, value) for number in range(1, len(metrics)))
        return Progress(value, names, metrics, batches), configuration

    def repair(self, progress: Progress) -> None:
        """Clean up after an interruption: restore derived files, remove files that no checkpoint names."""
        if not self._is_derived(progress):
            self._write_derived(progress)
        for folder in (self._path, self._path / TREES, self._path / EXPERIENCE):
            remove_temporary_files(folder)
        for path in self._leftovers(progress):
            path.unlink()

    def _write_derived(self, progress: Progress) -> None:
        lines = [json.dumps(row, allow_nan=False) for row in progress.metrics]
        write_text(self._path / METRICS, "\n".join(lines) + "\n")
        write_policy(self._path, progress.value, progress.tree_names, progress.iteration)

    def _is_derived(self, progress: Progress) -> bool:
        """Return whether the derived files are of this iteration; `write_policy` writes the policy last."""
        try:
            header = read_json(self._path / POLICY, format=policy_file.FORMAT, version=policy_file.VERSION)
        except ModelFormatError:
            return False
        others = (self._path / METRICS, self._path / WEIGHTS)
        return header.get("iteration") == progress.iteration and all(path.exists() for path in others)

    def _leftovers(self, progress: Progress) -> Iterator[Path]:
        trees, experience = self._path / TREES, self._path / EXPERIENCE
        known = {trees / name for name, _ in _named_trees(progress)}
        known |= {self._experience(number) for number in range(1, progress.iteration + 1)}
        for path in self._entries():
            if path.parent in (trees, experience) and path not in known and self._is_ours(path):
                yield path

    def _entries(self) -> Iterator[Path]:
        """Yield the files in the folder and in its two subfolders."""
        for folder in (self._path, self._path / TREES, self._path / EXPERIENCE):
            for path in sorted(folder.iterdir()) if folder.is_dir() else ():
                if path not in (self._path / TREES, self._path / EXPERIENCE):
                    yield path

    def _is_ours(self, path: Path) -> bool:
        """Return whether a run could have written a file, judging by its name."""
        if is_temporary(path):
            return True
        if path.parent == self._path:
            return path.name in _BESIDE_CHECKPOINT
        pattern = _TREE_FILE if path.parent.name == TREES else _EXPERIENCE_FILE
        return pattern.fullmatch(path.name) is not None

    def _experience(self, number: int) -> Path:
        return self._path / EXPERIENCE / f"iteration-{number:04d}.npz"

    def _read_batch(self, number: int, value: ValueFunction) -> Experience:
        path = self._experience(number)
        batch = Experience.from_arrays(read_npz(path, COLUMNS, optional=OPTIONAL_COLUMNS), origin=str(path))
        arity = max((kind.arity for kind in value.action_types), default=0)
        fits = batch.matrix.shape[1] == value.schema.width and batch.arguments.shape[1] == arity
        if not fits or batch.types.max(initial=0) >= len(value.action_types):
            raise ModelFormatError(f"{path} belongs to a different world than the checkpoint beside it")
        return batch


def _named_trees(progress: Progress) -> Iterator[tuple[str, Any]]:
    for names, trees in zip(progress.tree_names, progress.value.forests, strict=True):
        yield from zip(names, trees, strict=True)


def _vector(name: str, numbers: object) -> FloatArray:
    if not isinstance(numbers, list) or not all(type(number) in (int, float) for number in numbers):
        raise ModelFormatError(f"the weights {reprlib.repr(name)} must be a list of numbers")
    return np.array(numbers, dtype=np.float64)


def checked_metrics(rows: object) -> tuple[Row, ...]:
    """Check the metrics of a run: at least one row, numbered from 0, with the keys `METRIC_NAMES`.

    Raises
    ------
    ModelFormatError
        If they are malformed.
    """
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
