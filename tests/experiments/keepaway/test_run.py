from __future__ import annotations

from pathlib import Path

import pytest

from relforest.experiments.keepaway.run import compute
from relforest.experiments.keepaway.settings import (
    DURATIONS,
    LEARNING,
    PHYSICS,
    SERVER_EVENTS,
    KeepawaySetting,
)
from relforest.experiments.keepaway.trajectories import TRAJECTORIES
from relforest.experiments.study import Context

DATA = Path(__file__).parents[2] / "data"


def measured(setting: KeepawaySetting, folder: Path) -> dict[str, object]:
    return {str(row["measure"]): row["value"] for row in compute(setting, Context(0, 0, folder))}


def test_recorded_steps_are_compared_where_there_is_a_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("RELFOREST_DATA", raising=False)
    assert measured(KeepawaySetting(PHYSICS), tmp_path) == {"": None}

    monkeypatch.setenv("RELFOREST_DATA", str(DATA))
    found = measured(KeepawaySetting(PHYSICS), tmp_path)
    assert (DATA / TRAJECTORIES).exists()
    assert found["kick: steps"] == 620
    assert {value for name, value in found.items() if name.endswith("violations")} == {0.0}


def test_games_are_described_by_all_that_was_measured_on_real_ones(tmp_path: Path) -> None:
    found = measured(KeepawaySetting(DURATIONS, condition="random", episodes=3), tmp_path)

    assert set(SERVER_EVENTS) <= set(found)
    assert found["episodes"] == 3
    assert float(str(found["q5"])) <= float(str(found["mean"])) <= float(str(found["max"]))


def test_learning_is_averaged_over_blocks(tmp_path: Path) -> None:
    setting = KeepawaySetting(LEARNING, condition="cmac-sarsa", episodes=5, block=2)

    assert list(measured(setting, tmp_path)) == ["2", "4"]
