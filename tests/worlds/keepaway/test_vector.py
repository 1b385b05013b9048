from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from gymnasium.wrappers.vector import DictInfoToList, RecordEpisodeStatistics

from interpreted import compiled_only
from relforest.scenes import Scenes
from relforest.support.errors import InputError
from relforest.worlds.keepaway.decisions.scene import NOBODY
from relforest.worlds.keepaway.env import KeepawayEnv
from relforest.worlds.keepaway.vector import KeepawayVectorEnv

pytestmark = compiled_only

FOUR_THREE: dict[str, Any] = {"keepers": 4, "takers": 3, "size": 25.0}


def one_by_one(num_envs: int, **options: Any) -> SyncVectorEnv:
    """Make the same of single environments, as Gymnasium does."""
    return SyncVectorEnv([lambda: KeepawayEnv(**options)] * num_envs)


def assert_same(ours: dict[str, Any], theirs: dict[str, Any]) -> None:
    """Compare observations or infos, entry by entry; the native environment makes no scenes unless asked."""
    assert set(ours) == set(theirs) - {"scene", "_scene"}
    for name, found in ours.items():
        expected = theirs[name]
        np.testing.assert_array_equal(found, expected, err_msg=name)
        assert found.dtype == expected.dtype, name


@pytest.mark.parametrize("options", [{}, FOUR_THREE, {"max_cycles": 12}])
def test_it_is_what_single_environments_give(options: dict[str, Any]) -> None:
    native, single = KeepawayVectorEnv(5, **options), one_by_one(5, **options)
    rng = np.random.default_rng(0)
    (observations, infos), (expected, expected_infos) = native.reset(seed=7), single.reset(seed=7)
    assert_same(observations, expected)
    assert_same(infos, expected_infos)
    ended = 0
    for _ in range(120):
        actions = rng.integers(native.single_action_space.n, size=5)
        observations, *outcomes, infos = native.step(actions)
        expected, *expected_outcomes, expected_infos = single.step(actions)
        assert_same(observations, expected)
        assert_same(infos, expected_infos)
        for mine, theirs in zip(outcomes, expected_outcomes, strict=True):
            np.testing.assert_array_equal(mine, theirs)
            assert mine.dtype == theirs.dtype
        ended += int((outcomes[1] | outcomes[2]).sum())
    assert ended >= 5


def test_a_game_does_not_depend_on_the_others() -> None:
    many, few = KeepawayVectorEnv(6), KeepawayVectorEnv(2)
    many.reset(seed=10)
    few.reset(seed=[13, 11])
    rng = np.random.default_rng(1)
    for _ in range(40):
        actions = rng.integers(3, size=6)
        seen, *_ = many.step(actions)
        fewer, *_ = few.step(actions[[3, 1]])
        np.testing.assert_array_equal(seen["location"][[3, 1]], fewer["location"])


def test_games_without_a_seed_go_on() -> None:
    one, other = KeepawayVectorEnv(3), KeepawayVectorEnv(3)
    for envs in (one, other):
        envs.reset(seed=0)
        envs.step(np.zeros(3, dtype=np.int64))
    ours, _ = one.reset(seed=[None, 8, None])
    theirs, _ = other.reset()
    same = (ours["location"] == theirs["location"]).all(axis=(1, 2))
    assert same.tolist() == [True, False, True]
    # The body directions come from the episode before, so that the same seed does not give the same again.
    np.testing.assert_array_equal(ours["location"][1], KeepawayEnv().reset(seed=8)[0]["location"])


def test_without_any_seed_games_differ() -> None:
    observations, _ = KeepawayVectorEnv(3).reset()
    assert len(np.unique(observations["location"][:, 0, 0])) == 3


def test_an_ended_episode_is_followed_by_another_in_the_next_step() -> None:
    envs = KeepawayVectorEnv(1, max_cycles=9)
    assert envs.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    envs.reset(seed=0)
    hold = np.zeros(1, dtype=np.int64)
    _, _, _, truncations, infos = envs.step(hold)
    while not truncations[0]:
        _, _, _, truncations, infos = envs.step(hold)
    assert infos["end"].tolist() == ["capped"]
    assert infos["time"].tolist() == [9]
    _, rewards, terminations, truncations, infos = envs.step(hold)
    assert (rewards[0], terminations[0], truncations[0]) == (0.0, False, False)
    # Nothing was done, so nothing took time or ended.
    assert not {"duration", "discounted_reward", "end"} & set(infos)
    assert infos["_without_decision"][0]
    assert 0 < infos["time"][0] < 9
    assert infos["actor"][0] != NOBODY


