from __future__ import annotations

import copy
import sys
import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.utils.env_checker import check_env

from relforest.scenes import Scenes
from relforest.support.errors import InputError
from relforest.testing import check_world
from relforest.worlds.corridor import LEFT, RIGHT
from relforest.worlds.corridor.env import CorridorEnv


def test_gymnasiums_own_check_passes_without_a_warning() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make("relforest/Corridor-v0", render_mode="rgb_array").unwrapped)


def test_the_corridor_is_a_world() -> None:
    check_world(lambda: gymnasium.make("relforest/Corridor-v0"))


def test_an_episode_without_noise_by_hand() -> None:
    env = CorridorEnv(noise=0.0, max_steps=4)
    observation, info = env.reset(seed=0, options={"x": 0.3})
    assert observation["location"].tolist() == [[0.3]]
    assert "duration" not in info
    # 0.3 -> 0.2 -> 0.1 (in the window) -> 0.0 -> back to 0.1.
    outcomes = [env.step(action) for action in (LEFT, LEFT, LEFT, RIGHT)]
    locations = [observation["location"][0, 0] for observation, *_ in outcomes]
    assert locations == pytest.approx([0.2, 0.1, 0.0, 0.1], abs=1e-15)
    assert [paid for _, paid, *_ in outcomes] == [0.0, 1.0, 1.0, 1.0]
    assert [terminated for _, _, terminated, _, _ in outcomes] == [False] * 4
    assert [truncated for _, _, _, truncated, _ in outcomes] == [False, False, False, True]


def test_the_noise_has_its_standard_deviation() -> None:
    env = CorridorEnv(noise=0.02, step_length=0.2)
    env.reset(seed=0)
    moves = []
    for _ in range(1000):
        env.reset(options={"x": 0.5})
        moves.append(env.step(RIGHT)[0]["location"][0, 0] - 0.5)
    # Standard errors: of the mean 0.02 / sqrt(1000) = 0.00063, of the deviation 0.02 / sqrt(2000) = 0.00045.
    assert np.mean(moves) == pytest.approx(0.2, abs=4 * 0.00063)
    assert np.std(moves) == pytest.approx(0.02, abs=4 * 0.00045)


def test_info_describes_state_and_choices() -> None:
    env = CorridorEnv()
    env.reset(seed=0)
    observation, _, _, _, info = env.step(LEFT)
    assert isinstance(info["scene"], Scenes)
    assert info["scene"].matrix.tolist() == observation["location"].tolist()
    assert info["scene"].matrix.tolist() == env.decision().objects.tolist() == [[env.state.x]]
    assert info["action_mask"].tolist() == [1, 1]
    assert info["action_mask"].dtype == np.int8
    assert info["duration"] == 1.0
    assert "discounted_reward" not in info


def test_scenes_can_be_read_from_the_observation() -> None:
    env = CorridorEnv()
    observation, info = env.reset(seed=0)
    read = Scenes.from_padded(observation, schema=env.schema)
    np.testing.assert_array_equal(read.matrix, info["scene"].matrix)


def test_the_same_seed_gives_the_same_episodes() -> None:
    def play(seed: int) -> list[float]:
        env = CorridorEnv()
        observation, _ = env.reset(seed=seed)
        locations = [observation["location"][0, 0]]
        for _ in range(2):
            truncated = False
            while not truncated:
                observation, _, _, truncated, _ = env.step(RIGHT)
                locations.append(observation["location"][0, 0])
            locations.append(env.reset()[0]["location"][0, 0])
        return locations

    assert play(5) == play(5)
    assert play(5) != play(6)


def test_a_copy_continues_like_the_original() -> None:
    env = CorridorEnv()
    env.reset(seed=0)
    twin = copy.deepcopy(env)
    assert env.step(LEFT)[0]["location"] == twin.step(LEFT)[0]["location"]


def test_observations_and_masks_belong_to_the_caller() -> None:
    env = CorridorEnv()
    observation, info = env.reset(seed=0, options={"x": 0.5})
    observation["location"][:] = 0.0
    info["action_mask"][:] = 0
    assert env.state.x == 0.5
    assert env.step(LEFT)[4]["action_mask"].tolist() == [1, 1]


def test_several_corridors_run_in_a_vector_environment() -> None:
    envs = gymnasium.make_vec("relforest/Corridor-v0", num_envs=3, vectorization_mode="sync")
    observations, infos = envs.reset(seed=0)
    assert observations["location"].shape == (3, 1, 1)
    observations, _, _, _, infos = envs.step(np.array([LEFT, RIGHT, LEFT]))
    assert [scene.matrix[0, 0] for scene in infos["scene"]] == observations["location"].ravel().tolist()
    assert infos["duration"].tolist() == [1.0] * 3
    envs.close()


def test_no_step_follows_the_last_one() -> None:
    env = CorridorEnv(max_steps=1)
    env.reset(seed=0)
    assert env.step(LEFT)[3] is True
    with pytest.raises(ResetNeeded, match="ended after 1 step:"):
        env.step(LEFT)
    env.reset()
    env.step(LEFT)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"noise": -0.1}, "noise must be a finite number of at least 0, got -0.1"),
        ({"noise": float("nan")}, "noise must be a finite number"),
        ({"noise": float("inf")}, "noise must be a finite number"),
        ({"step_length": 0.0}, "step_length must be a number above 0"),
        ({"step_length": 1.5}, "step_length must be a number"),
        ({"window": -0.1}, "window must be a number"),
        ({"window": 0.6}, "window must be a number"),
        ({"max_steps": 0}, "max_steps must be an integer from 1 to 1000000, got 0"),
        ({"max_steps": 2.5}, "max_steps must be an integer"),
        ({"max_steps": 1_000_001}, "max_steps must be an integer from 1 to 1000000, got 1000001"),
    ],
)
def test_options_outside_their_range_are_errors(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        CorridorEnv(**options)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"x": 1.5}, "x must be a number of at least 0 and of at most 1, got 1.5"),
        ({"x": "middle"}, "x must be a number"),
        ({"y": 0.5}, r"'y' is not an option of reset\(\): choose from 'x'"),
        ({"x": 0.5, "y": 0.5}, r"'y' is not an option of reset\(\)"),
    ],
)
def test_bad_reset_options_are_errors(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        CorridorEnv().reset(options=options)


def test_rendering_shows_the_state_without_matplotlib() -> None:
    before = "matplotlib" in sys.modules
    env = CorridorEnv(render_mode="rgb_array")
    env.reset(seed=0, options={"x": 0.5})
    first = env.render()
    env.step(LEFT)
    second = env.render()
    assert first.dtype == np.uint8
    assert first.shape == second.shape
    assert (first != second).any()
    assert ("matplotlib" in sys.modules) == before
