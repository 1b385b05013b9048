from __future__ import annotations

import copy
import pickle
import sys
from collections.abc import Callable
from typing import Any
from unittest.mock import MagicMock

import gymnasium
import numpy as np
import pytest
from gymnasium.error import DependencyNotInstalled, ResetNeeded

from relforest.playing.frames import Frame
from relforest.support.errors import InputError
from relforest.worlds import ENVIRONMENT_IDS
from relforest.worlds.blocks.env import arch_env, color_grouping_env, high_towers_env
from relforest.worlds.corridor.env import CorridorEnv
from relforest.worlds.environment import WorldEnv
from relforest.worlds.keepaway.env import KeepawayEnv
from relforest.worlds.keepaway.parallel import KeepawayParallelEnv
from relforest.worlds.keepaway.vector import KeepawayVectorEnv

Make = Callable[..., Any]

IDS = list(ENVIRONMENT_IDS.values())
# Options with which an episode is over after few actions that the world chooses.
SHORT: dict[str, Any] = {
    "relforest/Corridor-v0": {"max_steps": 2},
    "relforest/Keepaway-v0": {"max_cycles": 30},
    "relforest/HighTowers-v0": {"n_blocks": 2, "max_actions": 2},
    "relforest/ColorGrouping-v0": {"n_blocks": 2, "max_actions": 2},
    "relforest/Arch-v0": {"max_actions": 2},
}
FACES = [
    *(
        pytest.param(lambda mode=None, name=name: gymnasium.make(name, render_mode=mode), id=name)
        for name in IDS
    ),
    pytest.param(lambda mode=None: KeepawayVectorEnv(2, render_mode=mode), id="vector"),
    pytest.param(KeepawayParallelEnv, id="parallel"),
]


def world(name: str, **options: Any) -> WorldEnv:
    env = gymnasium.make(name, **options).unwrapped
    assert isinstance(env, WorldEnv)
    return env


def same(one: Any, other: Any) -> bool:
    """Whether two resets or steps returned the same observation and, for steps, reward."""
    observations = all(np.array_equal(array, other[0][name]) for name, array in one[0].items())
    return observations and one[1:-1] == other[1:-1]


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("integer", [np.int64, np.uint8, np.array])
def test_integers_of_any_type_are_actions(name: str, integer: Any) -> None:
    env, twin = world(name), world(name)
    index = int(np.flatnonzero(env.reset(seed=1)[1]["action_mask"])[0])
    twin.reset(seed=1)
    assert same(env.step(index), twin.step(integer(index)))


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize(
    "action", [-1, 10_000, 2**70, 0.0, np.float64(0), np.nan, np.True_, "0", None, [0], np.array(0.5)]
)
def test_other_actions_are_errors_and_change_nothing(name: str, action: Any) -> None:
    env, twin = world(name), world(name)
    for each in (env, twin):
        each.reset(seed=1)
    with pytest.raises(
        InputError, match=rf"^action must be an integer from 0 to {env.action_space.n - 1}.*, got "
    ):
        env.step(action)
    assert same(env.step(0), twin.step(0))


@pytest.mark.parametrize("name", IDS)
def test_an_array_of_actions_is_an_error_that_names_the_remedy(name: str) -> None:
    env = world(name)
    env.reset(seed=1)
    with pytest.raises(InputError, match=r"got an array of shape \(1,\): pass one of its elements"):
        env.step(np.array([0]))


@pytest.mark.parametrize("name", IDS)
def test_nothing_works_before_the_first_reset(name: str) -> None:
    env = world(name, render_mode="rgb_array")
    for use in (lambda: env.step(0), lambda: env.step(-1), env.decision, env.action_masks, env.render):
        with pytest.raises(ResetNeeded, match=r"^no episode has begun: call reset\(\) first"):
            use()


@pytest.mark.parametrize("name", IDS)
def test_no_step_follows_the_end(name: str) -> None:
    env = world(name, **SHORT[name])
    env.reset(seed=1)
    over = False
    while not over:
        *_, terminated, truncated, _ = env.step(int(env.decision().indices[-1]))
        over = terminated or truncated
    for action in (0, -1):
        with pytest.raises(ResetNeeded, match=r"^the episode ended after \d+ \w+: call reset\(\) first"):
            env.step(action)
    env.reset()
    env.step(0)


