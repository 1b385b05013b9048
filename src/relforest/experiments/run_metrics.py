"""The progress of a run folder, read while a process may be working in it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from relforest.experiments import sarsa_folder
from relforest.rl.checkpoint import CHECKPOINT, FORMAT, VERSION, checked_metrics
from relforest.support.documents import well_formed
from relforest.support.errors import ModelFormatError
from relforest.support.files import read_json


def metrics_of(folder: Path) -> list[dict[str, Any]]:
    """Return the metrics of a run so far, a row per iteration, the first before learning.

    Raises
    ------
    ModelFormatError
        If its checkpoint is damaged.
    """
    path = checkpoint_of(folder)
    if not path.exists():
        return []
    if path.name == sarsa_folder.CHECKPOINT:
        return sarsa_folder.read_metrics(folder)
    document = read_json(path, format=FORMAT, version=VERSION)
    with well_formed(f"{path} is damaged", "restore it or choose another folder"):
        return list(checked_metrics(document.get("metrics")))


def checkpoint_of(folder: Path) -> Path:
    """Return the checkpoint of a run, which changes when an iteration is done: of SMRF-RPI or of Sarsa."""
    other = folder / sarsa_folder.CHECKPOINT
    return other if other.exists() else folder / CHECKPOINT


def iterations_of(folder: Path) -> int:
    """Return how many iterations a run has completed; -1 if it has not begun or its checkpoint is damaged."""
    try:
        return len(metrics_of(folder)) - 1
    except ModelFormatError:
        # Continuing the run reports what is wrong with it.
        return -1
