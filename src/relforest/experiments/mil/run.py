"""A data set and a method -> a row per fold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final, final

from relforest.experiments.mil.data import absence
from relforest.experiments.mil.folds import prepare_folds, prepare_trials
from relforest.experiments.mil.grid import best_point, grid_points
from relforest.experiments.mil.limited import run_job
from relforest.experiments.mil.settings import MilSetting
from relforest.experiments.mil.steps import STOPPED, Job, Prepare, Step
from relforest.experiments.study import Obstacle, Place
from relforest.experiments.table import Row

_CELLS: Final = "cells"
_COUNTS: Final = ("n_bags", "n_positive", "n_instances", "n_features")


@final
@dataclass(frozen=True, slots=True)
class Work:
    """What the processes of a setting do; tests put in less."""

    folds: Prepare = prepare_folds
    trials: Prepare = prepare_trials


def compute(setting: MilSetting, place: Place) -> list[Row]:
    """Return a row per fold.

    Its columns are data_set, method, fold, state (``"done"``, or ``"stopped"`` for one that took too long,
    the last one then), pss, cpu_seconds, peak_bytes, C and gamma_factor (where they were
    chosen), n_bags, n_positive, n_instances and n_features of training and test set together. Times and
    memory differ from run to run.

    References
    ----------
    Palmer (2015), section 3.3.
    """
    return measured(setting, place, Work())


def measured(setting: MilSetting, place: Place, work: Work) -> list[Row]:
    """Do the work of a setting fold by fold, or what is left of it."""
    file = place.folder / _CELLS / setting.data_set / f"{setting.method}.json"
    asked = {"setting": asdict(setting), "seed": place.seed}
    parameters = _chosen(setting, asked, file, work.trials) if setting.tuning_draws else {}
    if parameters is None:
        return [_row(setting, 0, Step(STOPPED, None, 0), {})]
    job = Job(work.folds, {**asked, "parameters": parameters}, setting.folds, setting.cpu_limit, file)
    steps = run_job(job, str(setting))
    return [_row(setting, fold, step, parameters) for fold, step in enumerate(steps)]


def obstacles(settings: Sequence[MilSetting]) -> Mapping[MilSetting, Obstacle]:
    """Return the settings with missing data.

    Raises
    ------
    DataError
        If a file is damaged.
    """
    found = {name: absence(name) for name in dict.fromkeys(setting.data_set for setting in settings)}
    return {setting: obstacle for setting in settings if (obstacle := found[setting.data_set]) is not None}


def _chosen(
    setting: MilSetting, asked: Mapping[str, Any], file: Path, prepare: Prepare
) -> dict[str, float] | None:
    """Return the best parameters on draws that serve nothing else; None if all took too long."""
    points = grid_points(setting.grid_step)
    trials = file.with_name(f"{file.stem}.trials.json")
    job = Job(prepare, asked, len(points), setting.trial_limit, trials, ends_when_stopped=False)
    return best_point(run_job(job, f"{setting}, tuning"), points)


def _row(setting: MilSetting, fold: int, step: Step, parameters: Mapping[str, float]) -> Row:
    return {
        "data_set": setting.data_set,
        "method": setting.method,
        "fold": fold,
        "state": step.state,
        "pss": step.values.get("pss"),
        "cpu_seconds": step.cpu_seconds,
        "peak_bytes": step.peak_bytes,
        "C": parameters.get("C"),
        "gamma_factor": parameters.get("gamma_factor"),
        **{name: step.values.get(name) for name in _COUNTS},
    }
