from __future__ import annotations

from pathlib import Path

from relforest.experiments.corridor.run import compute, learned, seed_of
from relforest.experiments.corridor.settings import CONDITIONS, SETTINGS, CorridorSetting
from relforest.experiments.run_config import RunConfig
from relforest.experiments.runs import learn_in_folders, learn_runs
from relforest.experiments.study import Context
from relforest.runs.store import metrics_of


def test_conditions_share_no_seed() -> None:
    seeds = {seed_of(condition, seed) for condition in CONDITIONS for seed in (0, 1)}

    assert len(seeds) == 2 * len(CONDITIONS)


def test_a_run_is_what_the_command_learn_gives_with_the_same_seed(tmp_path: Path) -> None:
    setting = CorridorSetting("10-bits", 1, 2, 1, 4, "bits")
    context = Context(0, 5, tmp_path / "study")
    learn_in_folders([learned(setting, context)])
    rows = compute(setting, context)

    config = RunConfig(
        "corridor", episodes=4, iterations=1, runs=2, seed=seed_of("10-bits", 0), features="bits"
    )
    learn_runs(config, tmp_path / "learn")
    metrics = metrics_of(tmp_path / "learn" / "run-01")
    assert rows == [{"condition": "10-bits", "run": 1, **row} for row in metrics]


def test_the_study_has_thirty_runs_of_each_condition() -> None:
    assert {name: sum(s.condition == name for s in SETTINGS) for name in CONDITIONS} == dict.fromkeys(
        CONDITIONS, 30
    )
