from __future__ import annotations

import json
from typing import Any

import pytest

from relforest.rl.baselines import SarsaSettings
from relforest.support.errors import InputError, ModelFormatError


def test_the_defaults_are_those_of_the_benchmark() -> None:
    settings = SarsaSettings()
    assert (settings.alpha, settings.gamma, settings.epsilon) == (0.125, 1.0, 0.01)
    assert settings.trace_decay == 0.0


def test_settings_survive_json() -> None:
    settings = SarsaSettings(0.5, 0.9, 0.0, 0.7, "accumulating", 0.0)
    assert SarsaSettings.from_dict(json.loads(json.dumps(settings.to_dict()))) == settings


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("alpha", 0.0),
        ("alpha", float("inf")),
        ("gamma", 1.1),
        ("gamma", float("nan")),
        ("epsilon", -0.1),
        ("trace_decay", 1.5),
        ("traces", "dutch"),
        ("min_trace", -1.0),
        ("min_trace", None),
    ],
)
def test_settings_out_of_range_are_refused(name: str, value: Any) -> None:
    with pytest.raises(InputError, match=f"{name} must be"):
        SarsaSettings(**{name: value})
    with pytest.raises(ModelFormatError, match=f"malformed options of Sarsa: {name}"):
        SarsaSettings.from_dict(SarsaSettings().to_dict() | {name: value})


@pytest.mark.parametrize("document", [None, [], {}, SarsaSettings().to_dict() | {"more": 1}])
def test_other_values_are_no_settings(document: Any) -> None:
    with pytest.raises(ModelFormatError, match="malformed options of Sarsa: expected alpha"):
        SarsaSettings.from_dict(document)