@pytest.mark.parametrize("make", FACES)
@pytest.mark.parametrize("options", [5, 0, "x", "", [], [("x", 0.5)], True])
def test_reset_options_that_are_no_mapping_are_errors(make: Make, options: Any) -> None:
    with pytest.raises(InputError, match=r"options of reset\(\) must be a dictionary or None, got "):
        make().reset(options=options)


@pytest.mark.parametrize("make", FACES[:-1])
def test_unknown_reset_options_are_errors_that_leave_the_random_numbers_alone(make: Make) -> None:
    env = make()
    env.reset(seed=1, options={})
    state = env.unwrapped.np_random.bit_generator.state
    with pytest.raises(InputError, match=r"'color' is not an option of reset\(\): (choose from|this world)"):
        env.reset(seed=2, options={"color": 3})
    assert env.unwrapped.np_random.bit_generator.state == state


def test_options_that_pettingzoo_passes_to_every_world_are_passed_over() -> None:
    assert KeepawayParallelEnv().reset(seed=0, options={"options": 1})


@pytest.mark.parametrize("make", FACES)
@pytest.mark.parametrize("seed", [-1, 1.0, np.nan, True, "1", b"1"])
def test_seeds_that_are_no_integers_of_at_least_0_are_errors(make: Make, seed: Any) -> None:
    with pytest.raises(InputError, match="seed must be an integer of at least 0, got "):
        make().reset(seed=seed)


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("seed", [0, 2**32, 2**200])
def test_seeds_may_be_of_any_size(name: str, seed: int) -> None:
    one, other = world(name), world(name)
    found = [one.reset(seed=seed)[0], other.reset(seed=seed)[0]]
    assert all(np.array_equal(array, found[1][key]) for key, array in found[0].items())
    assert one.np_random_seed == seed


@pytest.mark.parametrize("name", IDS)
def test_seeds_may_be_of_numpys_types(name: str) -> None:
    one, other = world(name), world(name)
    found = [one.reset(seed=7)[0], other.reset(seed=np.int64(7))[0]]  # type: ignore[arg-type]
    assert all(np.array_equal(array, found[1][key]) for key, array in found[0].items())


@pytest.mark.parametrize("name", IDS)
def test_masks_agree_with_info_in_every_state(name: str) -> None:
    env = gymnasium.make(name, **SHORT[name])
    masks = env.get_wrapper_attr("action_masks")
    _, info = env.reset(seed=2)
    for _ in range(12):
        assert masks().dtype == np.bool_
        assert masks().shape == (env.action_space.n,)  # type: ignore[attr-defined]
        np.testing.assert_array_equal(masks(), info["action_mask"])
        if not masks().any():
            break
        try:
            *_, info = env.step(int(np.flatnonzero(masks())[-1]))
        except ResetNeeded:
            break


def test_masks_of_many_games_agree_with_infos() -> None:
    envs = KeepawayVectorEnv(3, max_cycles=20)
    with pytest.raises(ResetNeeded, match="no episode has begun"):
        envs.action_masks()
    _, infos = envs.reset(seed=0)
    for _ in range(20):
        assert envs.action_masks().dtype == np.bool_
        np.testing.assert_array_equal(envs.action_masks(), infos["action_mask"])
        *_, infos = envs.step(np.zeros(3, dtype=np.int64))


@pytest.mark.parametrize("make", FACES)
def test_rendering_needs_its_mode(make: Make) -> None:
    env = make()
    env.reset(seed=0)
    with pytest.raises(InputError, match=r'needs a render mode: make .* with render_mode="rgb_array"'):
        env.render()


@pytest.mark.parametrize("make", FACES)
@pytest.mark.parametrize("mode", ["ansi", "rgb", "", 5, True, ["rgb_array"]])
def test_unknown_render_modes_are_errors_and_nothing_else(make: Make, mode: Any) -> None:
    with pytest.raises(InputError, match=r'render_mode must be None or "rgb_array" \(.*\), got '):
        make(mode)


@pytest.mark.parametrize("name", IDS)
def test_pictures_can_be_collected(name: str) -> None:
    env = gymnasium.make(name, render_mode="rgb_array_list")
    env.reset(seed=0)
    env.step(0)
    pictures: Any = env.render()
    assert [picture.dtype for picture in pictures] == [np.uint8] * 2


def test_there_is_a_picture_of_each_of_many_games() -> None:
    envs = gymnasium.make_vec("relforest/Keepaway-v0", num_envs=2, render_mode="rgb_array")
    envs.reset(seed=0)
    pictures: Any = envs.render()
    one, other = pictures
    assert one.shape == other.shape
    assert (one != other).any()


