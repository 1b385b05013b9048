"""The folder of a run of Sarsa: its metrics, and its agents as they were after the last iteration.

``sarsa-run.json`` holds the metrics; writing it completes an iteration. ``model-NNNN/``, the agents after
iteration NNNN, is written before it, and the previous model is removed after it. ``metrics.jsonl`` is
derived.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from relforest.rl.checkpoint import METRICS, Row, checked_metrics
from relforest.rl.peers import SarsaLambda, read_team, write_team
from relforest.support.documents import well_formed
from relforest.support.errors import ModelFormatError
from relforest.support.files import read_json, remove_temporary_files, write_json, write_text
from relforest.support.rng import RandomState

FORMAT: Final = "relforest-sarsa-run"
VERSION: Final = 1
CHECKPOINT: Final = "sarsa-run.json"

Team = Sequence[SarsaLambda[Any]]


def read_metrics(folder: Path) -> list[Row]:
    """Return a row per iteration, the first before learning; none if the run has not begun.

    Raises
    ------
    ModelFormatError
        If the checkpoint is damaged.
    """
    path = folder / CHECKPOINT
    if not path.exists():
        return []
    document = read_json(path, format=FORMAT, version=VERSION)
    with well_formed(f"{path} is damaged"):
        return list(checked_metrics(document.get("metrics")))


def read_agents(folder: Path, iteration: int, random_state: RandomState = None) -> Team:
    """Return the agents after an iteration, ready to continue learning.

    Raises
    ------
    ModelFormatError
        If a file is missing or damaged.
    """
    return read_team(_model(folder, iteration), random_state=random_state)


def trained_team(folder: Path) -> Team:
    """Return the present agents of a run, without learning.

    Raises
    ------
    ModelFormatError
        If a file is missing or damaged.
    """
    metrics = read_metrics(folder)
    if not metrics:
        raise ModelFormatError(f"{folder} does not contain {CHECKPOINT}: it is not a run of Sarsa")
    return read_team(_model(folder, len(metrics) - 1), learn=False)


def write_iteration(folder: Path, team: Team, metrics: list[Row]) -> None:
    """Write the agents and the metrics after an iteration; an interruption loses neither."""
    iteration = len(metrics) - 1
    write_team(_model(folder, iteration), team)
    write_json(folder / CHECKPOINT, {"format": FORMAT, "version": VERSION, "metrics": metrics})
    tidy(folder, metrics)


def tidy(folder: Path, metrics: list[Row]) -> None:
    """Restore derived files, and remove what an interruption left behind."""
    if metrics:
        lines = [json.dumps(row, allow_nan=False) for row in metrics]
        write_text(folder / METRICS, "\n".join(lines) + "\n")
    remove_temporary_files(folder)
    kept = _model(folder, len(metrics) - 1)
    for model in sorted(folder.glob("model-[0-9][0-9][0-9][0-9]")):
        if model != kept:
            shutil.rmtree(model)


def _model(folder: Path, iteration: int) -> Path:
    return folder / f"model-{iteration:04d}"
