from __future__ import annotations

from pathlib import Path

from relforest.experiments.learning.run import learned
from relforest.experiments.learning.settings import KEEPAWAY, SETTINGS
from relforest.experiments.runs import RunInFolder
from relforest.experiments.study import Context


def runs_of(condition: str, folder: Path) -> list[RunInFolder]:
    own = [setting for setting in SETTINGS[KEEPAWAY] if setting.condition == condition]
    return [run for setting in own if (run := learned(setting, Context(0, 0, folder))) is not None]


def test_weights_are_learned_for_the_trees_of_the_run_of_the_same_number(tmp_path: Path) -> None:
    begun, sources = (runs_of(condition, tmp_path) for condition in ("sarsa-on-smrf", "smrf-rpi-500"))

    assert [run.source for run in begun] == [run.folder for run in sources]
    assert len({run.folder for run in (*begun, *sources)}) == 10
