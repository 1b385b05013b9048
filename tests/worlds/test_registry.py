from __future__ import annotations

import subprocess
import sys

import gymnasium
import pytest

from relforest.support.errors import InputError
from relforest.worlds import ENVIRONMENT_IDS, environment_id, register_worlds
from relforest.worlds.corridor.env import CorridorEnv


def test_every_named_world_can_be_made() -> None:
    for name in ENVIRONMENT_IDS:
        env = gymnasium.make(environment_id(name))
        env.reset(seed=0)
        env.close()


def test_the_corridor_is_made_by_its_identifier_with_options() -> None:
    env = gymnasium.make("relforest/Corridor-v0", max_steps=3)
    assert isinstance(env.unwrapped, CorridorEnv)
    assert env.unwrapped.max_steps == 3


def test_registering_again_changes_nothing() -> None:
    # Gymnasium warns when an environment is registered over another, and warnings are errors here.
    before = gymnasium.registry["relforest/Corridor-v0"]
    register_worlds()
    assert gymnasium.registry["relforest/Corridor-v0"] is before


def test_gymnasium_can_import_the_library_by_itself() -> None:
    script = (
        "import gymnasium; print(gymnasium.make('relforest:relforest/Corridor-v0').reset(seed=0)[0]['mask'])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert (done.stdout, done.returncode) == ("[1]\n", 0), done.stderr


def test_an_unknown_world_is_an_error_that_lists_the_known_ones() -> None:
    with pytest.raises(InputError, match="world must be one of 'corridor', got 'labyrinth'"):
        environment_id("labyrinth")
