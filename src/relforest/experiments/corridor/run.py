"""One run under one condition -> a row per iteration."""

from __future__ import annotations

import numpy as np

from relforest.experiments.corridor.settings import CONDITIONS, CorridorSetting
from relforest.experiments.run_config import RunConfig
from relforest.experiments.runs import RunInFolder
from relforest.experiments.study import Context
from relforest.experiments.table import Row
from relforest.rl.settings import RPISettings
from relforest.runs.store import metrics_of
from relforest.support.rng import seed_sequence, stream


def learned(setting: CorridorSetting, context: Context) -> RunInFolder:
    """Return the run that a setting is about.

    References
    ----------
    Palmer (2015), section 7.3.
    """
    config = RunConfig(
        "corridor",
        episodes=setting.episodes,
        iterations=setting.iterations,
        runs=setting.runs,
        seed=seed_of(setting.condition, context.seed),
        features=setting.features,
        rpi=None if setting.wrapper else RPISettings(wrapper=False),
    )
    folder = context.folder / "runs" / setting.condition / f"run-{setting.run:02d}"
    return RunInFolder(config, setting.run, folder)


def compute(setting: CorridorSetting, context: Context) -> list[Row]:
    """Return the metrics of the run: condition, run, and the columns of ``metrics.jsonl``."""
    metrics = metrics_of(learned(setting, context).folder)
    return [{"condition": setting.condition, "run": setting.run, **row} for row in metrics]


def seed_of(condition: str, seed: int) -> int:
    """Return the seed of a condition: an integer, so that ``relforest learn --seed`` can repeat its runs.

    The conditions are compared as independent samples, so they share no random numbers.
    """
    number = list(CONDITIONS).index(condition)
    return int(stream(seed_sequence(seed), number).generate_state(1, np.uint32)[0])
