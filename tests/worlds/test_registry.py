from __future__ import annotations

import subprocess
import sys

import gymnasium
import pytest

from relforest.support.errors import InputError
from relforest.worlds import ENVIRONMENT_IDS, environment_id, register_worlds
from relforest.worlds.blocks.env import BlocksEnv
from relforest.worlds.corridor.env import CorridorEnv
from relforest.worlds.keepaway.env import KeepawayEnv
from relforest.worlds.keepaway.vector import KeepawayVectorEnv


def test_every_named_world_can_be_made() -> None:
    for name in ENVIRONMENT_IDS:
        env = gymnasium.make(environment_id(name))
        env.reset(seed=0)
        env.close()


def test_the_corridor_is_made_by_its_identifier_with_options() -> None:
    env = gymnasium.make("relforest/Corridor-v0", max_steps=3)
    assert isinstance(env.unwrapped, CorridorEnv)
    assert env.unwrapped.max_steps == 3


def test_keepaway_is_made_by_its_identifier_with_options() -> None:
    env = gymnasium.make("relforest/Keepaway-v0", keepers=4, takers=3, size=25.0)
    assert isinstance(env.unwrapped, KeepawayEnv)
    assert (env.unwrapped.setup.keepers, env.unwrapped.setup.length) == (4, 25.0)


def test_many_games_are_made_at_once() -> None:
    envs = gymnasium.make_vec("relforest/Keepaway-v0", num_envs=2, takers=1)
    assert isinstance(envs, KeepawayVectorEnv)
    assert (envs.num_envs, envs.setup.takers) == (2, 1)


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
    with pytest.raises(InputError, match=r"world must be one of 'corridor', 'keepaway', .* got 'labyrinth'"):
        environment_id("labyrinth")


def test_the_tasks_of_the_blocks_world_are_made_by_their_identifiers_with_options() -> None:
    for env, n_actions in (
        # 20 ordered pairs to put, 5 blocks to rotate.
        (gymnasium.make("relforest/HighTowers-v0"), 25),
        # 6 ordered pairs to put, 3 blocks to isolate.
        (gymnasium.make("relforest/ColorGrouping-v0", n_blocks=3, distance="rgb"), 9),
        # 3 blocks to rotate, 1 + 2 + 2 targets for each, done, and 2 * 20 * 2 + 1 targets to ask for.
        (gymnasium.make("relforest/Arch-v0", sampler="training"), 19 + 81),
    ):
        assert isinstance(env.unwrapped, BlocksEnv)
        assert env.action_space == gymnasium.spaces.Discrete(n_actions)


def test_without_pettingzoo_only_its_face_is_missing_and_the_error_names_the_remedy() -> None:
    script = """
import sys
sys.modules["pettingzoo"] = None
import gymnasium, relforest
gymnasium.make("relforest/Keepaway-v0")
try:
    import relforest.worlds.keepaway.parallel
except ImportError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "pip install 'relforest[pettingzoo]'" in done.stdout
