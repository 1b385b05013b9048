from __future__ import annotations

import json
from pathlib import Path

import gymnasium
import numpy as np
import pytest

from relforest.rl.configuration import check_world, describe_run, restore_run
from relforest.rl.settings import RPISettings
from relforest.runs.manifest import differences
from relforest.scenes import Attribute, Schema
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.rng import stream
from relforest.worlds.corridor.env import CorridorEnv
from rl.small_worlds import ACTION_TYPES, SCHEMA, Picking

HERE = Path("runs/one")


@pytest.mark.parametrize(
    "seed",
    [
        np.random.SeedSequence(7),
        stream(np.random.SeedSequence(7), 3, 1),
        np.random.SeedSequence([1, 2, 3]),
        np.random.SeedSequence(),
    ],
)
def test_seed_and_settings_survive_json(seed: np.random.SeedSequence) -> None:
    document = json.loads(json.dumps(describe_run(CorridorEnv(), RPISettings().to_dict(), seed, (500, 10))))
    restored, settings, episodes = restore_run(document, HERE)
    assert restored.generate_state(4).tolist() == seed.generate_state(4).tolist()
    assert settings == RPISettings()
    assert episodes == (500, 10)


def test_the_options_of_an_environment_belong_to_the_configuration() -> None:
    seed = np.random.SeedSequence(0)
    one, other = (
        describe_run(
            gymnasium.make("relforest/Corridor-v0", noise=noise), RPISettings().to_dict(), seed, (5, 5)
        )
        for noise in (0.05, 0.1)
    )
    assert differences(one, other) == ["world.options.noise (0.05 there, 0.1 here)"]


def test_the_first_difference_of_two_lists_is_named() -> None:
    there = [{"run": 0, "runs": 2}, {"run": 1, "runs": 2}]
    here = [{"run": 0, "runs": 3}, {"run": 1, "runs": 3}, {"run": 2, "runs": 3}]
    assert differences({"settings": there}, {"settings": here}) == ["settings[0].runs (2 there, 3 here)"]
    assert differences([1, 2], [1, 2, 3], "sizes") == ["sizes (2 there, 3 here)"]
    assert differences([1, 2], [1, 2], "sizes") == []
    assert differences([1, 2], None, "sizes") == ["sizes ([1, 2] there, None here)"]


@pytest.mark.parametrize(
    "document",
    [
        {},
        {"random_state": 3},
        {"random_state": {"entropy": "x", "spawn_key": []}},
        {"random_state": {"entropy": -1, "spawn_key": []}},
        {"random_state": {"entropy": 0, "spawn_key": None}},
        {"random_state": {"entropy": 0, "spawn_key": []}, "settings": {}},
    ],
)
def test_damaged_configurations_are_refused(document: dict[str, object]) -> None:
    with pytest.raises(ModelFormatError, match=r"the checkpoint in runs/one is damaged"):
        restore_run(document, HERE)


def test_agents_fit_worlds_with_other_numbers_of_objects() -> None:
    check_world(SCHEMA, ACTION_TYPES, Picking(things=9))


def test_agents_do_not_fit_other_action_types() -> None:
    with pytest.raises(InputError, match=r"knows the action types \['wait', 'pick'\], but CorridorEnv has"):
        check_world(SCHEMA, ACTION_TYPES, CorridorEnv())


def test_agents_do_not_fit_other_attributes() -> None:
    with pytest.raises(InputError, match=r"trained on objects with .*weight.*, but Picking has .*location"):
        check_world(Schema((Attribute("weight"),)), ACTION_TYPES, Picking())