@pytest.mark.parametrize("make", [*FACES[:-2], FACES[-1]])
def test_without_pygame_a_window_is_an_error_that_names_the_remedy(
    make: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pygame", None)
    for error_type in (InputError, DependencyNotInstalled):
        with pytest.raises(
            error_type, match=r'"human" needs pygame: pip install pygame, or choose .*"rgb_array"'
        ):
            make("human")


@pytest.mark.parametrize("make", [CorridorEnv, KeepawayEnv, high_towers_env, color_grouping_env, arch_env])
def test_worlds_themselves_name_what_opens_a_window(make: Make) -> None:
    with pytest.raises(InputError, match=r'gymnasium.make also takes "human" .*, got .human.'):
        make("human")


def pygame_of(*, screen: bool) -> MagicMock:
    """Return a stand-in for pygame that shows nothing."""
    pygame = MagicMock()
    pygame.error = OSError
    if not screen:
        pygame.display.init.side_effect = OSError("No available video device")
    return pygame


@pytest.mark.parametrize("make", [*FACES[:-2], FACES[-1]])
def test_a_window_shows_every_state(make: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    pygame = pygame_of(screen=True)
    monkeypatch.setitem(sys.modules, "pygame", pygame)
    env = make("human")
    assert env.render_mode == "human"
    _, info = env.reset(seed=0)
    assert pygame.display.flip.call_count == 1
    env.step({f"keeper_{info['keeper_0']['actor']}": 0} if make is KeepawayParallelEnv else 0)
    assert pygame.display.flip.call_count == 2
    assert env.render() is None
    env.close()
    env.close()


@pytest.mark.parametrize("make", [*FACES[:-2], FACES[-1]])
def test_without_a_screen_a_window_is_an_error(make: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pygame", pygame_of(screen=False))
    with pytest.raises(
        InputError, match=r'"human" needs a display \(No available video device\): .*"rgb_array"'
    ):
        make("human")


@pytest.mark.parametrize("name", IDS)
def test_environments_may_be_closed_twice_and_used_again(name: str) -> None:
    env = gymnasium.make(name)
    env.reset(seed=0)
    env.close()
    env.close()
    env.reset(seed=0)
    env.step(0)


def test_closing_many_games_stops_their_threads() -> None:
    envs = KeepawayVectorEnv(4, n_threads=2, max_cycles=30)
    before = envs.reset(seed=0)[0]
    twin = copy.deepcopy(envs)
    envs.close()
    envs.close()
    actions = np.zeros(4, dtype=np.int64)
    np.testing.assert_array_equal(envs.step(actions)[0]["location"], twin.step(actions)[0]["location"])
    np.testing.assert_array_equal(envs.reset(seed=0)[0]["location"], before["location"])
    sent = pickle.loads(pickle.dumps(envs))  # noqa: S301 - our own bytes
    np.testing.assert_array_equal(envs.step(actions)[0]["location"], sent.step(actions)[0]["location"])


@pytest.mark.parametrize("name", IDS)
def test_an_environment_can_be_made_again_from_its_specification(name: str) -> None:
    env = gymnasium.make(name, render_mode="rgb_array", **SHORT[name])
    assert env.spec is not None
    again = gymnasium.make(env.spec)
    assert same(env.reset(seed=3), again.reset(seed=3))
    assert again.spec == env.spec


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("twin_of", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])  # noqa: S301 - our own
def test_a_copy_in_the_middle_of_an_episode_goes_on_alike(name: str, twin_of: Make) -> None:
    env = gymnasium.make(name, render_mode="rgb_array", **SHORT[name])
    _, info = env.reset(seed=3)
    env.step(int(np.flatnonzero(info["action_mask"])[0]))
    twin = twin_of(env)
    for _ in range(2):
        np.testing.assert_array_equal(env.render(), twin.render())
        try:
            assert same(env.step(0), twin.step(0))
        except ResetNeeded:
            break
    assert same(env.reset(), twin.reset())


@pytest.mark.parametrize("name", IDS)
def test_a_world_shows_a_frame_after_each_reset_and_step(name: str) -> None:
    env = world(name, **SHORT[name])
    frames: list[Frame] = []
    env.watch(frames.append)
    _, info = env.reset(seed=3)
    before = len(frames)
    env.say(0)
    env.step(int(np.flatnonzero(info["action_mask"])[0]))
    assert 0 < before < len(frames)
    assert frames[-1] == env._frame()
    env.watch(None)
    env.reset(seed=4)
    assert frames[-1] != env._frame()