def test_gymnasium_makes_the_native_one() -> None:
    envs = gymnasium.make_vec("relforest/Keepaway-v0", num_envs=3, **FOUR_THREE)
    assert isinstance(envs, KeepawayVectorEnv)
    assert envs.num_envs == 3
    observations, infos = envs.reset(seed=0)
    assert envs.observation_space.contains(observations)
    assert infos["variables"].shape == (3, 19)
    scenes = envs.scenes()
    assert isinstance(scenes, Scenes)
    assert len(scenes) == 3
    location = scenes.values["location"]
    for g in range(3):
        np.testing.assert_array_equal(location[scenes.objects(g)], observations["location"][g])
    assert scenes.object_ids[scenes.objects(2)].tolist() == [
        *("keeper_0", "keeper_1", "keeper_2", "keeper_3"),
        *("taker_0", "taker_1", "taker_2"),
    ]


def test_gymnasiums_vector_wrappers_work() -> None:
    envs = DictInfoToList(RecordEpisodeStatistics(KeepawayVectorEnv(2, max_cycles=20)))
    envs.reset(seed=0)
    totals = []
    for _ in range(60):
        *_, infos = envs.step(np.zeros(2, dtype=np.int64))
        totals += [info["episode"]["r"] for info in infos if "episode" in info]
    assert totals
    # An episode of at most 20 cycles, less those before its first decision.
    assert all(0 < total < 20 for total in totals)


def test_what_is_returned_belongs_to_the_caller() -> None:
    one, other = KeepawayVectorEnv(2), KeepawayVectorEnv(2)
    observations, infos = one.reset(seed=0)
    other.reset(seed=0)
    for name in ("variables", "last_times", "actor", "time", "action_mask"):
        infos[name][:] = 0
    observations["location"][:] = 0.0
    actions = np.ones(2, dtype=np.int64)
    np.testing.assert_array_equal(one.step(actions)[0]["location"], other.step(actions)[0]["location"])
    np.testing.assert_array_equal(one.step(actions)[1], other.step(actions)[1])


@pytest.mark.parametrize(
    "actions",
    [
        np.zeros(2, dtype=np.int64),
        np.zeros((3, 1), dtype=np.int64),
        np.zeros(3),
        np.full(3, np.nan),
        [0, 1, None],
        0,
        np.zeros(3, dtype=np.bool_),
    ],
)
def test_actions_of_another_form_are_errors(actions: Any) -> None:
    envs = KeepawayVectorEnv(3)
    envs.reset(seed=0)
    with pytest.raises(InputError, match=r"actions must be integers of shape \(3,\), one per game, got"):
        envs.step(actions)


@pytest.mark.parametrize(("actions", "found"), [([0, -1, 0], "-1 for game 1"), ([0, 2, 3], "3 for game 2")])
def test_actions_out_of_range_are_errors(actions: list[int], found: str) -> None:
    envs = KeepawayVectorEnv(3)
    envs.reset(seed=0)
    with pytest.raises(InputError, match=rf"actions must be from 0 \(hold\) to 2 .*, got {found}"):
        envs.step(np.array(actions))


def test_any_sequence_of_integers_will_do() -> None:
    envs = KeepawayVectorEnv(2)
    envs.reset(seed=0)
    assert envs.step([0, 1])[1].shape == (2,)
    assert envs.step(np.array([1, 0], dtype=np.uint8))[1].shape == (2,)


def test_wrong_use_is_an_error() -> None:
    envs = KeepawayVectorEnv(3)
    with pytest.raises(ResetNeeded, match="call reset"):
        envs.step(np.zeros(3, dtype=np.int64))
    with pytest.raises(InputError, match=r"seed must be an integer of at least 0, got 1.5"):
        envs.reset(seed=1.5)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="seed must hold one seed for each of 3 games, got 2"):
        envs.reset(seed=[0, 1])
    with pytest.raises(
        InputError, match=r"'reset_mask' is not an option of reset\(\): this world takes none"
    ):
        envs.reset(options={"reset_mask": np.ones(3, dtype=np.bool_)})
    with pytest.raises(InputError, match="num_envs must be an integer from 1 to 8192, got 0"):
        KeepawayVectorEnv(0)
    with pytest.raises(InputError, match="keepers must be an integer from 2 to 32"):
        KeepawayVectorEnv(2, keepers=1)


def test_the_number_of_threads_changes_nothing() -> None:
    one, three = (KeepawayVectorEnv(5, max_cycles=40, n_threads=threads) for threads in (1, 3))
    before = [envs.reset(seed=3)[0] for envs in (one, three)]
    np.testing.assert_array_equal(before[0]["location"], before[1]["location"])
    for step in range(12):
        actions = np.full(5, step % 3)
        ours, theirs = (envs.step(actions) for envs in (one, three))
        for name, array in ours[0].items():
            np.testing.assert_array_equal(array, theirs[0][name])
        for mine, other in zip(ours[1:4], theirs[1:4], strict=True):
            np.testing.assert_array_equal(mine, other)
