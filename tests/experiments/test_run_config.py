from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from relforest.experiments.run_config import RunConfig
from relforest.rl.baselines.settings import SarsaSettings
from relforest.rl.settings import RPISettings
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
        (
            {"method": "guess"},
            "method must be one of 'smrf-rpi', 'smrf-q', 'cmac-sarsa', .*'deep-sets-q', got",
        ),
        ({"discount": 2.0}, "discount must be a number of at least 0 and of at most 1, got 2.0"),
        ({"rpi": {"epsilon": 0.1}}, r"rpi must be RPISettings\(...\), got {'epsilon': 0.1}"),
        ({"sarsa": SarsaSettings()}, "sarsa is not an option of smrf-rpi: leave it out"),
        (
            {"task": "keepaway", "method": "cmac-sarsa", "discount": 0.9},
            "discount is not an option of cmac",
        ),
        (
            {"task": "keepaway", "method": "cmac-sarsa", "rpi": RPISettings()},
            "rpi is not an option of cmac",
        ),
        ({"method": "cmac-sarsa"}, "the method for corridor must be one of 'smrf-rpi', 'smrf-q', got"),
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


def test_the_manifest_holds_everything_that_results_depend_on() -> None:
    config = RunConfig("corridor", episodes=10, iterations=2, runs=3, seed=4, features="bits")
    manifest = config.manifest()

    assert manifest.file == "run.json"
    assert manifest.growing == "iterations"
    assert {name: value for name, value in manifest.content.items() if name != "settings"} == {
        "task": "corridor",
        "method": "smrf-rpi",
        "episodes": 10,
        "test_episodes": 10,
        "iterations": 2,
        "runs": 3,
        "seed": 4,
        "features": "bits",
    }
    assert manifest.content["settings"]["epsilon"] == 0.1
    sarsa = RunConfig("keepaway", method="cmac-sarsa").manifest().content
    assert sarsa["method"] == "cmac-sarsa"
    assert not {"features", "settings"} & set(sarsa)
    assert config.manifest(2).content == {**manifest.content, "run": 2}


def test_as_many_test_episodes_as_training_episodes_are_the_default() -> None:
    assert RunConfig("corridor", episodes=10).manifest().content == (
        RunConfig("corridor", episodes=10, test_episodes=10).manifest().content
    )


def test_options_of_the_learner_are_part_of_the_manifest() -> None:
    plain = RunConfig("corridor", rpi=RPISettings(), seed=4)
    changed = RunConfig("corridor", rpi=RPISettings(max_rounds=3, features="bits"), discount=0.5)
    team = RunConfig("keepaway", method="cmac-sarsa", sarsa=SarsaSettings(alpha=0.25))

    # Older runs name no discount and no options of Sarsa.
    assert plain.manifest().content == RunConfig("corridor", seed=4).manifest().content
    assert changed.manifest().content["settings"]["max_rounds"] == 3
    assert changed.manifest().content["features"] == "bits"
    assert changed.manifest().content["discount"] == 0.5
    assert team.manifest().content["sarsa"]["alpha"] == 0.25
    assert "sarsa" not in replace(team, sarsa=SarsaSettings()).manifest().content


def test_features_are_those_asked_for_or_those_of_the_settings() -> None:
    config = RunConfig("corridor", rpi=RPISettings(features="bits"))

    assert config.manifest().content["features"] == "bits"
    assert replace(config, features="probability").manifest().content["features"] == "probability"
