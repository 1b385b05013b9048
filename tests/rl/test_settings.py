from __future__ import annotations

import json
from typing import Any

import pytest

from relforest.rl.settings import LSPISettings, RPISettings
from relforest.support.errors import InputError, ModelFormatError
from relforest.trees import TreeSettings
from relforest.volumes import CovAggSettings

OTHER = RPISettings(
    features="bits",
    epsilon=0.2,
    trees_per_label=1,
    wrapper=False,
    lspi=LSPISettings(max_iterations=7),
    tree=TreeSettings(alpha=0.01, covagg=CovAggSettings(window=9)),
)


def test_the_defaults_are_those_of_the_source() -> None:
    settings = RPISettings()
    assert (settings.max_scenes, settings.max_samples, settings.alpha) == (500, 100_000, 0.05)
    assert settings.n_candidates == 4
    assert settings.lspi.max_condition == 1e5


@pytest.mark.parametrize("settings", [RPISettings(), OTHER])
def test_settings_survive_json(settings: RPISettings) -> None:
    assert RPISettings.from_dict(json.loads(json.dumps(settings.to_dict()))) == settings


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"features": "leaves"}, "features must be one of"),
        ({"epsilon": 1.5}, "epsilon must be a number"),
        ({"trees_per_label": 0}, "trees_per_label must be an integer of at least 1"),
        ({"max_scenes": 1}, "max_scenes must be an integer of at least 2"),
        ({"max_samples": 0}, "max_samples must be an integer of at least 1"),
        ({"alpha": 0.0}, "alpha must be a number"),
        ({"max_rounds": -1}, "max_rounds must be an integer of at least 1"),
        ({"wrapper": 1}, "wrapper must be True or False"),
        ({"bootstrap_on_truncation": None}, "bootstrap_on_truncation must be True or False"),
        ({"lspi": {}}, r"lspi must be LSPISettings\(\.\.\.\)"),
        ({"tree": None}, r"tree must be TreeSettings\(\.\.\.\)"),
    ],
)
def test_options_are_checked(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        RPISettings(**options)


@pytest.mark.parametrize(
    "changes",
    [
        {"epsilon": 3},
        {"epsilon": "0.1"},
        {"lspi": []},
        {"lspi": {"epsilon": 1.0}},
        {"speed": 1},
        {"tree": None},
    ],
)
def test_malformed_settings_are_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(ModelFormatError, match=r"malformed \w*Settings"):
        RPISettings.from_dict(RPISettings().to_dict() | changes)


def test_settings_from_before_there_were_two_searches_are_read() -> None:
    document = RPISettings().to_dict()
    del document["tree"]["search"]
    assert RPISettings.from_dict(document) == RPISettings()
    assert RPISettings().tree.search == "exhaustive"


def test_only_other_volumes_are_named_so_that_older_runs_can_be_resumed() -> None:
    assert set(RPISettings().to_dict()["tree"]["covagg"]) == {
        "window",
        "prior_weight",
        "max_condition",
        "restarts",
        "sampled",
    }
    other = RPISettings(tree=TreeSettings(covagg=CovAggSettings(shape="axis", learner="diverse-density")))
    assert other.to_dict()["tree"]["covagg"]["shape"] == "axis"
    assert RPISettings.from_dict(json.loads(json.dumps(other.to_dict()))) == other


@pytest.mark.parametrize("document", [None, [], {}, "settings"])
def test_other_things_are_no_settings(document: object) -> None:
    with pytest.raises(ModelFormatError, match="malformed RPISettings"):
        RPISettings.from_dict(document)
