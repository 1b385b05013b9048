from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from relforest.experiments.run_config import RunConfig
from relforest.support.errors import InputError


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"task": "chess"}, "task must be one of"),
        ({"episodes": 0}, "episodes must be an integer of at least 1, got 0"),
        ({"episodes": -5}, "episodes must be an integer of at least 1, got -5"),
        ({"iterations": 0}, "iterations must be an integer of at least 1, got 0"),
        ({"iterations": 2.5}, "iterations must be an integer of at least 1, got 2.5"),
        ({"runs": 0}, "runs must be an integer of at least 1, got 0"),
        ({"runs": True}, "runs must be an integer of at least 1, got True"),
        ({"seed": -1}, "seed must be an integer of at least 0, got -1"),
        ({"test_episodes": 0}, "test_episodes must be an integer of at least 1, got 0"),
        (
            {"features": "bytes"},
            "features must be one of 'densities.bits', 'bits', 'probability', got 'bytes'",
        ),
        ({"method": "guess"}, "method must be one of 'smrf-rpi', 'cmac-sarsa', 'cmac-sarsa-shared', got"),
        ({"method": "cmac-sarsa"}, "the method for corridor must be one of 'smrf-rpi', got 'cmac-sarsa'"),
    ],
)
def test_options_out_of_range_are_named(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        RunConfig(**{"task": "corridor", **options})


def test_a_single_run_has_the_folder_to_itself(tmp_path: Path) -> None:
    assert RunConfig("corridor").folders(tmp_path) == [tmp_path]
    assert [folder.name for folder in RunConfig("corridor", runs=3).folders(tmp_path)] == [
        "run-00",
        "run-01",
        "run-02",
    ]


def test_the_identity_holds_everything_that_results_depend_on() -> None:
    config = RunConfig("corridor", episodes=10, iterations=2, runs=3, seed=4, features="bits")
    identity = config.identity()

    assert identity.file == "run.json"
    assert identity.growing == "iterations"
    assert {name: value for name, value in identity.content.items() if name != "settings"} == {
        "task": "corridor",
        "method": "smrf-rpi",
        "episodes": 10,
        "test_episodes": 10,
        "iterations": 2,
        "runs": 3,
        "seed": 4,
        "features": "bits",
    }
    assert identity.content["settings"]["epsilon"] == 0.1
    sarsa = RunConfig("keepaway", method="cmac-sarsa").identity().content
    assert sarsa["method"] == "cmac-sarsa"
    assert not {"features", "settings"} & set(sarsa)
    assert config.identity(2).content == {**identity.content, "run": 2}
    assert config.settings.features == "bits"


def test_as_many_test_episodes_as_training_episodes_are_the_default() -> None:
    assert RunConfig("corridor", episodes=10).identity().content == (
        RunConfig("corridor", episodes=10, test_episodes=10).identity().content
    )
