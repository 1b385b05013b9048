from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from experiments.mil import fakes
from relforest.datasets import BagSet
from relforest.experiments.mil import data
from relforest.experiments.mil.grid import grid_points
from relforest.experiments.mil.run import Work, compute, measured, obstacles
from relforest.experiments.mil.settings import MilSetting
from relforest.experiments.mil.steps import DONE, STOPPED
from relforest.experiments.study import Place
from relforest.experiments.table import Row
from relforest.support.errors import MissingDataError

WORK = Work(fakes.fake_folds, fakes.fake_trials)
UNTIMED = {"cpu_seconds", "peak_bytes"}


def untimed(rows: list[Row]) -> list[Row]:
    return [{name: cell for name, cell in row.items() if name not in UNTIMED} for row in rows]


def test_a_row_tells_all_of_a_fold(tmp_path: Path) -> None:
    rows = measured(MilSetting("musk1", "covagg", 2), Place(3, 7, tmp_path), WORK)

    assert untimed(rows) == [
        {
            "data_set": "musk1",
            "method": "covagg",
            "fold": fold,
            "state": DONE,
            "pss": 1.0,
            "C": None,
            "gamma_factor": None,
            "n_bags": 23,
            "n_positive": 12,
            "n_instances": 69,
            "n_features": 2,
        }
        for fold in (0, 1)
    ]
    assert [path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.json")] == [
        "cells/musk1/covagg.json"
    ]


def test_a_method_that_takes_too_long_leaves_a_row(tmp_path: Path) -> None:
    setting = MilSetting("color", "dd", 5, n_bags=20, cpu_limit=1.0)
    (row,) = measured(setting, Place(0, 0, tmp_path), WORK)

    assert (row["state"], row["pss"], row["cpu_seconds"], row["n_bags"]) == (STOPPED, None, None, None)


def test_parameters_are_tuned_once_and_then_used(tmp_path: Path) -> None:
    setting = MilSetting("color", "miles-tuned", 2, n_bags=20, tuning_draws=1, grid_step=4)
    rows = measured(setting, Place(0, 0, tmp_path), WORK)
    trials = json.loads((tmp_path / "cells" / "color" / "miles-tuned.trials.json").read_text())
    scores = [step["values"]["pss"] for step in trials["steps"]]
    points = grid_points(4)

    # The threshold C * gamma_factor must lie between 1 and 1.5 or so; of C = 10^-4, 1, 10^4, 10^8 and factors
    # 1/16, 1, 16 only 1 * 1 does. Higher ones call all bags negative, lower ones all positive.
    best = points.index({"C": 1.0, "gamma_factor": 1.0})
    assert len(scores) == len(points)
    assert [number for number, score in enumerate(scores) if score == 1.0] == [best]
    assert [(row["C"], row["gamma_factor"], row["pss"]) for row in rows] == [(1.0, 1.0, 1.0)] * 2


def test_a_killed_setting_goes_on_to_the_same_rows(tmp_path: Path) -> None:
    setting = MilSetting("musk1", "covagg", 3)
    whole = measured(setting, Place(3, 0, tmp_path / "whole"), WORK)
    file = tmp_path / "whole" / "cells" / "musk1" / "covagg.json"
    saved = json.loads(file.read_text())
    cut = tmp_path / "cut" / "cells" / "musk1" / "covagg.json"
    cut.parent.mkdir(parents=True)
    cut.write_text(json.dumps({**saved, "steps": saved["steps"][:1]}))
    resumed = measured(setting, Place(3, 9, tmp_path / "cut"), WORK)

    assert untimed(resumed) == untimed(whole)
    # What was saved before keeps its times.
    assert resumed[0] == whole[0]


def test_real_methods_learn_real_draws(tmp_path: Path) -> None:
    setting = MilSetting("covariant1", "covagg", 2, n_bags=60)
    rows = compute(setting, Place(0, 0, tmp_path))

    assert [row["state"] for row in rows] == [DONE, DONE]
    assert [(row["n_bags"], row["n_features"]) for row in rows] == [(120, 2)] * 2
    assert all(0.3 < float(str(row["pss"])) <= 1 for row in rows)
    assert all(0 < float(str(row["cpu_seconds"])) < 60 for row in rows)


def test_settings_without_their_data_have_an_obstacle(monkeypatch: pytest.MonkeyPatch) -> None:
    def fetch() -> BagSet:
        raise MissingDataError("no file")

    names = {name: data.Standard(name.title(), 1, fetch) for name in ("fox", "musk1")}
    monkeypatch.setattr(data, "DATA_SETS", {**names, "color": fakes.DRAWN})
    settings = [MilSetting(name, "dd", 2) for name in ("fox", "musk1", "color")]
    settings.append(replace(settings[0], method="apr"))
    found = obstacles(settings)

    assert {setting: obstacle.missing for setting, obstacle in found.items()} == {
        settings[0]: "Fox (fox.csv.gz)",
        settings[1]: "Musk1 (musk1.csv.gz)",
        settings[3]: "Fox (fox.csv.gz)",
    }
    assert len({obstacle.reason for obstacle in found.values()}) == 1
